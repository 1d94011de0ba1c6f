"""Whether a recording is of the machine at all."""

from __future__ import annotations

import mujoco

from exo_sim.errors import nearest
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig


def of_another_machine(recording: Recording, rig: Rig, model: mujoco.MjModel) -> str:
    """Return why a recording is of another machine than the rig, in words that name a part of each; "" where it is of this one."""
    known = {*rig.cylinders, *(model.joint(j).name for j in range(model.njnt))}
    if not any(part in known for part in recording.parts()):
        others = [part for part in recording.parts() if part not in ("supply", "exhaust", "gait")]
        asked = others[0] if others else "any part"
        return f'no column belongs to {rig.path}: "{asked}" is none of its parts{nearest(asked, known)}'
    silent = [name for name in rig.cylinders if name not in recording.parts()]
    if rig.cylinders and len(silent) == len(rig.cylinders) and not any(k.endswith(".position") for k in recording.columns):
        return f"never mentions a cylinder of {rig.path} ({', '.join(silent)}): is it another machine's?"
    return ""
