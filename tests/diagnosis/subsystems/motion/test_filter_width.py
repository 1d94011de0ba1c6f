"""The width that noise asks for: as good as the best one there is, the least where there is no noise, and theory says what is left."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.diagnosis.subsystems.motion import filter_width
from exo_sim.diagnosis.subsystems.motion.filter_width import WIDER, WIDEST, asked_width
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothing_width
from exo_sim.recording.filters import gaussian_derivatives, noise_gain, restored, smoothed_motion
from exo_sim.recording.noise import white_noise

Array = NDArray[np.float64]


def swing(rate: float, pulse: float, seconds: float = 20.0) -> tuple[Array, Array]:
    """Return the clock and position of a swing of two waves, the slower of so many radians a second."""
    time = np.arange(0.0, seconds, 1.0 / rate)
    return time, 0.3 * np.sin(pulse * time) + 0.05 * np.sin(2.3 * pulse * time)


def acceleration(time: Array, pulse: float) -> Array:
    return np.asarray(-(pulse**2) * 0.3 * np.sin(pulse * time) - 0.05 * (2.3 * pulse) ** 2 * np.sin(2.3 * pulse * time))


def errors(time: Array, true: Array, noisy: Array, pulse: float, seconds: float) -> tuple[float, float]:
    """Return noise and bias of the acceleration behind a filter, root mean square away from its ends."""
    inner = slice(int(1.3 * seconds / (time[1] - time[0])) + 2, -int(1.3 * seconds / (time[1] - time[0])) - 2)
    clean = gaussian_derivatives(time, true, seconds)[2]
    noise = smoothed_motion(time, noisy, seconds).acceleration - clean
    return float(np.std(noise[inner])), float(np.std((restored(time, clean, seconds) - acceleration(time, pulse))[inner]))


@pytest.mark.parametrize(
    ("rate", "noise", "pulse"), [(100.0, 1e-3, 2.6), (30.0, 5e-4, 2.6), (1000.0, 1e-4, 12.0), (100.0, 5e-4, 4.0), (250.0, 2e-3, 3.0)]
)
def test_the_acceleration_is_nearly_as_good_as_behind_the_best_filter(rate: float, noise: float, pulse: float) -> None:
    time, true = swing(rate, pulse)
    noisy = true + noise * np.random.default_rng(2).standard_normal(time.size)
    least = smoothing_width(time)
    asked = asked_width(time, [noisy])

    def total(seconds: float) -> float:
        return float(np.hypot(*errors(time, true, noisy, pulse, seconds)))

    best = min(total(float(seconds)) for seconds in np.geomspace(least, 1.6, 24))
    assert asked.seconds > 1.2 * least
    assert total(asked.seconds) < 1.35 * best
    assert total(asked.seconds) < 0.6 * total(least)


@pytest.mark.parametrize(("rate", "noise"), [(30.0, 5e-4), (100.0, 1e-3), (250.0, 2e-3)])
def test_what_noise_leaves_is_what_theory_says(rate: float, noise: float) -> None:
    time, true = swing(rate, 2.6, 60.0)
    noisy = true + noise * np.random.default_rng(3).standard_normal(time.size)
    asked = asked_width(time, [noisy])
    assert asked.noise[0] == pytest.approx(noise, rel=0.1)
    left, bias = errors(time, true, noisy, 2.6, asked.seconds)
    assert left == pytest.approx(noise * noise_gain(2, asked.seconds, 1.0 / rate), rel=0.25)
    assert bias < 3.0 * left  # no more motion is lost than noise is left: what is said of it holds within the step between two widths
    assert asked.bias[0] < 2.0 * left


def test_a_quiet_position_keeps_the_least_filter_of_its_clock() -> None:
    time, true = swing(1000.0, 12.0)
    noisy = true + 1e-6 * np.random.default_rng(4).standard_normal(time.size)
    asked = asked_width(time, [noisy])
    assert asked.seconds == smoothing_width(time)
    assert asked.bias == (0.0,)


def test_noise_of_which_neighbours_share_a_part_is_not_taken_for_motion() -> None:
    time, true = swing(100.0, 2.6)
    white = 1e-3 * np.random.default_rng(5).standard_normal(time.size + 1)
    shared = 0.5 * (white[1:] + white[:-1])
    plain, coloured = (asked_width(time, [true + noise]) for noise in (white[1:], shared))
    assert coloured.seconds == pytest.approx(plain.seconds, rel=WIDER - 0.99)
    assert coloured.noise[0] == pytest.approx(1e-3, rel=0.15)  # at the frequencies that the filter lets through
    assert white_noise(true + shared) < 5e-4  # of the finest differences


def test_of_several_joints_the_one_that_asks_for_the_least_says_it_and_one_that_rests_says_nothing() -> None:
    time, slow = swing(100.0, 2.6)
    quick = swing(100.0, 9.0)[1]
    chance = np.random.default_rng(6)
    slow, quick, still = (values + 1e-3 * chance.standard_normal(time.size) for values in (slow, quick, np.zeros(time.size)))
    alone = asked_width(time, [quick]).seconds
    assert alone < asked_width(time, [slow]).seconds
    both = asked_width(time, [slow, still, quick])
    assert both.seconds == pytest.approx(alone)
    assert both.bias[1] == 0.0
    assert asked_width(time, [still]).seconds == smoothing_width(time)


def test_no_filter_is_tried_that_is_wider_than_one_behind_which_all_of_the_motion_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of an hour the widest would be five minutes, and take as many."""
    tried: list[float] = []
    restored = filter_width._restored_acceleration

    def counted(time: Array, values: Array, seconds: float) -> Array:
        tried.append(seconds)
        return restored(time, values, seconds)

    monkeypatch.setattr(filter_width, "_restored_acceleration", counted)
    time = np.arange(0.0, 400.0, 0.01)
    position = 0.02 * np.sin(2.0 * np.pi * time) + 1e-4 * np.random.default_rng(5).standard_normal(time.size)
    asked = asked_width(time, [position])
    assert asked.seconds < max(tried) < 2.0 < WIDEST * 400.0
