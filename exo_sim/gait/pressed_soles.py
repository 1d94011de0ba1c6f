"""A reference whose soles sink into the ground as far as their load asks, for a wearer who is a body with contacts.

On a rigid ground the soles of a reference lie at height zero whatever they carry. Where ground and sole give like springs, a foot at that
height carries nothing. So each foot is moved by millimetres to where its springs give the force that is expected, and the pelvis is lowered
by one height for the whole cycle. A leg that is nearly straight gets a millimetre shorter only where its knee bends by degrees, while a
foot that stands on its ball can turn about it: heights of the soles are weighed against changes of the joints by least squares.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import SAMPLES, Motion, travelling
from exo_sim.machine import sole_contact
from exo_sim.machine.ground_reaction import TOES
from exo_sim.machine.leg_angles import turned
from exo_sim.machine.person import LEG_START, Person, leg_points
from exo_sim.machine.sole_contact import RADIUS

Array = NDArray[np.float64]

#: Harmonics of a stride by which joints are moved.
_HARMONICS = 12
#: A foot counts as wholly down from this load on [N]: more leaves it in the air when it should carry, so that the leg behind carries too
#: long and the ball comes down at once with all of it (the first peak of the force was 1.25 of the weight with 100, 1.21 with 50, before
#: soles and joints were softer); with 25 the force rises with a bump. Heel and ball share the load up to this height [m].
_DOWN, _SHARING = 50.0, 0.012
#: How far a sole may be off where it carries, how far in the air and along the ground [m], and by how much a joint may be moved [rad]: each
#: weighs the same. The first is a small part of the 7 to 9 mm that the sole gives; with 1 mm for the second the treadmill's hip is 0.193
#: N m/kg off (0.172 with 1.7 mm), with 2 mm a foot that swings comes 3.5 mm off its way.
_CARRIES, _ASIDE, _TURNED = 0.5e-3, 1.7e-3, np.radians(1.0)
#: Knees are bent by so much at the least, or as they were [rad]; steps of Gauss and Newton.
_BENT, _STEPS = np.radians(2.0), 6


class _Step(NamedTuple):
    """Rows of least squares, shape (n, 6), and joint angles that are best for a pelvis of a given height, shape (n, 3); both by height."""

    left: Array
    left_by_height: Array
    angles: Array
    angles_by_height: Array


def pressed(motion: Motion, person: Person, force: Array, centre: Array) -> Motion:
    """Return the reference with its soles pressed into the ground.

    Args:
        motion: On a rigid ground, n samples.
        person: Who walks.
        force: Of the ground on left and right foot, x and z [N], shape (n, 2, 2).
        centre: Of pressure, ahead of each ankle [m], shape (n, 2).
    """
    given, lowered = motion.position, 0.0
    drop = RADIUS - person.ankle_height
    legs = [slice(first, first + 3) for first in LEG_START.values()]
    moved = [given[:, leg].copy() for leg in legs]
    wanted = []
    for foot, leg in enumerate(legs):
        place, _ = _soles(given, given[:, leg], person, drop)
        above = place[:, :, 1] - RADIUS
        load = _shared(force[:, foot, 1], centre[:, foot], above, person)
        down = np.clip(load / _DOWN, 0.0, 1.0)
        down *= down * (3.0 - 2.0 * down)
        tilt = down[:, 0] * (given[:, 2] + given[:, leg].sum(axis=1) - motion.ground.angle)
        deep = np.stack([sole_contact.heel_depth(load[:, 0], tilt, person.scale), sole_contact.depth_under(load[:, 1])], axis=1)
        height = RADIUS - deep + np.maximum(above, 0.0) * (1.0 - down)
        wanted.append((height, place[:, :, 0].mean(axis=1), _ASIDE * (_CARRIES / _ASIDE) ** down))
    for _ in range(_STEPS):
        steps = [_step(given, lowered, one, given[:, leg], to, person, drop) for one, leg, to in zip(moved, legs, wanted)]
        by_height = sum(float((one.left_by_height**2).sum()) for one in steps)
        further = -sum(float((one.left * one.left_by_height).sum()) for one in steps) / by_height
        lowered += further
        for angles, leg, one in zip(moved, legs, steps):
            angles += one.angles + further * one.angles_by_height
            angles[:, 1] = np.minimum(angles[:, 1], np.maximum(given[:, leg][:, 1], -_BENT))
    position = given.copy()
    position[:, 1] -= lowered
    for angles, leg in zip(moved, legs):
        position[:, leg] += _smooth(angles - given[:, leg], _HARMONICS * max(1, len(given) // SAMPLES))
    return travelling(motion, position)


def _soles(given: Array, angles: Array, person: Person, drop: float) -> tuple[Array, Array]:
    """Return where heel and ball touch, shape (n, 2, 2), and how hip, knee and ankle move both, shape (n, 2, 2, 3)."""
    thigh, shank = given[:, 2] + angles[:, 0], given[:, 2] + angles[:, 0] + angles[:, 1]
    tilt = shank + angles[:, 2]
    points = leg_points(thigh, angles[:, 1], angles[:, 2], person)
    joints = np.stack([np.zeros_like(points["knee"]), points["knee"], points["ankle"]], axis=1)
    place = np.stack([points["ankle"] + turned(tilt, ahead, drop) for ahead in (person.heel, person.toe)], axis=1)
    arm = place[:, :, None] - joints[:, None]
    return place + given[:, None, :2], np.stack([-arm[..., 1], arm[..., 0]], axis=2)


def _step(
    given: Array, lowered: float, angles: Array, usual: Array, wanted: tuple[Array, Array, Array], person: Person, drop: float
) -> _Step:
    """Return the next step of a leg towards `wanted`: heights of heel and ball (n, 2), place along (n,), what heights may be off (n, 2)."""
    height, along, off = wanted
    place, moves = _soles(given, angles, person, drop)
    n = len(given)
    rows, slopes, by_height = np.empty((n, 6)), np.zeros((n, 6, 3)), np.zeros((n, 6))
    rows[:, :2], slopes[:, :2], by_height[:, :2] = (place[:, :, 1] - lowered - height) / off, moves[:, :, 1] / off[:, :, None], -1.0 / off
    rows[:, 2], slopes[:, 2] = (place[:, :, 0].mean(axis=1) - along) / _ASIDE, moves[:, :, 0].mean(axis=1) / _ASIDE
    rows[:, 3:], slopes[:, 3:] = (angles - usual) / _TURNED, np.eye(3) / _TURNED
    both = np.stack([rows, by_height], axis=2)
    best: Array = -np.linalg.solve(slopes.transpose(0, 2, 1) @ slopes, slopes.transpose(0, 2, 1) @ both).astype(np.float64)
    left = both + slopes @ best
    return _Step(left[:, :, 0], left[:, :, 1], best[:, :, 0], best[:, :, 1])


def _shared(force: Array, centre: Array, above: Array, person: Person) -> Array:
    """Return the load on heel and ball [N], shape (n, 2): by the centre of pressure where both are near the ground; toes have their own."""
    forward = np.clip((centre - person.heel) / (person.toe - person.heel), 0.0, 1.0)
    near = np.clip(1.0 - above / _SHARING, 0.0, 1.0)
    part = np.stack([1.0 - forward, forward], axis=1) * near + 1e-9
    part /= part.sum(axis=1, keepdims=True)
    part = np.where(near[:, ::-1] < 1e-6, 1.0, part) * near
    part[:, 1] *= 1.0 - np.clip((centre - person.toe) / (TOES * person.scale), 0.0, 1.0)
    return np.asarray(force[:, None] * part)


def _smooth(values: Array, harmonics: int) -> Array:
    spectrum = np.fft.rfft(values, axis=0)
    spectrum[harmonics + 1 :] = 0.0
    return np.fft.irfft(spectrum, len(values), axis=0)
