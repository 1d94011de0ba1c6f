"""Angles that count another way are turned to the machine's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from gait.walked_trial import walked

from exo_sim.errors import ScenarioError
from exo_sim.gait.angle_signs import counted_as_machine
from exo_sim.gait.walking_trial import JOINTS, Trial


def counted_as(joint: str, sign: float = 1.0, zero: float = 0.0) -> Trial:
    """Return the walk with one joint's angles counted another way."""
    trial = walked()
    return replace(trial, angles={k: sign * v + zero if k.startswith(joint) else v for k, v in trial.angles.items()})


def test_the_machine_s_own_way_is_left_alone() -> None:
    trial = counted_as_machine(walked())
    assert trial.remarks == () and all(np.array_equal(trial.angles[name], walked().angles[name]) for name in JOINTS)


@pytest.mark.parametrize(
    ("joint", "sign", "zero", "says"),
    [
        ("knee", -1.0, 0.0, "knee flexion is positive"), ("hip", -1.0, 0.0, "hip flexion is negative"),
        ("ankle", -1.0, 0.0, "dorsiflexion of the ankle is negative"), ("ankle", 1.0, np.pi / 2, "counted from a right angle"),
        ("knee", 1.0, np.pi, "180 degrees where it is straight"), ("knee", -1.0, np.pi, "180 degrees where it is straight"),
    ],
)  # fmt: skip
def test_each_other_way_is_turned_back_and_said(joint: str, sign: float, zero: float, says: str) -> None:
    trial = counted_as_machine(counted_as(joint, sign, zero))
    assert any(says in remark for remark in trial.remarks)
    for name in JOINTS:
        np.testing.assert_allclose(trial.angles[name], walked().angles[name], atol=1e-12)


@pytest.mark.parametrize(("factor", "says"), [(57.3, "which no leg does"), (0.01, "no angle moves by more than 3 degrees")])
def test_angles_of_no_leg_are_refused(factor: float, says: str) -> None:
    trial = walked()
    wrong = replace(trial, angles={name: factor * values for name, values in trial.angles.items()})
    with pytest.raises(ScenarioError, match=says):
        counted_as_machine(wrong)
