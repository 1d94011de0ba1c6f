"""What was worked out for a machine and a motion is not worked out again, and another machine's is never taken for it."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
import pytest

from exo_sim.diagnosis.subsystems.motion import kept_dynamics
from exo_sim.diagnosis.subsystems.motion.kept_dynamics import MOST, KeptDynamics


def arm(mass: float) -> mujoco.MjModel:
    body = f"<body><joint type='hinge' axis='0 1 0'/><geom size='0.1' mass='{mass}' pos='0.3 0 0'/></body>"
    return mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{body}</worldbody></mujoco>")


def test_the_same_machine_and_motion_are_worked_out_once() -> None:
    asked: list[str] = []
    kept: KeptDynamics[int] = KeptDynamics()

    def found(mass: float, angles: np.ndarray) -> int:
        def work_out() -> int:
            asked.append(f"{mass} {angles}")
            return len(asked)

        return kept.of(arm(mass), (angles, 0.1), work_out)

    assert found(1.0, np.zeros(3)) == found(1.0, np.zeros(3)) == 1
    assert found(1.001, np.zeros(3)) == 2
    assert found(1.0, np.full(3, 1e-12)) == 3
    assert len(asked) == 3
    for mass in range(2, 2 + MOST):
        found(float(mass), np.zeros(3))
    assert found(1.0, np.zeros(3)) == 4 + MOST


@dataclass(frozen=True)
class Forces:
    """Results with an array of their own."""

    force: np.ndarray


def test_so_many_bytes_are_kept_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_dynamics, "MOST_BYTES", 1000)
    asked: list[float] = []
    kept: KeptDynamics[Forces] = KeptDynamics()

    def found(mass: float, count: int) -> None:
        def work_out() -> Forces:
            asked.append(mass)
            return Forces(np.zeros(count))

        kept.of(arm(mass), (), work_out)

    for mass, count in ((1.0, 50), (2.0, 50), (1.0, 50), (3.0, 100), (1.0, 50), (4.0, 500), (4.0, 500)):
        found(mass, count)
    assert asked == [1.0, 2.0, 3.0, 1.0, 4.0, 4.0]
