"""Which balances recordings let one judge: each reason why not is a question that stays open."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.pipeline.sorting import sort
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording


def sorted_data(
    folder: Path, table: Recording | None = None, without: tuple[str, ...] = (), every: int = 1, stops: tuple[float, float] | None = None
) -> MachineData:
    rig = benches.bench(folder)
    table = table or benches.led(rig, 2.0)
    columns = {key: values[::every] for key, values in table.columns.items() if key not in without}
    table = replace(table, time=table.time[::every], columns=columns)
    model = load(rig)
    if stops is not None:
        model.jnt_limited[0], model.jnt_range[0] = True, stops
    return sort(MachineData(rig, model, linkages(rig, model), (table,), (table,), {}, {}))


def whys(data: MachineData) -> dict[str, str]:
    return {question.question: question.why for question in data.open_questions}


def test_a_whole_recording_of_a_bench_has_a_gas_and_a_balance_of_forces(tmp_path: Path) -> None:
    table = benches.recorded(benches.bench(tmp_path), 2.0)
    data = sorted_data(tmp_path, table)
    assert set(data.cylinders) == {"piston"} and set(data.joints) == {"slide"} and data.open_questions == ()


def test_a_joint_that_somebody_leads_has_no_balance_but_its_gas_has(tmp_path: Path) -> None:
    data = sorted_data(tmp_path)
    assert set(data.cylinders) == {"piston"} and "slide" not in data.joints and data.externally_driven == {"slide"}
    assert "the balance of forces at slide in bench" in whys(data)


def test_a_stop_that_throws_a_piston_back_is_nobody_s_hand(tmp_path: Path) -> None:
    """Gas pushes it against its friction from stop to stop, and the stops turn it round: their push nobody recorded."""
    table = benches.recorded(benches.bench(tmp_path), 4.0)
    flight = 0.1 * 2.0 / np.pi * np.arcsin(0.998 * np.sin(2.0 * np.pi * 0.625 * table.time))
    pressures = {f"piston.pressure_{side}": 2e5 + 2e2 * sign * np.sign(np.gradient(flight)) for side, sign in ((1, 1.0), (2, -1.0))}
    thrown = replace(table, columns={**table.columns, **pressures, "slide.position": flight})
    assert sorted_data(tmp_path, thrown, stops=(-0.095, 0.095)).externally_driven == frozenset()
    assert sorted_data(tmp_path, thrown, stops=(-0.2, 0.2)).externally_driven == {"slide"}  # in mid-stroke somebody turns it round


@pytest.mark.parametrize(
    ("without", "why", "do"),
    [
        (("slide.position",), "its volumes are not known", "record the position of the joint that piston moves as well"),
        (("piston.valve_command",), "its valve command was not recorded", "record piston.valve_command as well"),
        (
            ("piston.pressure_1", "piston.pressure_2"), "no pressure of it was recorded",
            "record piston.pressure_1 and piston.pressure_2 as well",
        ),
    ],
)
def test_what_was_not_recorded_is_said_by_its_name(tmp_path: Path, without: tuple[str, ...], why: str, do: str) -> None:
    data = sorted_data(tmp_path, without=without)
    assert [question.do for question in data.open_questions if question.question == "the gas of piston in bench"] == [do]
    assert data.cylinders == {} and why in whys(data)["the gas of piston in bench"]


@pytest.mark.parametrize(
    ("acting", "recorded", "do"),
    [
        ("single", ("piston.valve_command_1",), None),  # nothing feeds the other chamber
        ("single", (), "record piston.valve_command_1 as well"),
        ("double", ("piston.valve_command_1",), "record piston.valve_command_1 and piston.valve_command_2 as well"),
        ("double", ("piston.valve_command_1", "piston.valve_command_2"), None),
    ],
)
def test_a_valve_with_independent_edges_needs_the_command_of_each_chamber_that_it_feeds(
    tmp_path: Path, acting: str, recorded: tuple[str, ...], do: str | None
) -> None:
    rig = replace(benches.bench(tmp_path), text="")
    piston = rig.cylinders["piston"]
    piston = replace(piston, single_acting=acting == "single", valve=replace(piston.valve, independent=True))
    rig = replace(rig, cylinders={"piston": piston})
    table, model = benches.led(rig, 2.0), load(rig)
    columns = {key: values for key, values in table.columns.items() if "command" not in key}
    columns |= {key: np.zeros(len(table.time)) for key in recorded}
    table = replace(table, columns=columns)
    data = sort(MachineData(rig, model, linkages(rig, model), (table,), (table,), {}, {}))
    assert [question.do for question in data.open_questions if question.question == "the gas of piston in bench"] == ([do] if do else [])
    assert bool(data.cylinders) is (do is None)


def test_a_clock_too_slow_for_gas_is_said_with_its_rate(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    time = np.arange(120) * 1.0
    columns = {
        "piston.valve_command": np.zeros(120), "piston.pressure_1": 3e5 + 1e4 * np.sin(time), "piston.pressure_2": 3e5 + 1e4 * np.cos(time),
        "slide.position": 0.02 * np.sin(0.3 * time),
    }  # fmt: skip
    data = sorted_data(tmp_path, benches.recording(time, columns))
    assert "1 samples a second" in whys(data)["the gas of piston in bench"] and rig.cylinders
    assert all(question.do == "record at 500 Hz or more" for question in data.open_questions)
    assert "nothing in these recordings can be held against the rig" in data.remarks


def test_pressures_that_hardly_change_show_nothing(tmp_path: Path) -> None:
    table = benches.led(benches.bench(tmp_path), 2.0)
    noise = np.random.default_rng(2).normal(0.0, 200.0, (2, len(table.time)))
    still = {f"piston.pressure_{side}": 3e5 + noise[side - 1] for side in (1, 2)}
    data = sorted_data(tmp_path, replace(table, columns={**table.columns, **still}))
    assert whys(data)["the gas of piston in bench"] == "its pressures hardly change"
    assert not any("missing signal" in question.do for question in data.open_questions if "hardly change" in question.why)


@pytest.mark.filterwarnings("error")
def test_a_single_sample_has_no_rate_and_warns_of_nothing(tmp_path: Path) -> None:
    """Beside a gap of the clock: a column with so few numbers is not kept."""
    table = benches.led(benches.bench(tmp_path), 2.0).span(0.0, 0.0005)
    data = sorted_data(tmp_path, table, without=tuple(table.columns))
    assert len(table.time) == 1 and not data.cylinders and not data.joints
