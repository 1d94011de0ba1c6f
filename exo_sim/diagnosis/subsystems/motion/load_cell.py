"""The balance of forces along a rod with a load cell: pressures less cell force are what the piston itself loses.

Of the MJCF nothing but the piston's motion enters: this balance holds for a leg that touches the ground or is moved by its wearer, too.
"""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.motion_run import Drive, Inertia, Kinematics, MotionRun, Passive
from exo_sim.diagnosis.policy.recordings import STILL_NOISE, STILL_SHARE
from exo_sim.diagnosis.subsystems.motion.forces_recorded import recorded
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothing_width, stride, thinned
from exo_sim.recording.filters import gaussian_smoothed, noise_gain, restored, smoothed_motion
from exo_sim.recording.noise import white_noise
from exo_sim.rig import Rig


def rod_run(run: CylinderRun, rig: Rig) -> MotionRun | None:
    """Return the balance along the rod of one cylinder, or None where pressures, load cell or position were not recorded.

    Of a long recording one of several samples is kept, as of a joint's balance.

    Args:
        run: What was recorded of the cylinder.
        rig: Whose cylinder it is.
    """
    c = rig.cylinders[run.cylinder]
    p_1, p_2 = run.pressure
    if run.force is None or run.length is None or p_1 is None or (p_2 is None and not c.single_acting):
        return None
    time, every = run.time, stride(run.time)
    step = float(np.median(np.diff(time)))
    seconds = smoothing_width(time)
    keep = noise_gain(0, seconds, step)
    atmosphere = rig.environment.pressure
    rod = smoothed_motion(time, run.length, seconds, run.position_noise)
    position, velocity = thinned(rod.position, every), thinned(rod.velocity, every)
    measured = thinned(gaussian_smoothed(time, run.force, seconds), every)
    n = len(measured)
    gauge, force, levers, signals = np.zeros((n, 2)), np.zeros(n), {}, {}
    variance = (white_noise(run.force) * keep) ** 2
    for side, (values, area) in enumerate(((p_1, c.area_1), (p_2, -c.area_2))):
        if values is None or (side == 1 and c.single_acting):
            continue
        smooth = gaussian_smoothed(time, values, seconds)
        gauge[:, side] = thinned(restored(time, smooth, seconds), every) - atmosphere
        smooth = thinned(smooth, every)
        force += area * (smooth - atmosphere)
        levers[f"{run.cylinder}.pressure_{side + 1}"] = np.full(n, area)
        signals[f"{run.cylinder}.pressure_{side + 1}"] = smooth - atmosphere
        variance += (area * white_noise(values) * keep) ** 2
    levers[f"{run.cylinder}.force"] = np.full(n, -1.0)
    signals[f"{run.cylinder}.force"] = measured
    nothing, known = np.zeros(n), recorded(time, (run.force, p_1, None if c.single_acting else p_2))
    still = max(STILL_NOISE * rod.velocity_noise, STILL_SHARE * float(np.nanstd(velocity)))
    return MotionRun(
        recording=run.recording,
        joint=run.cylinder,
        turning=False,
        time=thinned(time, every),
        breaks=tuple(dict.fromkeys(begin // every for begin in run.breaks)),
        kinematics=Kinematics(position, velocity, still, rod.velocity_noise),
        inertia=Inertia(measured, measured, nothing, effective_mass=0.0, has_mass=False),
        passive=Passive(nothing),
        drive=Drive(force, run.cylinder, np.ones(n), gauge, levers, signals),
        external=nothing,
        noise=float(np.sqrt(variance)),
        every=every,
        known=None if known.all() else known,
    )
