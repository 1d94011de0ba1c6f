"""How far the joints must go: through their whole range, or through what the tasks ask for.

A chamber is bought full with every cycle, also the part of it that the task never uses. Strokes for the tasks alone save most of the gas,
and the wearer cannot sit with them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import JointFactors, Rig
from exo_sim.sizing.loads import JointLoads

#: What the joints may be asked for.
TRAVELS = ("joint", "task")
#: Beyond what the tasks ask of a joint, each way [rad]: 10 degrees.
BEYOND = float(np.radians(10.0))


def within_tasks(rig: Rig, loads: tuple[JointLoads, ...]) -> Rig:
    """Return the rig with stops on the joints that its cylinders drive, `BEYOND` outside what the loads' motions ask of either side.

    Args:
        rig: The owner's machine.
        loads: Of every condition.
    """
    model = load(rig)
    factors = dict(rig.joint_factors)
    for joint in {link.joint for link in linkages(rig, model)}:
        stem = joint[:-2] if joint.endswith(("_l", "_r")) else joint
        angles = np.concatenate([one.column(f"{stem}{side}")[0] for one in loads for side in ("_l", "_r")])
        low, high = model.jnt_range[model.joint(joint).id]
        stops = max(float(angles.min()) - BEYOND, float(low)), min(float(angles.max()) + BEYOND, float(high))
        factors[joint] = replace(factors.get(joint, JointFactors()), range=stops)
    return replace(rig, joint_factors=factors)
