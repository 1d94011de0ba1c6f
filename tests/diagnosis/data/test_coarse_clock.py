"""A quick logger's cylinder on a coarser clock: means at the mean of their times, commands as long as they were held, breaks kept."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import cylinder_runs
from hypothesis import given, settings
from hypothesis import strategies as st

from exo_sim.diagnosis.data.coarse_clock import on_coarse_clock
from exo_sim.diagnosis.policy.recordings import FINE_PERIOD

N = 4001


def clock(rate: float) -> np.ndarray:
    return np.arange(N) / rate


@pytest.mark.parametrize("rate", [200.0, 1000.0, 1500.0])
def test_a_slow_logger_s_run_is_left_alone(rate: float) -> None:
    run = cylinder_runs.run_of(np.full(N, 4e5), time=clock(rate))
    assert on_coarse_clock(run) is run


@given(rate=st.sampled_from([2000.0, 3000.0, 5000.0, 10000.0]), lag=st.floats(0.0, 0.3))
@settings(max_examples=20)
def test_a_straight_line_stays_the_same_line(rate: float, lag: float) -> None:
    time = clock(rate)
    run = on_coarse_clock(cylinder_runs.run_of(1e5 + 3e4 * (time - lag), time=time))
    assert np.median(np.diff(run.time)) == pytest.approx(FINE_PERIOD)
    assert run.pressure[0] == pytest.approx(1e5 + 3e4 * (run.time - lag))


def test_what_a_held_command_lets_through_is_the_same() -> None:
    time = clock(2000.0)
    command = 0.04 * np.sign(np.sin(37.0 * time))
    run = on_coarse_clock(cylinder_runs.run_of(np.full(N, 4e5), time=time, command=command))

    def passed(clock: np.ndarray, held: np.ndarray, until: float) -> float:
        return float(np.interp(until, clock, np.concatenate([[0.0], np.cumsum(held[:-1] * np.diff(clock))])))

    first, last = run.time[0], run.time[-1]
    for until in np.linspace(first, last, 7)[1:]:
        fine = passed(time, command, until) - passed(time, command, first)
        assert passed(run.time, run.command, until) == pytest.approx(fine, abs=0.08 * FINE_PERIOD)
    assert passed(run.time, run.command, last) == pytest.approx(passed(time, command, last) - passed(time, command, first), abs=1e-9)


def test_a_valve_that_is_switched_over_is_never_half_open() -> None:
    time = clock(4000.0)
    command = np.sign(np.sin(37.0 * time + 0.1))
    run = on_coarse_clock(cylinder_runs.run_of(np.full(N, 4e5), time=time, command=command))
    assert len(run.time) < N // 3 and set(np.unique(run.command)) == {-1.0, 1.0}
    late = np.abs(run.command - command[np.searchsorted(time, run.time, side="right") - 1]) > 0.0
    assert late.sum() <= np.count_nonzero(np.diff(command))  # by less than a group, once a switch


def test_a_valve_that_works_in_pulses_keeps_its_clock() -> None:
    pulses = (np.arange(N) % 20 < 7).astype(float)
    run = cylinder_runs.run_of(np.full(N, 4e5), time=clock(2000.0), command=pulses)
    assert on_coarse_clock(run) is run


def test_a_clock_that_is_a_little_off_is_the_same_clock() -> None:
    run = on_coarse_clock(cylinder_runs.run_of(np.full(N, 4e5), time=np.arange(N) * 0.50002e-3))
    assert len(run.time) == N // 2


def test_noise_falls_as_that_of_means_does() -> None:
    noise = np.random.default_rng(3).normal(0.0, 300.0, N)
    run = on_coarse_clock(cylinder_runs.run_of(4e5 + noise, time=clock(4000.0), noise=(300.0, 0.0), position_noise=1e-5))
    assert run.noise[0] == pytest.approx(150.0, rel=0.15)
    assert run.position_noise == pytest.approx(0.5e-5)


def test_no_group_holds_a_break_and_one_that_lacks_a_sample_is_of_the_others() -> None:
    time = clock(2000.0)
    time[1001:] += 5.0
    pressure = np.where(np.arange(N) < 1001, 2e5, 6e5)
    pressure[300] = pressure[602] = pressure[603] = np.nan
    run = on_coarse_clock(cylinder_runs.run_of(pressure, time=time, breaks=(0, 1001)))
    values = run.pressure[0]
    assert values is not None
    assert run.breaks == (0, 500) and run.time[run.breaks[1]] > 5.0 > run.time[run.breaks[1] - 1]
    assert set(np.unique(values[np.isfinite(values)])) == {2e5, 6e5}
    assert np.flatnonzero(np.isnan(values)).tolist() == [301]
