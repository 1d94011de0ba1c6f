"""The rod cut: where a load cell sits on the rod, pressures and cell leave what the piston itself loses, whoever moved the machine.

Nothing of the MJCF enters but the piston's motion: a leg that touches the ground or is led by its wearer can be asked just as well.
"""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.filters import left_of_noise, moved, quieted, restored, white_noise
from exo_sim.diagnosis.motion_cut import MotionRun, smoothing
from exo_sim.diagnosis.observed import CylinderRun
from exo_sim.rig import Rig


def rod_run(run: CylinderRun, rig: Rig) -> MotionRun | None:
    """Return the balance of pressures and load cell along the rod of one cylinder, or None where one of them was not recorded.

    Args:
        run: What was recorded of the cylinder.
        rig: Whose cylinder it is.
    """
    c = rig.cylinders[run.cylinder]
    p_1, p_2 = run.pressure
    if run.force is None or run.length is None or p_1 is None or (p_2 is None and not c.single_acting):
        return None
    time, n = run.time, len(run.time)
    step = float(np.median(np.diff(time)))
    seconds = smoothing(time)
    keep = left_of_noise(0, seconds, step)
    atmosphere = rig.environment.pressure
    rod = moved(time, run.length, seconds, run.jitter)
    measured = quieted(time, run.force, seconds)
    gauge, drive, levers = np.zeros((n, 2)), np.zeros(n), {}
    variance = (white_noise(run.force) * keep) ** 2
    for side, (values, area) in enumerate(((p_1, c.area_1), (p_2, -c.area_2))):
        if values is None or (side == 1 and c.single_acting):
            continue
        smooth = quieted(time, values, seconds)
        drive += area * (smooth - atmosphere)
        gauge[:, side] = restored(time, smooth, seconds) - atmosphere
        levers[f"{run.cylinder}.pressure_{side + 1}"] = np.full(n, area)
        variance += (area * white_noise(values) * keep) ** 2
    levers[f"{run.cylinder}.force"] = np.full(n, -1.0)
    nothing = np.zeros(n)
    return MotionRun(
        run.recording, run.cylinder, run.cylinder, False, time, rod.position, rod.velocity, measured, measured, nothing, nothing,
        drive, nothing, np.ones(n), gauge, levers, float(np.sqrt(variance)),
        max(4.0 * rod.shake, 0.01 * float(np.nanstd(rod.velocity))), run.breaks, 0.0, False, weighs=False,
    )  # fmt: skip
