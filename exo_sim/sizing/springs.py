"""The spring beside a rod with which a design draws the least gas."""

from __future__ import annotations

import numpy as np

from exo_sim.control.pressure_plan import INTERVALS, plan
from exo_sim.rig import Rig, assembly
from exo_sim.sizing.design import Design, fit, fitted
from exo_sim.sizing.joint_kinds import JointKind
from exo_sim.sizing.length_and_arm import length_and_arm
from exo_sim.sizing.loads import JointLoads

#: What a workshop can tell apart: stiffness [N/m] and rest [m].
_PLACES = 10.0, 1e-4


def beside(rig: Rig, kinds: tuple[JointKind, ...], loads: JointLoads, design: Design) -> dict[str, tuple[float, float]]:
    """Return stiffness [N/m] and rest [m from X = 0] by kind of joint, for those that are better off with a spring.

    Args:
        rig: The owner's machine; its valves have independent edges.
        kinds: Joints that are sized.
        loads: Of the condition for which the springs are chosen.
        design: Without springs; one whose stroke is not to be had gets none.
    """
    if any(fit(kind, design.joints[kind.name]).stroke is None for kind in kinds):
        return {}
    chosen = fitted(rig, kinds, design)
    records, world = assembly.cylinders(chosen), assembly.world(chosen)[0]
    out = {}
    at = np.arange(INTERVALS) / INTERVALS * len(loads.angle)
    for kind in kinds:
        name = kind.cylinders[0]
        angle, _, torque = (np.interp(at, np.arange(len(loads.angle)), each) for each in loads.column(kind.joints[0]))
        length, arm = length_and_arm(design.joints[kind.name].attachment, kind.across, angle)
        record = records[list(chosen.cylinders).index(name)]
        found = plan(world, record, length - chosen.cylinders[name].retracted_length, torque / arm, loads.period, spring=True)
        if found.spring is not None:
            stiffness, rest = (float(np.round(value / place)) * place for value, place in zip(found.spring, _PLACES))
            out[kind.name] = (stiffness, rest)
    return out
