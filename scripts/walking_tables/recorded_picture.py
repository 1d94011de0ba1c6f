"""Vertical force of the ground and joint moments of the wearer alone, simulated both ways, over the recorded ones."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat

from exo_sim.gait import recorded_gait, scenario
from exo_sim.gait.motion import phases
from exo_sim.gait.moving_body import Moving, body_loads
from exo_sim.gait.residual_reduction import reduced
from exo_sim.machine import ground_reaction
from exo_sim.machine.person import Person
from exo_sim.simulation.wearer_alone import one_cycle

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"
HEADING = "The wearer alone over the recording, drawn"
TEXT = f"""## {HEADING}

![recorded](pictures/walking-recorded.png)

One stride of the right leg from heel strike, level walk at 1.2 m/s, without machine or load, divided by the body's mass. Grey: mean
recorded stride (Falisse; the force scaled so that it sums to the body weight). Blue: motion prescribed. Red: wearer moved by torques, on
his own soles. Largest force in the first fifth of the stride, over the body weight: @PEAKS@.

What waves are left in the moments, most in the leg that swings, are in the prescribed motion already: they come with the reference, whose
angles and pelvis path end at the eighth harmonic. They are the smaller part of what is missed at the hip:
@HIP@.
The larger part is a hip that holds more than was recorded in the first and last third of stance, where the reference's mass speeds up and
slows down less than the recorded force says.

"""


def vertical(of: NDArray[np.float64], phase: NDArray[np.float64]) -> str:
    """Return the largest vertical force in the first fifth of the stride, over body weight, and when."""
    early = of[phase < 0.2]
    return f"{early.max():.2f} at {100 * phase[int(np.argmax(early))]:.0f} % of the stride"


def section(folder: Path) -> str:
    """Draw, and return the section; without the recordings there is nothing to draw over, and an empty text."""
    path = SHARED / "walking_falisse" / "ExperimentalData.mat"
    if not path.exists():
        return ""
    gait = recorded_gait.load("falisse")
    person = Person(1.70, gait.mass)
    motion = reduced(scenario.motion("level_walk", person, 1.0), person)
    poses, wrench = body_loads(Moving.of(motion), person)
    ground = ground_reaction.hold(poses, wrench, motion.share, motion.pressure_centre, motion.support, person)
    moments = ground_reaction.joint_moments(poses, wrench, ground.force, ground.place)
    moved = one_cycle(motion, person)
    weight, phase = 9.81 * gait.mass, phases()
    data = loadmat(path, squeeze_me=True, struct_as_record=False)["ExperimentalData"]
    measured = data.GRFs.subject1.mean[:, 1] / data.GRFs.subject1.mean[:, 1].mean() * 0.5
    figure, axes = plt.subplots(2, 2, figsize=(10, 6), sharex=True, constrained_layout=True)
    drawn = {"prescribed": ("#2460a7", ground.force, moments), "moved by torques": ("#c0392b", moved.ground.force, moved.moments)}
    force, *joints = axes.flat
    force.plot(np.arange(100), measured, color="#9aa0a8", lw=3, label="recorded")
    for axis, joint in zip(joints, ("hip", "knee", "ankle")):
        axis.plot(100 * phase, gait.moment[joint](phase) / gait.mass, color="#9aa0a8", lw=3)
        axis.set(title=f"{joint} moment, N m/kg")
    for name, (colour, forces, found) in drawn.items():
        force.plot(100 * phase, forces[:, 1, 1] / weight, color=colour, label=name)
        for k, axis in enumerate(joints):
            axis.plot(100 * phase, found[:, 3 + k] / gait.mass, color=colour)
    force.set(title="vertical force of the ground, body weights")
    force.legend(frameon=False)
    for axis in axes[1]:
        axis.set(xlabel="stride, %")
    figure.savefig(folder / "walking-recorded.png", dpi=120, metadata={"Software": None})
    plt.close(figure)
    recorded = np.interp(phase, np.arange(100) / 100, measured, period=1.0)
    said = "; ".join(
        f"{name} {vertical(one, phase)}"
        for name, one in (("recorded", recorded), *((name, forces[:, 1, 1] / weight) for name, (_, forces, _) in drawn.items()))
    )
    off = (moments[:, 3] - gait.moment["hip"](phase)) / gait.mass
    slow = np.fft.rfft(off)
    slow[6:] = 0.0
    whole, rest = (float(np.sqrt(np.mean(one**2))) for one in (off, np.fft.irfft(slow, len(off))))
    hip = f"of {whole:.2f} N m/kg rms, motion prescribed, {rest:.2f} are left without harmonics above the fifth"
    return TEXT.replace("@HIP@", hip).replace("@PEAKS@", said)
