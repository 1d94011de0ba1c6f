"""What gauges and encoders show: noise about what is, places in steps of the encoder, a speed that lags."""

import numpy as np
import pytest

from exo_sim.control.force_signals import ENCODER, PRESSURE, SMOOTHING, gauges, seen

DT = 1e-3


def test_exact_signals_have_no_noise_at_hand():
    assert gauges(4, "exact").noise.shape == (0, 8)


def test_pressures_are_noisy_about_what_is_and_come_again_by_the_seed():
    one, again, other = (gauges(1, "measured", seed) for seed in (3, 3, 4))
    shown = np.array([seen(0, k, DT, 0.0, 0.05, 0.1, 5e5, 3e5, one)[:2] for k in range(4000)])
    assert shown.mean(axis=0) == pytest.approx([5e5, 3e5], abs=5 * PRESSURE / np.sqrt(4000))
    assert shown.std(axis=0) == pytest.approx([PRESSURE, PRESSURE], rel=0.06)
    assert (one.noise == again.noise).all() and not (one.noise == other.noise).all()


def test_place_and_speed_follow_the_encoder():
    it, arm, rate = gauges(1, "measured"), 0.06, 2.0
    angle = rate * DT * np.arange(200)
    _, _, place, speed = np.array([seen(0, k, DT, angle[k], arm, 0.1 + arm * angle[k], 5e5, 5e5, it) for k in range(200)]).T
    assert np.abs(place - 0.1 - arm * angle).max() <= 0.5 * arm * ENCODER + 1e-12
    assert speed[0] == 0.0
    assert speed[100:].mean() == pytest.approx(arm * rate, rel=0.01)
    assert speed[round(SMOOTHING / DT)] == pytest.approx((1 - np.exp(-1)) * arm * rate, rel=0.15)
