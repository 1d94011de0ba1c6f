"""A recorded level walk at another speed, up or down a slope.

Speed: the stride's time goes with speed to the power -0.58, its length with speed to the power 0.42 (Grieve and Gear 1966, "The
relationships between length of stride, step frequency, time of swing and speed of walking for children and adults", Ergonomics 9:379-399:
step frequency goes with the power 0.58 of speed in adults). The pitch of the feet goes with the length. The pelvis rises and falls with
the power 0.69 of speed, as the body's mass does (Orendurff and others 2004, "The effect of walking speed on center of mass displacement",
Journal of Rehabilitation Research and Development 41:829-834: 27 mm at 0.7 m/s, 48 mm at 1.6 m/s). Stance takes 3.5 % of the stride less
for each metre a second more (Kirtley, Whittle and Jefferson 1985, "Influence of walking speed on gait parameters", Journal of Biomedical
Engineering 7:282-288).

Slope: feet do to the ground what they did on level ground, in strides as long along it and as quick; the pelvis stays above them as it
was, and the trunk's lean is left to residual reduction. On a slope of 10 % that gives more flexion of hip and knee of the leading leg
uphill, and less downhill, as measured (Lay, Hass and Gregor 2006, "The effects of sloped surfaces on locomotion: a kinematic and kinetic
analysis", Journal of Biomechanics 39:1621-1628); that people walk slower up and shorten their steps down is left out.

In both the pelvis is as high as legs allow that are stretched as far as in the recorded walk, and no farther.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.gait.foot_timing import leaving_later
from exo_sim.gait.footpaths import paths, reach, walked, within_reach
from exo_sim.gait.motion import Motion
from exo_sim.machine.ground import LEVEL, Ground
from exo_sim.machine.person import Person

#: Power of speed with which step frequency goes.
FREQUENCY_POWER = 0.58
#: Power of speed with which the pelvis rises and falls.
RISE_POWER = 0.69
#: By how much stance is a smaller share of the stride for a higher speed [s/m].
STANCE_SHORTENS = 0.035
#: By how much the pelvis may bob more than on level ground [m], for each unit of grade.
_BOB = 0.1
#: Speeds that the law is used for, over the recorded one.
SPEEDS = (0.5, 1.5)


def at_speed(motion: Motion, person: Person, factor: float) -> Motion:
    """Return a level walk at a multiple of its speed.

    Raises:
        ScenarioError: a multiple outside `SPEEDS`.
    """
    if not SPEEDS[0] <= factor <= SPEEDS[1]:
        pace = motion.advance / motion.period
        raise ScenarioError(
            f"speed {factor * pace:.2f} m/s is {factor:.2g} times the recorded {pace:.2f} m/s; "
            f"write {SPEEDS[0] * pace:.2f} to {SPEEDS[1] * pace:.2f} m/s"
        )
    longer = factor ** (1.0 - FREQUENCY_POWER)
    it = paths(motion, person)
    advance, height = longer * motion.advance, it.pelvis[:, 1].mean()
    pelvis = np.stack([longer * it.pelvis[:, 0], height + factor**RISE_POWER * (it.pelvis[:, 1] - height)], axis=1)
    scaled = replace(it, pelvis=pelvis, ahead=longer * it.ahead, pitch=longer * it.pitch)
    later = STANCE_SHORTENS * (1.0 - factor) * motion.advance / motion.period
    scaled, like = leaving_later(scaled, replace(motion, advance=advance), later)
    scaled = within_reach(scaled, person, LEVEL, reach(it, person, LEVEL), 0.0)
    return walked(scaled, like, person, LEVEL, advance, motion.period / factor**FREQUENCY_POWER)


def on_slope(motion: Motion, person: Person, grade: float) -> Motion:
    """Return a level walk on a slope that rises (or falls) by `grade` metres a metre.

    Raises:
        ScenarioError: steeper than `ground.STEEPEST_SLOPE`.
    """
    ground = Ground(grade)
    it = paths(motion, person)
    pelvis = it.pelvis.copy()
    pelvis[:, 0] *= math.cos(ground.angle)
    pelvis[:, 1] += grade * pelvis[:, 0]
    moved = within_reach(replace(it, pelvis=pelvis), person, ground, reach(it, person, LEVEL), _BOB * abs(grade))
    return walked(moved, motion, person, ground, motion.advance * math.cos(ground.angle), motion.period)
