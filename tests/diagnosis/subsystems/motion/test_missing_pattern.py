"""What a missing force depends on: along the piston's direction, or against its motion."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import POSITION, TIME, VELOCITY

from exo_sim.diagnosis.subsystems.motion.missing_pattern import closer_over, force_or_friction, signals_of
from exo_sim.diagnosis.subsystems.motion.rows import rows_of

RUN = motion_runs.balance(np.zeros(TIME.size), 0.1)
ROWS = rows_of(RUN, np.ones(TIME.size, dtype=bool))


@pytest.mark.parametrize(
    ("missing", "index", "variable"),
    [(400.0 * POSITION, 0, "position"), (-np.sign(VELOCITY) * (5.0 + 300.0 * POSITION), 1, "position"), (-60.0 * VELOCITY, 0, "velocity")],
    ids=["spring", "friction by place", "damping"],
)
def test_the_curve_that_follows_it_is_found(missing: np.ndarray, index: int, variable: str) -> None:
    both = force_or_friction([RUN], [ROWS], [missing], ROWS.block, "N", "force balance")
    assert [one.acts for one in both] == ["force", "friction"]
    assert both[index].pattern >= both[1 - index].pattern
    best = both[index].best
    assert best is not None and best.variable == variable
    assert both[0].size == pytest.approx(float(np.sqrt(np.mean(ROWS.means(missing) ** 2))))


@pytest.mark.parametrize(
    ("missing", "acts"), [(400.0 * POSITION, "force"), (-np.sign(VELOCITY) * 400.0 * POSITION, "friction")], ids=["force", "friction"]
)
def test_what_follows_a_place_is_a_force_or_a_friction_as_it_turns_with_the_motion(missing: np.ndarray, acts: str) -> None:
    both = force_or_friction([RUN], [ROWS], [missing], ROWS.block, "N", "force balance")
    found = closer_over(both, ["position"])
    assert found.acts == acts and found.curves[0].variable == "position"
    assert found.otherwise is not None and found.otherwise < found.pattern


def test_pressures_count_where_a_cylinder_drives() -> None:
    gauge = np.column_stack([TIME, 2.0 * TIME])
    driven = signals_of(motion_runs.behind_cylinder(RUN, gauge))
    assert set(signals_of(RUN)) == {"position", "velocity", "time"}
    np.testing.assert_array_equal(driven["pressure_difference"], -TIME)
