"""Stairs, one foot a tread: drawn, not recorded.

Each foot is put on the tread above (below) that of the other, forefoot first going down, flat going up, stands, and rolls over its ball
until it leaves, after 62 % of the cycle, as on level ground. That timing does not depend on the inclination, and that the forefoot comes
first, is from Riener, Rabuffetti and Frigo (2002, "Stair ascent and descent at different inclinations", Gait & Posture 15:32-44). The
pelvis sways ahead and back as the mass of a linear inverted pendulum does above the feet that carry it (Kajita and
others 2001, "The 3D linear inverted pendulum mode", IROS:239-246), as high as the legs reach.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.footpaths import Paths, walked, within_reach
from exo_sim.gait.motion import SAMPLES, Motion, phases, smooth
from exo_sim.gait.pendulum import above
from exo_sim.gait.walking import LEAN, shares
from exo_sim.machine.ground import Ground
from exo_sim.machine.person import Person

Array = NDArray[np.float64]

#: When a foot leaves its tread.
_LEAVES = 0.62
#: How far the ball of a foot is from the edge of its tread: going up from the one behind it, going down from the one ahead [m].
_FROM_EDGE = 0.21, 0.02
#: Phases: the heel rises from its tread, is highest above the toes, is back in the air; a heel that was not put down first is down.
_RISES, _HIGHEST, _BACK, _DOWN = 0.38, 0.68, 0.95, 0.12
#: By how much a foot is lifted more than treads ask, going up and going down [m].
_CLEARS = 0.06, 0.03
#: Legs are stretched to this share of their length at the most, and the pelvis bobs so much about its even climb [m].
_STRETCHED, _BOB = 0.985, 0.012


@dataclass(frozen=True)
class Stairs:
    """How stairs are walked.

    Attributes:
        rise: Of a tread over the one before [m]; below zero they are walked down.
        tread: Its depth [m].
        period: Of a cycle of two treads [s].
        heel_off: How far the heel is above the toes after a foot has left [rad].
        lands: The same as it is put down [rad].
    """

    rise: float
    tread: float
    period: float
    heel_off: float
    lands: float


UP = Stairs(rise=0.17, tread=0.29, period=1.4, heel_off=math.radians(45.0), lands=0.0)
DOWN = Stairs(rise=-0.17, tread=0.29, period=1.2, heel_off=math.radians(35.0), lands=math.radians(25.0))


def walking_stairs(stairs: Stairs, person: Person) -> Motion:
    """Return two treads a cycle; phase 0 is when the right foot is put down.

    Raises:
        ScenarioError: stairs that nobody climbs.
    """
    ground = Ground(stairs.rise / stairs.tread, stairs.tread, _edge(stairs, person))
    right = phases()
    left = (right + 0.5) % 1.0
    phase = np.stack([left, right], axis=1)
    begun = np.stack([np.where(right < 0.5, -1.0, 1.0), np.zeros(SAMPLES)], axis=1)  # tread of each foot as its stance begins
    air = np.clip((phase - _LEAVES) / (1.0 - _LEAVES), 0.0, 1.0)
    # up: first the foot rises, then it goes ahead; down: the other way round; it is put down from above
    rising = smooth(air / 0.6) if stairs.rise > 0.0 else smooth((air - 0.4) / 0.6)
    going = smooth((air - 0.15) / 0.65) if stairs.rise > 0.0 else smooth(air / 0.75)
    lifted = _CLEARS[0 if stairs.rise > 0.0 else 1] * smooth(air / 0.5) * smooth((1.0 - air) / 0.4)
    off = smooth((phase - _RISES) / (_HIGHEST - _RISES)) * (1.0 - smooth((phase - _HIGHEST) / (_BACK - _HIGHEST)))
    put_down = smooth((phase - _HIGHEST) / (_BACK - _HIGHEST)) + (1.0 - smooth(phase / _DOWN)) * (phase < _DOWN)
    pitch = -stairs.heel_off * off - stairs.lands * put_down
    ahead = stairs.tread * (begun + 2.0 * going)
    up = stairs.rise * (begun + 2.0 * rising) + lifted
    advance, share = 2.0 * stairs.tread, shares(left, right, _LEAVES)
    centre = np.full((SAMPLES, 2), 0.5 * (person.heel + person.toe)) + 0.4 * person.toe * smooth((phase - 0.2) / 0.3)
    steady = advance * right
    height = 0.5 * (person.thigh + person.shank) + 0.55 * person.height / 1.7
    below = (share * (ahead + centre)).sum(axis=1) - steady
    pelvis = np.stack([steady + above(below, height, stairs.period), 0.9 * person.height / 1.7 + ground.grade * steady], axis=1)
    drawn = Paths(pelvis, np.full(SAMPLES, -LEAN), ahead, up, pitch, np.ones((SAMPLES, 2)))
    drawn = within_reach(drawn, person, ground, _STRETCHED * (person.thigh + person.shank), _BOB)
    stands = phase < _LEAVES
    on_heel = stands & (phase < _RISES) & (phase > (_DOWN if stairs.lands else -1.0))
    contact = np.stack([column for i in range(2) for column in (on_heel[:, i], stands[:, i])], axis=1)
    like = Motion(
        stairs.period, advance, np.zeros((SAMPLES, 9)), np.zeros((SAMPLES, 9)), np.zeros((SAMPLES, 9)), share, centre, contact,
        np.ones(SAMPLES), ground=ground,
    )  # fmt: skip
    return walked(drawn, like, person, ground, advance, stairs.period)


def _edge(stairs: Stairs, person: Person) -> float:
    """Return where the tread begins on which a foot stands whose ankle is at nil [m]."""
    if stairs.rise > 0.0:
        return person.toe - _FROM_EDGE[0]
    return person.toe + _FROM_EDGE[1] - stairs.tread
