"""Walking at the pace and with the joint angles that were recorded."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait import recorded_gait
from exo_sim.gait.motion import Motion, derivatives, phases
from exo_sim.gait.recorded_gait import RecordedGait
from exo_sim.machine.ground_reaction import TOES
from exo_sim.machine.person import Person

Array = NDArray[np.float64]

#: How far the trunk leans forward over the recorded pelvis under a load on the back [rad].
LEAN = math.radians(8.0)
#: Phases between which heel and ball of the foot are on the ground.
HEEL_UNTIL, TOE_FROM = 0.36, 0.13
#: Where the centre of pressure is, ahead of the ankle along the sole of a body of the reference height [m], at every twentieth of stance:
#: the mean of both recordings, each 10 mm rms from it (weighed by the load). Of OpenSim's walk it follows from force plates and the pose of
#: the foot, of Falisse's from the ground's force and the ankle's moment.
_CENTRES = np.array([
    -0.059, -0.050, -0.031, -0.012, 0.006, 0.016, 0.028, 0.042, 0.060, 0.083, 0.102,
    0.116, 0.125, 0.130, 0.135, 0.140, 0.144, 0.152, 0.163, 0.179, 0.200,
])  # fmt: skip
#: Share of double support over which the load begins to pass and ends passing.
_EASED = 0.1


def walking(name: str, person: Person) -> Motion:
    """Return a recorded gait as a reference motion; see `walking_as`.

    Raises:
        ScenarioError: no gait of this name was recorded.
    """
    return walking_as(recorded_gait.load(name), person)


def walking_as(gait: RecordedGait, person: Person) -> Motion:
    """Return the figures of a gait as a reference motion; phase 0 is the heel strike of the right foot.

    Left and right are alike, half a stride apart. Lengths grow with body height; the stride time does not.
    """
    right = phases()
    left = (right + 0.5) % 1.0
    series = gait.motion
    pitch = series["tilt"](right) - LEAN
    columns = [
        series["pelvis_x"](right) * person.scale,
        series["pelvis_z"](right) * person.scale,
        pitch,
    ]
    for phase in (left, right):
        columns += [series["thigh"](phase) - pitch, series["knee"](phase), series["ankle"](phase)]
    position = np.stack(columns, axis=1)
    slope, curvature = derivatives(position)
    advance = gait.stride * person.scale
    slope[:, 0] += advance
    return Motion(
        period=gait.period,
        advance=advance,
        position=position,
        slope=slope,
        curvature=curvature,
        share=shares(left, right, gait.stance_end),
        pressure_centre=pressure_centres(left, right, gait.stance_end, person),
        contact=contacts(left, right, gait.stance_end),
        support=np.ones(len(right)),
    )


def loaded(phase: Array, stance_end: float) -> Array:
    """Return how far a foot is loaded at phases from its own heel strike, 0 to 1, the shape of `phase`.

    In double support the load passes evenly from foot to foot, but for its first and last tenth: of even, cubic and smoother courses this
    is nearest to both recordings (rms 0.027 of the load for Falisse, 0.017 for OpenSim; 0.031 and 0.018 without the tenths).
    """
    done, e = np.clip(np.minimum(phase, stance_end - phase) / (stance_end - 0.5), 0.0, 1.0), _EASED
    begins, ends = done**2 / (2.0 * e), 1.0 - e - (1.0 - done) ** 2 / (2.0 * e)
    return np.where(done < e, begins, np.where(done > 1.0 - e, ends, done - 0.5 * e)) / (1.0 - e)


def shares(left: Array, right: Array, stance_end: float) -> Array:
    """Return how much of the load each foot carries at phases from its own heel strike, shape (n, 2); rows sum to 1."""
    weight = [loaded(phase, stance_end) for phase in (left, right)]
    whole = weight[0] + weight[1]
    # where strides are uneven neither foot may be meant to carry for a moment: then both do
    even = whole < 1e-6
    return np.stack([np.where(even, 0.5, each / np.where(even, 1.0, whole)) for each in weight], axis=1)


def pressure_centres(left: Array, right: Array, stance_end: float, person: Person) -> Array:
    """Return where the centre of pressure of each foot is, ahead of the ankle along the sole [m], shape (n, 2)."""
    phase = np.stack([left, right], axis=1)
    course = np.clip(pressure_course(phase / stance_end) * person.scale, person.heel, person.toe + TOES * person.scale)
    return np.where(phase < stance_end, course, 0.5 * (person.heel + person.toe))


def pressure_course(stance: Array) -> Array:
    """Return where the centre of pressure is at shares of stance, 0 to 1, ahead of the ankle of the reference body [m], the same shape."""
    steps = len(_CENTRES) - 1
    at = np.clip(stance, 0.0, 1.0) * steps
    i = np.minimum(at.astype(int), steps - 1)
    u, slope = at - i, np.gradient(_CENTRES)
    from_here, from_next = _CENTRES[i] + u * slope[i], _CENTRES[i + 1] - (1.0 - u) * slope[i + 1]
    return np.asarray(from_here + u * u * (3.0 - 2.0 * u) * (from_next - from_here))


def contacts(left: Array, right: Array, stance_end: float) -> NDArray[np.bool_]:
    """Return whether heel_l, toe_l, heel_r, toe_r are meant to touch the ground, shape (n, 4)."""
    both = [column for phase in (left, right) for column in (phase < HEEL_UNTIL, (phase > TOE_FROM) & (phase < stance_end))]
    return np.stack(both, axis=1)
