"""The terms of a balance of forces: what the motion takes beyond its springs and dampers, and how large the forces are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.motion_runs import ACCELERATION, MASS, TIME, VELOCITY, balance, behind_cylinder

from exo_sim.diagnosis.data.motion_run import Passive


def test_the_demand_is_what_springs_and_dampers_of_the_model_do_not_supply() -> None:
    damper = -12.0 * VELOCITY
    run = replace(balance(np.zeros(TIME.size)), passive=Passive(damper, damper))
    np.testing.assert_allclose(run.demand, MASS * ACCELERATION + 12.0 * VELOCITY)


def test_the_effort_counts_what_drives_and_what_the_motion_takes() -> None:
    run = balance(np.zeros(TIME.size))  # the outside force is the inertia
    assert run.effort == pytest.approx(2.0 * MASS * float(np.std(ACCELERATION)))
    assert run.cylinder is None
    driven = behind_cylinder(run, np.zeros((TIME.size, 2)))
    assert driven.cylinder == "piston" and driven.effort == pytest.approx(run.effort)
