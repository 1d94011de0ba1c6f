"""Rates at one moment: far better than from five samples where the position is noisy, as wrong as they are said to be."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.recording.filters import first_rate_gain, smoothed
from exo_sim.recording.local_state import LEAST, LocalStates, first_rate_error, is_noisy
from exo_sim.recording.noise import white_noise

Array = NDArray[np.float64]
PULSE, DRAWS = 2.6, 40


def swing(rate: float, phase: float, noise: float = 0.0, seed: int = 0) -> tuple[Array, Array]:
    time = np.arange(0.0, 10.0, 1.0 / rate)
    return time, 0.3 * np.sin(PULSE * time + phase) + noise * np.random.default_rng(seed).standard_normal(time.size)


@pytest.mark.parametrize("moment", [0.0, 3.3])
@pytest.mark.parametrize(("rate", "noise", "better"), [(30.0, 1e-3, 2.5), (100.0, 1e-3, 8.0), (1000.0, 1e-3, 30.0)])
def test_noisy_rates_beat_few_samples_and_are_as_wrong_as_is_said(rate: float, noise: float, better: float, moment: float) -> None:
    errors, few, said = [], [], []
    for draw in range(DRAWS):
        phase = 2.0 * np.pi * draw / DRAWS
        time, values = swing(rate, phase, noise, draw)
        at = int(np.searchsorted(time, moment))
        state = LocalStates(time, values, noise).at(float(time[at]))
        true = 0.3 * PULSE * np.cos(PULSE * time[at] + phase)
        errors.append(state.rate - true)
        few.append(smoothed(time, values)[1][at] - true)
        said.append(state.error)
    assert np.std(errors) < np.std(few) / better
    assert 0.6 * np.mean(said) < np.std(errors) < 2.2 * np.mean(said)


def test_a_cubic_is_said_exactly_also_between_samples_and_beside_missing_ones() -> None:
    time, _ = swing(100.0, 0.0)
    values = 0.1 + 0.5 * time - 0.2 * time**2 + 0.03 * time**3
    values[40:60] = np.nan
    for moment in (0.0, 0.453, 5.0, float(time[-1])):
        state = LocalStates(time, values, 1e-3).at(moment)
        assert state.position == pytest.approx(0.1 + 0.5 * moment - 0.2 * moment**2 + 0.03 * moment**3, abs=1e-9)
        assert state.rate == pytest.approx(0.5 - 0.4 * moment + 0.09 * moment**2, abs=1e-8)
        assert state.change == pytest.approx(-0.4 + 0.18 * moment, abs=1e-7)


def test_a_quiet_position_keeps_the_fewest_samples() -> None:
    time, values = swing(100.0, 0.4, 1e-9)
    states = LocalStates(time, values, 1e-9)
    assert states.inside.samples <= LEAST + 4
    assert states.at_end.samples <= LEAST + 4
    assert not is_noisy(time, values)
    assert first_rate_error(time, values) == pytest.approx(white_noise(values) * first_rate_gain(time))


def test_the_first_rate_of_a_noisy_position_is_said_to_be_better_than_from_five_samples() -> None:
    time, values = swing(30.0, 0.4, 1e-3)
    assert is_noisy(time, values)
    assert first_rate_error(time, values) < 0.5 * white_noise(values) * first_rate_gain(time)
