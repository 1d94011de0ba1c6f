"""A reference whose soles sink into the ground as far as their load asks, for a wearer who is a body with contacts.

On a rigid ground the soles of a reference lie at height zero whatever they carry. Where ground and sole give like springs, a foot at that
height carries nothing. So each foot is moved by millimetres to where its springs give the force that is expected, hip, knee and ankle
follow, and the pelvis is lowered by what the feet sink on the mean, so that the knees keep their angles.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import Motion, travelling
from exo_sim.machine.leg_angles import leg_to, turned
from exo_sim.machine.person import LEG_START, Person, leg_points

Array = NDArray[np.float64]

#: Harmonics of the stride by which joints are moved.
_HARMONICS = 12
#: A foot counts as wholly down from this load on [N]: with less, a heel that comes down is pulled to the ground in a jerk. Heel and ball
#: share the load up to this height [m].
_DOWN, _SHARING = 250.0, 0.012
#: Share of the mean sinking by which the pelvis is lowered: the rest goes to the knees, which then never have to stretch.
_LOWERED = 0.8


def pressed(motion: Motion, person: Person, force: Array, centre: Array, stiffness: float, radius: float, toes: float) -> Motion:
    """Return the reference with its soles pressed into the ground.

    Args:
        motion: On a rigid ground, n samples.
        person: Who walks.
        force: Of the ground on left and right foot, x and z [N], shape (n, 2, 2).
        centre: Of pressure, ahead of each ankle [m], shape (n, 2).
        stiffness: Of the ground under a heel or a ball of the foot [N/m].
        radius: Of what touches there [m].
        toes: Length ahead of the ball [m].
    """
    position = motion.position.copy()
    position[:, 1] -= _LOWERED * force[:, :, 1].sum(axis=1).mean() / stiffness
    drop = np.array([0.0, radius - person.ankle_height])  # from the ankle to what touches
    middle, span = 0.5 * (person.heel + person.toe), person.toe - person.heel
    for foot, first in enumerate(LEG_START.values()):
        leg = slice(first, first + 3)
        thigh, knee, ankle = motion.position[:, 2] + position[:, first], position[:, first + 1], position[:, first + 2]
        tilt = thigh + knee + ankle
        place = leg_points(thigh, knee, ankle, person)["ankle"] + motion.position[:, :2]
        heel, ball = (place + turned(tilt, ahead, drop[1]) for ahead in (person.heel, person.toe))
        above = np.stack([heel[:, 1], ball[:, 1]], axis=1) - radius
        load = _shared(force[:, foot, 1], centre[:, foot], above, person, toes)
        down = np.clip(load / _DOWN, 0.0, 1.0)
        down *= down * (3.0 - 2.0 * down)
        height = radius - load / stiffness + np.maximum(above, 0.0) * (1.0 - down)
        tilt = np.arcsin(np.clip((height[:, 1] - height[:, 0]) / span, -1.0, 1.0))
        low = np.stack([0.5 * (heel[:, 0] + ball[:, 0]), height.mean(axis=1)], axis=1)
        wanted = leg_to(low - turned(tilt, middle, drop[1]) - position[:, :2], tilt, position[:, 2], person)
        position[:, leg] += _smooth(wanted - position[:, leg], _HARMONICS * motion.strides)
    return travelling(motion, position)


def _shared(force: Array, centre: Array, above: Array, person: Person, toes: float) -> Array:
    """Return the load on heel and ball [N], shape (n, 2): by the centre of pressure where both are near the ground; toes have their own."""
    forward = np.clip((centre - person.heel) / (person.toe - person.heel), 0.0, 1.0)
    near = np.clip(1.0 - above / _SHARING, 0.0, 1.0)
    part = np.stack([1.0 - forward, forward], axis=1) * near + 1e-9
    part /= part.sum(axis=1, keepdims=True)
    part = np.where(near[:, ::-1] < 1e-6, 1.0, part) * near
    part[:, 1] *= 1.0 - np.clip((centre - person.toe) / toes, 0.0, 1.0)
    return np.asarray(force[:, None] * part)


def _smooth(values: Array, harmonics: int) -> Array:
    spectrum = np.fft.rfft(values, axis=0)
    spectrum[harmonics + 1 :] = 0.0
    return np.fft.irfft(spectrum, len(values), axis=0)
