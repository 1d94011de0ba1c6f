"""Clean recordings raise nothing; every planted fault is reported, by its name, on its column."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.health import Facts, check, without_faults
from exo_sim.recording.table import Recording

ATMOSPHERE = 101325.0
SUPPLY = 7e5
UNITS = {
    "piston.valve_command": "1",
    "piston.pressure_1": "Pa",
    "piston.pressure_2": "Pa",
    "piston.force": "N",
    "slide.position": "m",
    "slide.velocity": "m/s",
    "supply.pressure": "Pa",
    "supply.temperature": "K",
    "foot.ground_force_z": "N",
    "foot.pressure_centre": "m",
}
FACTS = Facts(ATMOSPHERE, SUPPLY, {"slide": (0.0, 0.16)})


@cache
def truth(rate: float, seconds: float) -> dict[str, np.ndarray]:
    """A machine that fills, vents, rests, strikes its end stop and stands: exactly still where nothing moves."""
    n = int(rate * seconds)
    time = np.arange(n) / rate
    command = np.where(time < 1.0, 0.0, np.round(np.clip(1.4 * np.sin(2 * np.pi * 0.4 * (time - 1.0)), -1, 1), 3))
    command[(time > 7.0) & (time < 8.5)] = 0.0
    level_1, level_2 = np.full(n, ATMOSPHERE), np.full(n, ATMOSPHERE)
    position, speed = np.zeros(n), np.zeros(n)
    for i in range(1, n):
        goal = SUPPLY if command[i] > 0 else ATMOSPHERE
        rest = SUPPLY + ATMOSPHERE - goal
        pull = abs(command[i]) / rate / 0.06
        level_1[i] = level_1[i - 1] + (goal - level_1[i - 1]) * pull
        level_2[i] = level_2[i - 1] + (rest - level_2[i - 1]) * pull if command[i] else level_2[i - 1]
        speed[i] = 0.995 * speed[i - 1] + (level_1[i] - level_2[i]) * 8e-4 / 200.0 / rate if command[i] else 0.0
        position[i] = position[i - 1] + speed[i] / rate
        if not 0.0 < position[i] < 0.16:  # a hard stop
            position[i], speed[i] = np.clip(position[i], 0.0, 0.16), 0.0
    return {"time": time, "command": command, "1": level_1, "2": level_2, "position": position, "speed": speed}


def bench(
    seed: int = 0, noise: float = 1.0, grid: float = 0.0, rate: float = 1000.0, seconds: float = 12.0
) -> Recording:
    rng = np.random.default_rng(seed)
    true = truth(rate, seconds)
    columns = {
        "piston.valve_command": true["command"],
        "piston.pressure_1": _sensed(rng, true["1"], 250.0 * noise, 200.0 * grid),
        "piston.pressure_2": _sensed(rng, true["2"], 250.0 * noise, 200.0 * grid),
        "piston.force": _sensed(rng, (true["1"] - true["2"]) * 8e-4, 1.0 * noise, 0.5 * grid),
        "slide.position": _sensed(rng, true["position"], 2e-5 * noise, 1e-5 * grid),
        "slide.velocity": _sensed(rng, true["speed"], 1e-3 * noise, 0.0),
        "supply.pressure": _sensed(rng, np.full(len(true["1"]), SUPPLY), 300.0 * noise, 0.0),
        "supply.temperature": np.full(len(true["1"]), 293.15),
        "foot.ground_force_z": np.maximum(0.0, 800.0 * np.sin(2 * np.pi * 0.9 * true["time"])),
        "foot.pressure_centre": np.where(np.sin(2 * np.pi * 0.9 * true["time"]) > 0.0, 0.2 * (0.9 * true["time"] % 1.0) - 0.06, 0.0),
    }
    return Recording("bench", true["time"], columns, UNITS)


def _sensed(rng: np.random.Generator, truth: np.ndarray, std: float, step: float) -> np.ndarray:
    values = truth + std * rng.standard_normal(len(truth))
    return np.round(values / step) * step if step else values


def grave(recording: Recording, facts: Facts | None = FACTS) -> list[Finding]:
    return [finding for finding in check(recording, facts) if finding.severity != "info"]


def altered(recording: Recording, key: str, values: np.ndarray) -> Recording:
    return Recording("altered", recording.time, {**recording.columns, key: values}, recording.units)


@settings(deadline=None, max_examples=20)
@example(seed=0, noise=0.3, grid=1.0, rate=100.0)  # at rest in the middle of a step three times as wide as the noise
@given(
    seed=st.integers(0, 10**6),
    noise=st.sampled_from([0.0, 0.01, 0.1, 0.3, 1.0, 4.0]),
    grid=st.sampled_from([0.0, 0.3, 1.0, 5.0]),
    rate=st.sampled_from([100.0, 500.0, 1000.0]),
)
def test_a_clean_recording_raises_nothing(seed: int, noise: float, grid: float, rate: float) -> None:
    assert grave(bench(seed, noise, grid, rate)) == []
    assert grave(bench(seed, noise, grid, rate), None) == []


@pytest.mark.parametrize("noise,grid", [(1.0, 0.0), (1.0, 1.0), (0.1, 3.0), (0.0, 0.0)])
@pytest.mark.parametrize("key", ["piston.pressure_1", "slide.position"])
def test_a_stuck_sensor(key: str, noise: float, grid: float) -> None:
    recording = bench(1, noise, grid)
    values = recording[key].copy()
    start = int(np.argmax(np.abs(values[60:] - values[:-60]))) + 10  # while it moves
    stop = start + 60
    values[start:stop] = values[start]
    assert abs(values[stop] - values[start]) > 0.1 * np.ptp(values)
    (finding,) = [f for f in grave(altered(recording, key, values)) if f.column == key]
    assert finding.kind == "stuck"
    assert finding.use == "set aside"
    (row,) = finding.rows
    assert abs(row[0] - start) <= 3 and abs(row[1] - stop) <= 3
    assert finding.times[0] == pytest.approx((recording.time[row[0]], recording.time[row[1] - 1]))


@pytest.mark.parametrize("noise,grid", [(1.0, 0.0), (1.0, 1.0), (0.3, 1.0)])
def test_a_clipped_sensor(noise: float, grid: float) -> None:
    recording = bench(2, noise, grid)
    values = np.minimum(recording["piston.pressure_1"], 5e5)
    (finding,) = [f for f in grave(altered(recording, "piston.pressure_1", values)) if f.column == "piston.pressure_1"]
    assert finding.kind == "clipped"
    assert "500000 Pa" in finding.says


def test_a_demand_at_its_limit_is_no_sensor_at_its_end() -> None:
    time = np.arange(3000) / 1000.0
    columns = {"p.force": np.clip(900.0 * np.sin(8 * time), -700.0, 700.0), "s.position": np.cos(time)}
    for key, kinds in (("p.force", ["clipped"]), ("p.force_demanded", [])):
        recording = Recording("r", time, {key: columns["p.force"], "s.position": columns["s.position"]}, {key: "N", "s.position": "m"})
        assert [f.kind for f in grave(recording, None)] == kinds


def test_a_clipped_sine_without_noise() -> None:
    time = np.arange(5000, dtype=float) * 1e-3
    values = np.minimum(3e5 + 2e5 * np.sin(2 * np.pi * time), 4e5)
    recording = Recording("r", time, {"p.pressure_1": values, "s.position": np.cos(time)}, {"p.pressure_1": "Pa"})
    assert [f.kind for f in grave(recording, None)] == ["clipped"]


@pytest.mark.parametrize(
    "key,change,kind",
    [
        ("piston.pressure_1", lambda x: x - ATMOSPHERE, "gauge"),
        ("piston.pressure_2", lambda x: x - ATMOSPHERE, "gauge"),
        ("piston.pressure_1", lambda x: x / 1e5, "unit"),
        ("piston.pressure_1", lambda x: x / 1e3, "unit"),
        ("piston.pressure_1", lambda x: x * 4.0, "range"),
        ("piston.pressure_1", lambda x: x * 0.0, "constant"),
        ("slide.position", lambda x: x * 1e3, "unit"),
        ("slide.position", lambda x: x + 0.5, "range"),
        ("slide.velocity", lambda x: -x, "inconsistent"),
        ("slide.velocity", lambda x: x * 1e3, "inconsistent"),
        ("piston.valve_command", lambda x: x * 100.0, "unit"),
        ("piston.valve_command", lambda x: x * 10.0, "unit"),
        ("piston.valve_command", lambda x: x * 1.1, "range"),
        ("supply.temperature", lambda x: x - 273.15, "unit"),
        ("supply.temperature", lambda x: x * 0.0 + 5000.0, "range"),
    ],
)
def test_readings_that_cannot_be(key: str, change: Callable[[np.ndarray], np.ndarray], kind: str) -> None:
    recording = bench(3)
    found = grave(altered(recording, key, change(recording[key])))
    assert [(f.column, f.kind) for f in found] == [(key, kind)]


def test_what_a_sensor_cannot_have_seen_is_taken_out_and_nothing_else() -> None:
    recording = bench(3)
    stuck = Finding("piston.pressure_1", "stuck", "", ((100, 160),), severity="fault", use="set aside")
    unit = Finding("piston.pressure_2", "unit", "", severity="fault", use="set aside")
    noted = Finding("slide.position", "coarse", "", severity="warning", use="used")
    kept = without_faults(recording, [stuck, unit, noted])
    assert set(kept.columns) == set(recording.columns) - {"piston.pressure_2"}
    hole = np.zeros(len(recording.time), bool)
    hole[100:160] = True
    np.testing.assert_array_equal(np.isnan(kept["piston.pressure_1"]), hole)
    np.testing.assert_array_equal(kept["piston.pressure_1"][~hole], recording["piston.pressure_1"][~hole])
    np.testing.assert_array_equal(kept["slide.position"], recording["slide.position"])


def test_missing_samples_and_spikes() -> None:
    recording = bench(4)
    values = recording["piston.pressure_1"].copy()
    values[100:150] = np.nan
    values[4000] = np.nan
    values[[5000, 6000]] = [2e6, -3e5]
    kinds = {f.kind: f for f in grave(altered(recording, "piston.pressure_1", values))}
    assert set(kinds) == {"missing samples", "spikes"}
    assert kinds["missing samples"].rows == ((100, 150), (4000, 4001))
    assert "rows 101-150" in kinds["missing samples"].says
    assert [row[0] for row in kinds["spikes"].rows] == [5000, 6000]


def test_the_clock() -> None:
    recording = bench(5)
    keep = np.ones(len(recording.time), bool)
    keep[3000:3500] = False
    gap = _rows(recording, keep)
    (finding,) = grave(gap)
    assert finding.kind == "gap" and finding.times == ((recording.time[2999], recording.time[3500]),)
    keep[:] = True
    keep[np.random.default_rng(0).integers(1, 11999, 400)] = False
    assert [f.kind for f in grave(_rows(recording, keep))] == ["dropouts"]
    slow = _rows(recording, np.arange(len(recording.time)) % 100 == 0)
    assert "slow clock" in [f.kind for f in grave(slow)]
    jitter = np.random.default_rng(0).uniform(-2e-4, 2e-4, len(recording.time))
    uneven = Recording("r", recording.time + jitter, recording.columns, recording.units)
    assert [f.kind for f in check(uneven, FACTS) if f.column == "time"] == ["jitter"]


def _rows(recording: Recording, keep: np.ndarray) -> Recording:
    columns = {key: values[keep] for key, values in recording.columns.items()}
    return Recording(recording.name, recording.time[keep], columns, recording.units)


def test_a_coarse_sensor_is_told() -> None:
    recording = bench(6)
    values = np.round(recording["piston.pressure_1"] / 1e5) * 1e5
    found = [
        f for f in check(altered(recording, "piston.pressure_1", values), FACTS) if f.column == "piston.pressure_1"
    ]
    assert [f.kind for f in found] == ["quantised"]
    assert "1e+05 Pa" in found[0].says


def test_findings_are_plain_json() -> None:
    import json

    recording = bench(7)
    found = check(altered(recording, "piston.pressure_1", recording["piston.pressure_1"] - ATMOSPHERE), FACTS)
    assert found[0].severity == "fault"
    assert json.loads(json.dumps(found[0].as_dict()))["kind"] == "gauge"
