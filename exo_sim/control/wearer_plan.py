"""What a wearer who is a body expects: a reference that he can stand on, and the moments that it asks of his joints.

The moments are those of inverse dynamics for the reference with the load that is expected of straps or pack (`ground_reaction`), before
its soles are pressed into the ground: what that adds to joints in steps of milliseconds is no plan of muscles. The
toes have the moment of the expected centre of pressure ahead of the ball, and a rest angle along the ground.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import Motion
from exo_sim.gait.moving_body import Moving, body_loads
from exo_sim.gait.pressed_soles import pressed
from exo_sim.machine import wearer_body
from exo_sim.machine.ground_reaction import FEET, TOES, Ground, hold, joint_moments
from exo_sim.machine.person import Person

Array = NDArray[np.float64]

#: The toes rest along the ground up to this angle, and so much above it [rad].
_TOES_BENT, _TOES_LIFTED = 1.2, np.radians(5.0)
#: A foot that turns about an end of its sole is held by its ankle's own spring with so much after a degree [N m]. With 0, 5 and 10 he
#: starts and stops under 34 and 45 kg, with the first at the least residual; from 5 on level walking knows no limit.
_TURNING = 5.0


@dataclass(frozen=True)
class Plan:
    """What a torque-driven wearer goes by.

    Attributes:
        motion: The reference, soles pressed into the ground, n samples.
        torque: Of hip, knee, ankle left and right, and both toes [N m], shape (n, 8).
        room: By how much each ankle may plantarflex and dorsiflex more before the foot turns about tip or heel of its sole, left and right
            [N m], shape (n, 4).
    """

    motion: Motion
    torque: Array
    room: Array


def plan(motion: Motion, person: Person, expected: Array | float = 0.0) -> Plan:
    """Return the plan for a motion.

    Args:
        motion: As residual reduction leaves it, n samples.
        person: Who walks.
        expected: Loads of straps or pack on the segments along the motion, about their upper joints, shape (n, 7, 3).
    """
    toes = TOES * person.scale
    poses, loads, ground = _held(motion, person, expected)
    moments = joint_moments(poses, loads, ground.force, ground.place)
    bent = np.clip(_TOES_LIFTED - poses[:, FEET, 2], 0.0, _TOES_BENT)
    ahead = np.clip(ground.centre - person.toe, 0.0, toes)
    toe = wearer_body.TOE_STIFFNESS * bent - ahead * ground.force[:, :, 1]
    ends = np.array([person.toe + toes, person.heel])
    room = _TURNING + np.abs(ends - ground.centre[:, :, None]) * np.maximum(ground.force[:, :, 1:], 0.0)
    return Plan(pressed(motion, person, ground.force, ground.centre), np.concatenate([moments, toe], axis=1), room.reshape(len(room), 4))


def _held(motion: Motion, person: Person, expected: Array | float) -> tuple[Array, Array, Ground]:
    """Return poses, all loads on the segments and what the ground gives along a motion."""
    poses, own = body_loads(Moving.of(motion), person)
    loads = own + expected
    return poses, loads, hold(poses, loads, motion.share, motion.pressure_centre, motion.support, person)
