"""The rod cut: where a load cell sits on the rod, pressures and cell leave what the piston itself loses, whoever moved the machine.

Nothing of the MJCF enters but the piston's motion: a leg that touches the ground or is led by its wearer can be asked just as well.
"""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.motion_cut import MotionRun, smoothing
from exo_sim.diagnosis.observed import CylinderRun, led, left_of_noise, white_noise
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
    position, velocity, _ = led(time, run.length, seconds)
    measured = led(time, run.force, seconds)[0]
    gauge, levers = np.zeros((n, 2)), {}
    variance = (white_noise(run.force) * keep) ** 2
    for side, (values, area) in enumerate(((p_1, c.area_1), (p_2, -c.area_2))):
        if values is None or (side == 1 and c.single_acting):
            continue
        gauge[:, side] = led(time, values, seconds)[0] - atmosphere
        levers[f"{run.cylinder}.pressure_{side + 1}"] = np.full(n, area)
        variance += (area * white_noise(values) * keep) ** 2
    levers[f"{run.cylinder}.force"] = np.full(n, -1.0)
    shake = white_noise(run.length) * left_of_noise(1, seconds, step)
    nothing = np.zeros(n)
    return MotionRun(
        run.recording, run.cylinder, run.cylinder, False, time, position, velocity, measured, measured, nothing, nothing,
        gauge[:, 0] * c.area_1 - gauge[:, 1] * c.area_2, nothing, np.ones(n), gauge, levers, float(np.sqrt(variance)),
        max(4.0 * shake, 0.01 * float(np.nanstd(velocity))), run.breaks, 0.0, False, weighs=False,
    )  # fmt: skip
