"""A sensor that shows one value while the machine moves is stuck; one that runs into its end is clipped; rest is neither."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.recording import Recording
from exo_sim.recording.health import stuck_or_clipped
from exo_sim.recording.health.facts import Facts
from exo_sim.recording.noise import floors

TIME = np.arange(6000.0) * 1e-3
RNG = np.random.default_rng(5)
MOVING = 0.05 * np.sin(3.0 * TIME)


def kinds(pressure: np.ndarray) -> dict[str, tuple[tuple[int, int], ...]]:
    columns = {"piston.pressure_1": pressure, "slide.position": MOVING + RNG.normal(0.0, 1e-5, TIME.size)}
    table = Recording("r", TIME, columns, {"piston.pressure_1": "Pa", "slide.position": "m"})
    return {one.kind: one.rows for one in stuck_or_clipped.check(table, "piston.pressure_1", floors(table))}


def noisy(values: np.ndarray) -> np.ndarray:
    return values + RNG.normal(0.0, 200.0, TIME.size)


CLEAN = noisy(3e5 + 8e4 * np.sin(3.0 * TIME))


def test_a_lively_sensor_is_nothing() -> None:
    assert kinds(CLEAN) == {}


def test_a_stuck_one_is_found_in_its_rows() -> None:
    values = CLEAN.copy()
    values[2000:4000] = values[2000]
    ((first, last),) = kinds(values)["stuck"]
    assert first == pytest.approx(2000, abs=2) and last == pytest.approx(4000, abs=2)


def test_one_that_runs_into_its_end_is_clipped() -> None:
    assert set(kinds(np.minimum(CLEAN, 3.5e5))) == {"clipped"}


def test_a_regulated_supply_that_toggles_between_steps_of_a_coarse_converter_is_nothing() -> None:
    step = 1222.0
    for offset in (0.0, 0.35, 0.45):
        values = step * np.round(600.0 + offset + RNG.normal(0.0, 0.25, TIME.size))
        assert len(np.unique(values)) <= 4
        assert kinds(values) == {}


def table_of(**columns: np.ndarray) -> Recording:
    named = {key.replace("__", "."): values for key, values in columns.items()}
    units = {"valve_command": "1", "position": "m"}
    return Recording("r", TIME, named, {key: units.get(key.split(".")[1], "Pa") for key in named})


def found(table: Recording, key: str, facts: Facts | None = None) -> list[tuple[str, str]]:
    return [(one.kind, one.severity) for one in stuck_or_clipped.check(table, key, floors(table), facts)]


def test_a_pressure_that_is_one_number_while_its_valve_is_worked_or_its_piston_moves_is_no_sensor_that_works() -> None:
    flat, command = np.full(TIME.size, 3.2e5), np.sign(np.sin(3.0 * TIME))
    worked = table_of(piston__pressure_2=flat, piston__valve_command=command)
    led = table_of(piston__pressure_2=flat, piston__pressure_1=CLEAN, slide__position=MOVING)
    for table in (worked, led):
        assert found(table, "piston.pressure_2") == [("constant", "fault")]
        assert found(table, "piston.pressure_2", Facts(vented=frozenset({"piston.pressure_2"}))) == [("constant", "info")]
    for idle in (
        table_of(piston__pressure_2=flat, piston__valve_command=0.0 * command, slide__position=MOVING),
        table_of(piston__pressure_2=flat, piston__pressure_1=CLEAN, slide__position=0.0 * MOVING),  # a vessel
        table_of(piston__pressure_2=np.full(TIME.size, 101325.0), piston__pressure_1=CLEAN, slide__position=MOVING),  # left open
        table_of(piston__pressure_2=flat, other__valve_command=command),
    ):
        assert found(idle, "piston.pressure_2") == [("constant", "info")]


@pytest.mark.parametrize("step", [1e-9, 2e-6])
def test_a_position_cut_off_at_an_extreme_is_clipped_where_its_noise_hardly_repeats(step: float) -> None:
    position = step * np.round((0.05 * np.sin(3.0 * TIME) + RNG.normal(0.0, 2e-5, TIME.size)) / step)
    cut = np.minimum(position, np.quantile(position, 0.8))
    table = table_of(slide__position=cut)
    (one,) = stuck_or_clipped.check(table, "slide.position", floors(table))
    spared = np.ones(TIME.size, dtype=bool)
    for begin, end in one.rows:
        spared[begin:end] = False
    assert one.kind == "clipped" and np.mean(cut[~spared] == cut.max()) == 1.0 and np.sum(cut[spared] == cut.max()) < 60
    assert found(table_of(slide__position=position), "slide.position") == []


@pytest.mark.parametrize("noise", [0.0, 0.5e-4, 1e-4, 2e-4], ids=["no noise", "half a step", "a step", "two steps"])
def test_a_piston_that_rests_at_its_stops_is_not_clipped_whatever_its_encoder(noise: float) -> None:
    """Driven against both stops and held there; read by steps of 0.1 mm, or without any."""
    stopped = np.clip(0.08 * np.sin(3.0 * TIME), -0.05, 0.05)
    seen = stopped + RNG.normal(0.0, max(noise, 1e-12), TIME.size)
    for values in (1e-4 * np.round(seen / 1e-4), seen if noise else stopped):
        assert found(table_of(slide__position=values), "slide.position") == []


def test_a_quick_stroke_by_steps_that_no_grid_tells_of_is_not_clipped_at_its_stops() -> None:
    """On a slow clock it never repeats on its way, and its rounding looks like noise."""
    time = np.arange(1200.0) * 1e-2
    stroke = np.clip(0.3 * np.sin(2.0 * time), 0.0, 0.16)
    values = 3e-4 * np.round(stroke / 3e-4)
    table = Recording("r", time, {"slide.position": values}, {"slide.position": "m"})
    assert stuck_or_clipped.check(table, "slide.position", floors(table)) == []
