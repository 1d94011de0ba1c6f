"""Where a play stands in the beginning is what the first pressures say, until the command has passed through its loop."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis.cylinder_runs import STEP, run_of
from diagnosis.subsystems.gas.test_prediction import machine

from exo_sim.diagnosis.subsystems.gas.initial_play import LOOKED_FOR, MOST_PREDICTED, initial_play, samples_of_open_play
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs, inputs
from exo_sim.diagnosis.subsystems.gas.prediction import run_gas

WIDTH, N = 0.06, 1500
TIME = np.linspace(0.0, (N - 1) * STEP, N)


def test_the_play_is_known_once_the_command_has_passed_through_the_loop() -> None:
    command = np.array([0.1, 0.11, 0.1, 0.07, 0.05, 0.2])
    time = TIME[:6]
    assert samples_of_open_play(time, command, 0.055) == 4  # 0.11 to 0.05
    assert samples_of_open_play(time, command, 0.02) == 3
    long = np.linspace(0.0, 10.0, 1001)
    assert samples_of_open_play(long, np.full(1001, 0.1), WIDTH) == pytest.approx(100.0 * LOOKED_FOR, abs=1)


SHAPE = np.sin(np.linspace(0.0, 6.0, 50))


def missed(one: float, other: float) -> np.ndarray:
    """Return errors of two chambers, in proportion to how far off each play is."""
    return np.stack([one * SHAPE, 2.0 * other * SHAPE], axis=1) + 7.0  # a zero that is off


@pytest.mark.parametrize("true", [-1.0, -0.7, 0.0, 0.3, 1.0])
def test_the_least_error_is_found_between_the_places_that_are_tried(true: float) -> None:
    assert initial_play(lambda one, other: missed(one - true, other + true), together=False) == pytest.approx((true, -true), abs=1e-6)
    assert initial_play(lambda one, other: missed(one - true, other - true), together=True) == pytest.approx((true, true), abs=1e-6)
    unmeasured = np.array([1.0, np.nan])
    assert initial_play(lambda one, other: missed(one - true, other) * unmeasured, together=True) == pytest.approx((true, true), abs=1e-6)


@pytest.mark.parametrize("true", [-0.85, -0.4, 0.15, 0.65])
def test_errors_that_are_no_parabola_of_the_place_are_followed(true: float) -> None:
    found = initial_play(lambda one, other: missed(*(np.tanh(2.0 * (place - true)) for place in (one, other))), together=True)
    assert found == pytest.approx((true, true), abs=0.02)


def test_pressures_that_say_nothing_leave_it_in_the_middle() -> None:
    assert initial_play(lambda one, other: missed(1.0, 1.0), together=False) == (0.0, 0.0)
    assert initial_play(lambda one, other: np.full((50, 2), np.nan), together=True) == (0.0, 0.0)
    closed = initial_play(lambda one, other: missed(max(one, 0.6), max(other, 0.6)), together=True)  # a dead band hides the rest
    assert closed[0] == closed[1] < 0.6


def slow(middle: float) -> np.ndarray:
    return middle + 0.04 * np.sin(3.0 * TIME)


def behind(command: np.ndarray, place: float) -> np.ndarray:
    """Return what a play that stood at this place lets through of a command."""
    through, now = np.empty_like(command), float(command[0] + 0.5 * WIDTH * place)
    for i, value in enumerate(command):
        through[i] = now = min(max(now, value - 0.5 * WIDTH), value + 0.5 * WIDTH)
    return through


@pytest.mark.parametrize(("place", "independent"), [(-0.8, False), (0.0, False), (0.6, False), (0.6, True)])
def test_a_recording_that_begins_anywhere_in_the_loop_is_predicted(place: float, independent: bool) -> None:
    world, cylinder = machine()
    cylinder["independent"] = float(independent)
    level, length = np.full(N, 3e5), np.full(N, 0.1)

    def recorded(commands: tuple[np.ndarray, np.ndarray], pressures: tuple[np.ndarray, np.ndarray] = (level, level)) -> GasInputs:
        second = commands[1] if independent else None
        run = run_of(*pressures, length=length, command=commands[0], commanded=True, command_2=second)
        return inputs(run, world, 10.0)

    told = slow(0.08), slow(-0.1)
    true = run_gas(recorded((behind(told[0], place), behind(told[1], -place))), world, cylinder).pressure
    plain = run_gas(recorded(told, (true[:, 0], true[:, 1])), world, cylinder).pressure
    cylinder["valve_hysteresis"]["width"] = WIDTH
    found = run_gas(recorded(told, (true[:, 0], true[:, 1])), world, cylinder)
    assert np.abs(found.pressure - true).max() < 0.03 * np.abs(plain - true).max()
    shown = max(samples_of_open_play(TIME, command, WIDTH) for command in (told[0], told[1] if independent else -told[0]))
    times, rest = divmod(found.samples - N, shown)  # all that an effort counts; the middle is predicted at first
    assert rest == 0 and times <= MOST_PREDICTED and (times == MOST_PREDICTED or place == 0.0)
