"""What every law of friction gets wrong, as columns: odd in the direction of motion, and as large as healthy machines show."""

from __future__ import annotations

import numpy as np
from diagnosis import motion_runs

from exo_sim.diagnosis.policy import healthy
from exo_sim.diagnosis.policy.healthy import FEWEST_FOR_FUNCTIONS
from exo_sim.diagnosis.subsystems.motion.discrepancy_basis import PLACE, SPEED, TIME, friction_discrepancy

PATH = slice(0, 8000, 20)
X, V, T = motion_runs.POSITION[PATH], motion_runs.VELOCITY[PATH], motion_runs.TIME[PATH]
ONE = np.zeros(X.size, dtype=np.int64)


def test_its_kinds_are_place_speed_direction_and_time_with_healthy_amplitudes() -> None:
    basis = friction_discrepancy(X, V, T, ONE, np.ones(X.size), friction=10.0, effort=100.0)
    assert basis.names == ("position", "velocity", "direction", "time")
    np.testing.assert_array_equal(np.bincount(basis.kinds), [2 * PLACE, SPEED, SPEED, TIME])
    shares = np.array([healthy.FRICTION_PLACE, healthy.FRICTION_SPEED, healthy.FRICTION_DIRECTION, healthy.FRICTION_TIME])
    np.testing.assert_allclose(basis.healthy, shares * 10.0 + healthy.FORCE_UNEXPLAINED * 100.0)


def test_it_resists_the_motion() -> None:
    """Turned round, speed and time columns change their sign: friction is odd in the velocity, but where directions differ."""
    there, back = (friction_discrepancy(X, v, T, ONE, np.ones(X.size), 10.0, 100.0) for v in (V, -V))
    odd, even = (there.kinds == 1) | (there.kinds == 3), there.kinds == 2
    np.testing.assert_allclose(back.columns[:, odd], -there.columns[:, odd], atol=1e-12)
    np.testing.assert_allclose(back.columns[:, even], there.columns[:, even], atol=1e-12)


def test_viscous_friction_that_differs_by_direction_is_in_it() -> None:
    """(c + d) v one way and (c - d) v the other: d |v| less its mean lies in the span of the functions of speed by direction."""
    basis = friction_discrepancy(X, V, T, ONE, np.ones(X.size), 10.0, 100.0)
    moving = np.abs(V) > 0.05 * np.abs(V).max()
    columns = np.column_stack([basis.columns[:, basis.kinds == 2], np.ones(X.size)])[moving]
    apart = np.abs(V[moving])
    left = apart - columns @ np.linalg.lstsq(columns, apart, rcond=None)[0]
    assert np.std(left) < 0.15 * np.std(apart)
    one_way = friction_discrepancy(X, np.abs(V) + 1e-3, T, ONE, np.ones(X.size), 10.0, 100.0)
    assert "direction" not in one_way.names


def test_each_way_and_each_recording_has_a_function_of_its_own() -> None:
    two = (np.arange(X.size) >= X.size // 2).astype(np.int64)
    basis = friction_discrepancy(X, V, T, two, np.ones(X.size), 10.0, 100.0)
    assert np.count_nonzero(basis.kinds == 3) == 2 * TIME
    late = basis.columns[:, basis.kinds == 3]
    assert not late[two == 1, :TIME].any() and not late[two == 0, TIME:].any()
    one_way = friction_discrepancy(X, np.abs(V) + 1e-3, T, ONE, np.ones(X.size), 10.0, 100.0)
    assert np.count_nonzero(one_way.kinds == 0) == PLACE


def test_precise_rows_weigh_more_and_few_rows_have_none() -> None:
    plain, weighed = (friction_discrepancy(X, V, T, ONE, w, 10.0, 100.0) for w in (np.ones(X.size), np.full(X.size, 3.0)))
    np.testing.assert_allclose(weighed.columns, 3.0 * plain.columns)
    few = slice(0, FEWEST_FOR_FUNCTIONS)
    assert "position" not in friction_discrepancy(X[few], V[few], T[few], ONE[few], np.ones(FEWEST_FOR_FUNCTIONS), 10.0, 100.0).names
