"""Windows of the gas cut: they cover a run, keep to its stretches, and begin where the gas is quiet nearby."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import cylinder_runs
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.policy.recordings import LEAD_IN
from exo_sim.diagnosis.subsystems.gas.inputs import START_SAMPLES, windows
from exo_sim.recording.windows import QUIET_REACH, window_starts
from exo_sim.simulation.replay import inputs as replay

N = 4000
SECONDS = 0.5


def bursts(seed: int, side: int = 0) -> np.ndarray:
    """Return a pressure that holds, and moves for a while now and then [Pa]."""
    rng = np.random.default_rng([seed, side])
    flow = np.zeros(N)
    for begin in rng.integers(0, N - 200, 12):
        flow[begin : begin + int(rng.integers(20, 200))] += rng.normal(0.0, 800.0)
    return 4e5 + np.cumsum(flow) + 30.0 * rng.standard_normal(N)


def local_range(run: CylinderRun, at: int) -> float:
    """Return by how much the pressures of a run swing around a sample [Pa]."""
    around = slice(max(at - START_SAMPLES, 0), at + START_SAMPLES)
    return sum(float(np.ptp(values[around])) for values in run.pressure if values is not None)


@given(seed=st.integers(0, 10**6), inner=st.sets(st.integers(1, N - 1), max_size=5), seconds=st.floats(0.05, 5.0))
@settings(max_examples=40)
def test_they_cover_every_sample_once_and_keep_to_stretches(seed: int, inner: set[int], seconds: float) -> None:
    run = cylinder_runs.run_of(bursts(seed), bursts(seed, 1), breaks=(0, *sorted(inner)))
    cut = windows(run, seconds)
    assert cut.starts[0] == 0 and cut.stops[-1] == N
    assert (np.diff(cut.starts) > 0).all()
    np.testing.assert_array_equal(cut.stops[:-1], cut.starts[1:])
    assert set(run.breaks) <= set(cut.starts.tolist())
    assert cut.pressure.shape == (len(cut.starts), 2)


@given(seed=st.integers(0, 10**6))
@settings(max_examples=40)
def test_they_begin_no_louder_and_not_far_from_where_they_would(seed: int) -> None:
    run = cylinder_runs.run_of(bursts(seed), bursts(seed, 1))
    starts = windows(run, SECONDS).starts
    count = len(starts)
    nominal = np.arange(count) * (run.time[-1] / count) / cylinder_runs.STEP
    assert (np.abs(starts - nominal) <= QUIET_REACH * N / count + 1.0).all()
    for start, plain in zip(starts[1:], nominal[1:], strict=True):
        assert local_range(run, int(start)) <= local_range(run, int(np.ceil(plain)))


def test_a_start_in_a_burst_moves_out_of_it() -> None:
    pressure = np.full(N, 4e5)
    at = N // 2
    pressure[at - 100 : at + 60] += np.linspace(0.0, 1e5, 160)
    pressure[at + 60 :] += 1e5
    start = int(windows(cylinder_runs.run_of(pressure), 2.0).starts[1])
    assert not at - 100 - START_SAMPLES < start < at + 60 + START_SAMPLES - 1
    assert abs(start - at) <= QUIET_REACH * N / 2


@given(seed=st.integers(0, 10**6), slope=st.floats(-2e4, 2e4))
@settings(max_examples=20)
def test_they_begin_at_the_pressure_itself_not_at_a_jittery_sample(seed: int, slope: float) -> None:
    time = np.arange(N) * cylinder_runs.STEP
    clean = 4e5 + slope * time
    jitter = 300.0
    run = cylinder_runs.run_of(clean + jitter * np.random.default_rng(seed).standard_normal(N))
    cut = windows(run, SECONDS)
    off = cut.pressure[:, 0] - clean[cut.starts]
    # a parabola's end through 15 samples keeps 0.77 of the jitter; windows seek out what is quiet by chance
    assert np.sqrt(np.mean(off**2)) < 1.5 * jitter and np.abs(off).max() < 4.0 * jitter
    assert np.isnan(cut.pressure[:, 1]).all()


def test_no_window_begins_in_a_hole_that_it_can_avoid() -> None:
    pressure = bursts(3)
    pressure[N // 2 - 20 : N // 2 + 20] = np.nan
    start = int(windows(cylinder_runs.run_of(pressure), 2.0).starts[1])
    assert np.isfinite(pressure[start - START_SAMPLES : start + START_SAMPLES]).all()


@pytest.mark.parametrize("seconds", [0.1, 0.5, 1.2])
def test_a_clock_that_changes_its_pace_is_covered_as_well(seconds: float) -> None:
    steps = np.where(np.arange(1000) < 100, 10e-3, 1e-3)
    run = cylinder_runs.run_of(np.linspace(5e5, 4e5, 1000), time=np.cumsum(steps))
    cut = windows(run, seconds)
    assert cut.starts[0] == 0 and cut.stops[-1] == 1000
    assert (np.diff(cut.starts) > 0).all()


def test_where_all_is_equally_quiet_windows_are_even() -> None:
    time = np.arange(1000, dtype=float) * 1e-3
    assert window_starts(time, 0, 1000, 0.25, np.zeros(1000)) == [0, 250, 500, 750]
    assert window_starts(time, 200, 1000, 0.4, np.zeros(1000)) == [200, 600]
    assert window_starts(time, 200, 1000, np.inf, np.zeros(1000)) == [200]


def test_a_stretch_of_a_working_valve_is_led_in_until_commands_from_before_are_forgotten() -> None:
    command = np.where(np.arange(N) % 200 < 100, 0.5, -0.5)
    level = np.full(N, 4e5)
    at = 2 * N // 3
    short = N - 300
    cut = windows(cylinder_runs.run_of(level, level, command=command, commanded=True, breaks=(0, at, short)), SECONDS)
    leading = cut.starts[cut.lead]
    assert leading.tolist() == [0, at]  # the last stretch is too short
    np.testing.assert_allclose(cut.stops[cut.lead] - leading, LEAD_IN / cylinder_runs.STEP, atol=1.0)
    assert not cut.compared[0] and cut.compared[-1] and cut.compared.shape == (N,)
    np.testing.assert_array_equal(cut.stops[:-1], cut.starts[1:])
    held = cylinder_runs.run_of(level, level, command=np.full(N, 0.5), commanded=True)
    assert not windows(held, SECONDS).lead.any()


def both_starts(values: NDArray[np.float64], rate: float) -> tuple[float, float]:
    """Return the pressure at the start of one long window, as the fit of the gas and as a replay estimates it [Pa]."""
    time = np.arange(len(values)) / rate
    gas = windows(cylinder_runs.run_of(values, time=time), np.inf).pressure
    pieces = replay.steps(time, 1e-3)
    return float(gas[0, 0]), float(replay.start_pressures(pieces, np.array([0]), time, values)[0])


@pytest.mark.parametrize("rate", [100.0, 200.0, 500.0, 1000.0, 4000.0])
@pytest.mark.parametrize("filling", [0.0, 2e6])
def test_gas_and_replay_start_from_the_same_pressure_at_rest_and_where_it_rises_steadily(rate: float, filling: float) -> None:
    values = np.array(4e5 + filling * np.arange(400) / rate, dtype=np.float64)
    assert both_starts(values, rate) == pytest.approx((4e5, 4e5), rel=1e-9)


def test_at_a_kilohertz_gas_and_replay_start_from_the_same_pressure_whatever_it_does() -> None:
    gas, replayed = both_starts(bursts(3), 1000.0)
    assert gas == pytest.approx(replayed, rel=1e-12)
