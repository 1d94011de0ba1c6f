"""Behind a transmission that gives, friction goes with the piston; while play is open nobody knows where that goes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs
from numpy.typing import NDArray

from exo_sim.diagnosis.coupling.piston_motion import at_piston
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothing_width
from exo_sim.physics.plant_records import CYLINDER

TIME, ACCELERATION = motion_runs.TIME, motion_runs.ACCELERATION


def driven() -> MotionRun:
    nothing = np.zeros(TIME.size)
    return motion_runs.behind_cylinder(motion_runs.balance(nothing), np.zeros((TIME.size, 2)))


def cylinder(**effects: dict[str, float]) -> NDArray[np.void]:
    record = np.zeros(1, CYLINDER)
    for effect, values in effects.items():
        for name, value in values.items():
            record[effect][name] = value
    return record


def test_a_rigid_transmission_changes_nothing() -> None:
    run = driven()
    assert at_piston(run, None) is run


def test_the_piston_is_ahead_of_the_joint_by_what_the_carried_force_deflects() -> None:
    run = driven()
    soft = at_piston(run, cylinder(transmission_compliance={"stiffness": 1e4}))
    inside = slice(200, -200)
    ahead = motion_runs.MASS * ACCELERATION / 1e4
    found = soft.kinematics.position - run.kinematics.position
    # what never passed the filter is restored by (7.3/s * 7.75 ms)^2 / 2 too far
    np.testing.assert_allclose(found[inside], ahead[inside], atol=2e-3 * np.abs(ahead).max())
    assert soft.judged.all()


@pytest.mark.parametrize("gap", [2e-4, 2e-3])
def test_play_is_not_judged_where_the_carried_force_reverses_and_only_there(gap: float) -> None:
    judged = at_piston(driven(), cylinder(backlash={"gap": gap})).judged
    turns = TIME[np.flatnonzero(np.diff(np.signbit(ACCELERATION)))]
    away = np.abs(TIME[:, None] - turns[None, :]).min(axis=1)
    assert len(turns) > 5
    assert not judged[away < smoothing_width(TIME)].any()
    assert judged[away > 2.0 * smoothing_width(TIME)].all()


def test_play_that_stays_taken_up_is_judged_throughout() -> None:
    run = driven()
    loaded = replace(run, inertia=replace(run.inertia, force=run.inertia.force + 9.81 * motion_runs.MASS))
    assert at_piston(loaded, cylinder(backlash={"gap": 1e-3})).judged.all()


def test_what_was_not_known_before_stays_so() -> None:
    known = TIME > 1.0
    run = replace(driven(), known=known)
    assert not at_piston(run, cylinder(backlash={"gap": 1e-3})).judged[~known].any()
