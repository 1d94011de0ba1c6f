"""Where the ground holds the wearer: forces under both soles, with the centre of pressure inside the parts that touch.

The ground can push, not pull, it rubs, and it gives no free moment. In single support force and centre of pressure follow from the
balance of the whole body. In double support the load passes from foot to foot along the share of the gait, and both forces aim
at one point above the hips (virtual pivot point: Maus, Lipfert, Gross, Rummel, Seyfarth 2010, Nature Communications 1:70); what moment is
left over moves the centres of pressure, then the load between the feet. What no sole can give is the residual, a wrench at the pelvis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.person import SEGMENTS, Person

#: How far sole and ground give, so that a tilted foot touches with more than an edge [m].
_GIVES = 0.003
#: Toes ahead of the ball of the foot, for a body of the reference height [m]; they bend, and stay on the ground with the ball.
TOES = 0.055
#: Where the forces of both feet meet: above the hips [m].
_PIVOT = 0.25
_FRICTION = 0.9
#: Levers between the feet below this cannot carry a moment [m].
_SHORT = 0.05
_ROUNDS = 4
#: A moment smaller than this is no reason to say that a centre of pressure is outside [N m].
_FELT = 1.0
FEET = (SEGMENTS.index("foot_l"), SEGMENTS.index("foot_r"))


@dataclass(frozen=True)
class Ground:
    """What holds the wearer.

    Attributes:
        force: Of the ground on left and right foot, x and z [N], shape (n, 2, 2).
        centre: Of pressure of each foot along its sole, ahead of the ankle [m], shape (n, 2).
        place: The same in space, from the pelvis, x and z [m], shape (n, 2, 2).
        seat: Wrench of a seat at the pelvis: x, z [N], about -y [N m], shape (n, 3).
        residual: What is left for the pelvis to be held with: x, z [N], about -y [N m], shape (n, 3).
        outside: Whether the centre of pressure would have to leave the soles that touch, shape (n,).
    """

    force: NDArray[np.float64]
    centre: NDArray[np.float64]
    place: NDArray[np.float64]
    seat: NDArray[np.float64]
    residual: NDArray[np.float64]
    outside: NDArray[np.bool_]


def soles(angle: NDArray[np.float64], person: Person) -> NDArray[np.float64]:
    """Return rear and front end of the part of each sole that touches when the foot is down [m ahead of the ankle].

    Args:
        angle: Of the feet to the ground [rad], toes up positive, shape (n, 2).
        person: Whose feet.

    Returns:
        Shape (n, 2, 2).
    """
    tip = person.toe + TOES * person.scale
    give = _GIVES * person.scale / np.maximum(np.tan(np.abs(angle)), 1e-3)
    rear = np.where(angle < 0.0, np.maximum(person.toe - give, person.heel), person.heel)
    front = np.where(angle > 0.0, np.minimum(person.heel + give, tip), tip)
    return np.stack([rear, front], axis=-1)


def totals(poses: NDArray[np.float64], wrench: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum loads on all segments about the pelvis.

    Args:
        poses: Shape (n, 7, 6).
        wrench: Force x, z [N] and moment about -y [N m] on each segment about its upper joint, shape (n, 7, 3).

    Returns:
        Shape (n, 3).
    """
    arm = poses[:, :, :2] - poses[:, :1, :2]
    moment = wrench[:, :, 2] + arm[:, :, 0] * wrench[:, :, 1] - arm[:, :, 1] * wrench[:, :, 0]
    return np.stack([wrench[:, :, 0].sum(axis=1), wrench[:, :, 1].sum(axis=1), moment.sum(axis=1)], axis=1)


@dataclass(frozen=True)
class _Feet:
    """Ankles from the pelvis, shape (n, 2, 2), and cosine and sine of the feet's angles in space, shape (n, 2): of points of the soles."""

    ankle: NDArray[np.float64]
    cosine: NDArray[np.float64]
    sine: NDArray[np.float64]

    @classmethod
    def of(cls, poses: NDArray[np.float64]) -> _Feet:
        angle = poses[:, FEET, 2]
        return cls(poses[:, FEET, :2] - poses[:, :1, :2], np.cos(angle), np.sin(angle))

    def sole(self, ahead: NDArray[np.float64], ankle_height: float) -> NDArray[np.float64]:
        """Return points of the soles, as `under_foot`."""
        along, down = ahead * self.cosine + ankle_height * self.sine, ahead * self.sine - ankle_height * self.cosine
        return self.ankle + np.stack([along, down], axis=-1)


def under_foot(
    poses: NDArray[np.float64], ahead: NDArray[np.float64], ankle_height: float
) -> NDArray[np.float64]:
    """Return points of the soles from the pelvis, x and z [m], shape (n, 2, 2), for places ahead of the ankles, shape (n, 2)."""
    return _Feet.of(poses).sole(ahead, ankle_height)


def _of_both(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what is left and right together, shape (n,) of (n, 2): a sum over rows that numpy takes ten times as long for."""
    return np.asarray(values[:, 0] + values[:, 1])


def hold(
    poses: NDArray[np.float64],
    wrench: NDArray[np.float64],
    share: NDArray[np.float64],
    pressure_centre: NDArray[np.float64],
    support: NDArray[np.float64],
    person: Person,
    slope: float = 0.0,
) -> Ground:
    """Hold a body against all loads on its segments, its own weight and inertia among them.

    Args:
        poses: The person's segments, shape (n, 7, 6).
        wrench: Loads on each, shape (n, 7, 3).
        share: Of left and right foot in carrying, shape (n, 2).
        pressure_centre: Where under each foot the load is where nothing else decides, ahead of the ankle [m], shape (n, 2).
        support: How far the feet carry and not a seat, shape (n,).
        person: Whose feet.
        slope: Angle of a sole that lies on the ground [rad].
    """
    load = totals(poses, wrench)
    seat = -load * (1.0 - support)[:, None]
    need = -load - seat
    residual = np.zeros_like(need)
    up = np.maximum(need[:, 1], 0.0)
    residual[:, 1] = need[:, 1] - up
    along = np.clip(need[:, 0], -_FRICTION * up, _FRICTION * up)
    residual[:, 0] = need[:, 0] - along

    bounds = soles(poses[:, FEET, 2] - slope, person)
    nominal = np.clip(pressure_centre, bounds[:, :, 0], bounds[:, :, 1])
    feet = _Feet.of(poses)
    place = feet.sole(nominal, person.ankle_height)
    vertical = share * up[:, None]
    horizontal = _aimed(along, vertical, share, place)
    left = need[:, 2] - _moment(place, horizontal, vertical)

    # first the centres of pressure move within the soles; what a tilted sole makes of it is met by going on from there
    centre = nominal
    for _ in range(_ROUNDS):
        end = np.where(left[:, None] > 0.0, bounds[:, :, 1], bounds[:, :, 0])
        room = vertical * np.abs(end - centre) * feet.cosine
        part = np.clip(np.abs(left) / np.maximum(_of_both(room), 1e-9), 0.0, 1.0)
        centre = centre + part[:, None] * (end - centre)
        place = feet.sole(centre, person.ankle_height)
        horizontal = _aimed(along, vertical, share, place)
        left = need[:, 2] - _moment(place, horizontal, vertical)

    # then load moves from foot to foot, as far as both are down
    lever = place[:, 1, 0] - place[:, 0, 0]
    both = np.minimum(1.0, 4.0 * share[:, 0] * share[:, 1])
    wanted = left * lever / (lever**2 + _SHORT**2)
    moved = np.clip(wanted, -both * vertical[:, 1], both * vertical[:, 0])
    vertical = np.stack([vertical[:, 0] - moved, vertical[:, 1] + moved], axis=1)
    horizontal = _aimed(along, vertical, share, place)
    residual[:, 2] = need[:, 2] - _moment(place, horizontal, vertical)
    return Ground(
        force=np.stack([horizontal, vertical], axis=-1),
        centre=centre,
        place=place,
        seat=seat,
        residual=residual,
        outside=np.abs(residual[:, 2]) > _FELT,
    )


def off_balance(
    poses: NDArray[np.float64],
    load: NDArray[np.float64],
    share: NDArray[np.float64],
    pressure_centre: NDArray[np.float64],
    person: Person,
    slope: float = 0.0,
) -> NDArray[np.float64]:
    """Return what is amiss where the centres of pressure are as expected.

    Args:
        poses, share, pressure_centre, person, slope: As in `hold`.
        load: `totals`, shape (n, 3).

    Returns:
        The moment that is left [N m], and how far the horizontal force is from aiming at the pivot [N], shape (n, 2).
    """
    bounds = soles(poses[:, FEET, 2] - slope, person)
    place = under_foot(poses, np.clip(pressure_centre, bounds[:, :, 0], bounds[:, :, 1]), person.ankle_height)
    vertical = -share * load[:, 1:2]
    horizontal = _aimed(-load[:, 0], vertical, share, place)
    aim = _of_both(vertical * -place[:, :, 0] / (_PIVOT - place[:, :, 1]))
    return np.stack([-load[:, 2] - _moment(place, horizontal, vertical), -load[:, 0] - aim], axis=1)


def linear_ground(
    poses: NDArray[np.float64],
    load: NDArray[np.float64],
    share: NDArray[np.float64],
    pressure_centre: NDArray[np.float64],
    ankle_height: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the ground's answer to a small load beside a large one: centres of pressure move, and are nowhere near an edge.

    Args:
        poses, share, pressure_centre: As in `hold`.
        load: `totals`, shape (n, 3).
        ankle_height: Ankle above the sole [m].

    Returns:
        Force on each foot, shape (n, 2, 2); its place, (n, 2, 2); and what moving centres of pressure add, about -y [N m], (n, 2).
    """
    place = under_foot(poses, pressure_centre, ankle_height)
    vertical = -share * load[:, 1:2]
    middle = _of_both(share * place[:, :, 0])
    height = _PIVOT - _of_both(share * place[:, :, 1])
    horizontal = -share * load[:, :1] + vertical * (middle[:, None] - place[:, :, 0]) / height[:, None]
    left = -load[:, 2] - _moment(place, horizontal, vertical)
    return np.stack([horizontal, vertical], axis=-1), place, share * left[:, None]


def _aimed(
    along: NDArray[np.float64], vertical: NDArray[np.float64], share: NDArray[np.float64], place: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the horizontal forces of both feet, shape (n, 2): each its share, and what aims it at the pivot."""
    total = np.maximum(_of_both(vertical), 1e-9)
    middle = _of_both(vertical * place[:, :, 0]) / total
    height = _PIVOT - _of_both(share * place[:, :, 1])
    aim = vertical * (middle[:, None] - place[:, :, 0]) / height[:, None]
    return np.asarray(along[:, None] * vertical / total[:, None] + aim)


def _moment(
    place: NDArray[np.float64], horizontal: NDArray[np.float64], vertical: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the moment about the pelvis of forces under the feet, shape (n,)."""
    return _of_both(place[:, :, 0] * vertical - place[:, :, 1] * horizontal)


def joint_moments(
    poses: NDArray[np.float64],
    wrench: NDArray[np.float64],
    force: NDArray[np.float64],
    place: NDArray[np.float64],
    turning: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Return what hip, knee and ankle must give, from the ground upward.

    Args:
        poses: The person's segments, shape (n, 7, 6).
        wrench: Loads on each about its upper joint, shape (n, 7, 3).
        force: Of the ground on each foot, x and z [N], shape (n, 2, 2).
        place: Where it acts, from the pelvis [m], shape (n, 2, 2).
        turning: Moment about -y on each foot beside [N m], shape (n, 2).

    Returns:
        hip, knee, ankle of the left, then of the right leg [N m]; flexion, extension, dorsiflexion positive, shape
        (n, 6).
    """
    arm = poses[:, :, :2] - poses[:, :1, :2]
    moment = wrench[:, :, 2] + arm[:, :, 0] * wrench[:, :, 1] - arm[:, :, 1] * wrench[:, :, 0]
    out = np.empty((len(poses), 6))
    for leg in range(2):
        push = force[:, leg].copy()
        about = place[:, leg, 0] * push[:, 1] - place[:, leg, 1] * push[:, 0]
        if turning is not None:
            about = about + turning[:, leg]
        for k in (2, 1, 0):
            row = 1 + 3 * leg + k
            push += wrench[:, row, :2]
            about = about + moment[:, row]
            joint = arm[:, row]
            out[:, 3 * leg + k] = -(about - joint[:, 0] * push[:, 1] + joint[:, 1] * push[:, 0])
    return out
