"""A command that does not say what the valve did is set aside, one that comes after what it does is taken earlier, and both are said."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import benches
import numpy as np
import pytest

from exo_sim.conventions.commands import _with_earlier, in_time, that_open
from exo_sim.conventions.gas_balance import explained
from exo_sim.conventions.machine import Machine, columns_of
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording
from exo_sim.recording.reader import Reading
from exo_sim.rig import Rig

COMMAND = "piston.valve_command"


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    """Return a bench whose piston stays within its stroke."""
    rig = benches.bench(tmp_path_factory.mktemp("commands"))
    joint = '<joint name="slide" type="slide" axis="1 0 0" '
    rig.model.write_text(rig.model.read_text().replace(joint.strip(), joint + 'limited="true" range="-0.09 0.09" damping="300"'))
    return rig


@pytest.fixture(scope="module")
def driven(rig: Rig) -> Recording:
    return benches.recorded(rig, 6.0)


def with_command(table: Recording, command: np.ndarray) -> Recording:
    return replace(table, columns={**table.columns, COMMAND: command})


def shifted(table: Recording, samples: int) -> Recording:
    """Return a table whose command comes so many samples late."""
    command = np.roll(table[COMMAND], samples)
    command[: max(samples, 0)] = 0.0
    return with_command(table, command)


def test_a_command_that_opens_nothing_while_chambers_fill_says_nothing(rig: Rig, driven: Recording) -> None:
    machine = Machine.of(rig, load(rig))
    noise = 0.003 * np.random.default_rng(0).standard_normal(len(driven.time))
    for command in (0.0 * noise, noise):
        rest, (check,) = that_open(with_command(driven, command), machine)
        assert COMMAND not in rest and check.columns == (COMMAND,) and not check.refused and "does not say" in check.says
    assert that_open(driven, machine) == (driven, [])


def test_a_closed_valve_may_be_closed(rig: Rig) -> None:
    closed = benches.led(rig, 6.0)
    assert that_open(closed, Machine.of(rig, load(rig))) == (closed, [])


@pytest.mark.parametrize("late", [0.0, 0.1, 0.18])
def test_closed_chambers_whose_pressures_are_late_are_not_fed(rig: Rig, late: float) -> None:
    led = benches.led(rig, 20.0)
    slow = np.interp(led.time - late, led.time, led["piston.pressure_1"]), np.interp(led.time - late, led.time, led["piston.pressure_2"])
    table = replace(led, columns={**led.columns, "piston.pressure_1": slow[0], "piston.pressure_2": slow[1]})
    assert that_open(table, Machine.of(rig, load(rig))) == (table, [])


def test_then_the_gas_is_left_open_and_nothing_is_named(rig: Rig, driven: Recording) -> None:
    data = gather([Reading(with_command(driven, 0.0 * driven.time), ())], rig)
    assert not data.cylinders and data.fed == {"piston"} and any("does not say" in one for one in data.remarks)


def test_a_late_command_is_taken_earlier(rig: Rig, driven: Recording) -> None:
    table, (check,) = in_time(shifted(driven, 30), Machine.of(rig, load(rig)))
    assert check.value == pytest.approx(0.030, abs=0.0015) and "30 ms" in check.says
    late = round(1e3 * check.value)
    np.testing.assert_array_equal(table[COMMAND], shifted(driven, 30)[COMMAND][late : late + len(table.time)])
    assert table.time[-1] < driven.time[-1] - 0.028  # the command of the last 30 ms is not in the file


@pytest.mark.parametrize("samples", [0, -20, 4])
def test_a_command_in_time_and_what_lags_behind_it_stay(rig: Rig, driven: Recording, samples: int) -> None:
    """A valve that answers 20 ms late, and a card that is 4 ms late, are no other clock."""
    one = shifted(driven, samples)
    assert in_time(one, Machine.of(rig, load(rig))) == (one, [])


def test_a_lag_of_pulses_that_repeat_themselves_is_no_other_clock(rig: Rig) -> None:
    """A pulse that acts 18 ms late acts 22 ms before the next one."""

    def pulses(time: np.ndarray) -> np.ndarray:
        share = 0.8 * np.sin(4.0 * (time // 0.04) * 0.04)
        return np.sign(share) * (time % 0.04 < 0.04 * np.abs(share))

    machine, lags = Machine.of(rig, load(rig)), shifted(benches.recorded(rig, 6.0, pulses), -18)
    link = machine.links[0]
    columns = columns_of(lags, machine, link)
    assert columns is not None
    ask = partial(explained, cylinder=machine.cylinder(link), rig=rig)
    assert ask(_with_earlier(columns, 0.022)).misfit < 0.5 * ask(columns).misfit  # that is what an earlier command alone would be taken for
    assert in_time(lags, machine) == (lags, [])


def test_no_interval_is_looked_at_across_a_mended_clock(rig: Rig, driven: Recording) -> None:
    machine = Machine.of(rig, load(rig))
    whole = columns_of(driven, machine, machine.links[0])
    cut = columns_of(replace(driven, breaks=(float(driven.time[2500]),)), machine, machine.links[0])
    assert whole is not None and cut is not None and list(whole.breaks) == [0] and list(cut.breaks) == [0, 2500]


def test_it_is_a_fault_of_the_column(rig: Rig, driven: Recording) -> None:
    (finding,) = gather([Reading(shifted(driven, 30), ())], rig).sensors
    assert (finding.name, finding.where, finding.kind) == ("sensor_delay", COMMAND, Kind.SENSOR)
    assert finding.parameters["seconds"].low < 0.030 < finding.parameters["seconds"].high
