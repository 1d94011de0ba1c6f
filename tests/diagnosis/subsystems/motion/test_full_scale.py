"""What counts as a large force and a long travel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import ACCELERATION, MASS, POSITION, TIME

from exo_sim.diagnosis.subsystems.motion.full_scale import full_force, full_travel


def test_a_cylinder_pushes_with_its_supply_over_its_stroke() -> None:
    run = motion_runs.behind_cylinder(motion_runs.balance(np.zeros(TIME.size)), np.zeros((TIME.size, 2)))
    assert full_force(run, motion_runs.plant()) == pytest.approx(6e5 * 8e-4)
    assert full_travel(run, motion_runs.plant()) == (0.0, 0.2)


def test_without_a_cylinder_it_is_what_acted_where_the_joint_went() -> None:
    run = motion_runs.balance(np.zeros(TIME.size))
    assert full_force(run, motion_runs.plant()) == pytest.approx(MASS * np.percentile(np.abs(ACCELERATION), 99.0))
    assert full_travel(run, motion_runs.plant()) == (POSITION.min(), POSITION.max())


def test_a_cylinder_open_to_the_room_counts_what_pulls_it() -> None:
    pulled = motion_runs.balance(np.full(TIME.size, 500.0))
    vented = motion_runs.plant()
    vented.world["supply_pressure"] = vented.world["atmosphere"]
    assert full_force(replace(pulled, drive=replace(pulled.drive, cylinder="piston")), vented) >= 500.0


def test_in_a_free_swing_no_friction_is_small() -> None:
    run = motion_runs.balance(np.zeros(TIME.size))
    free = replace(run, external=np.zeros(TIME.size), external_recorded=False)
    assert full_force(free, motion_runs.plant()) == 0.0
