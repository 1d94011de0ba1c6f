"""What the wearer's joints, soles and pelvis must give along a walk: with the machine, with a backpack, alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import Motion
from exo_sim.gait.moving_body import Moving, body_loads, trunk
from exo_sim.gait.residual_reduction import reduced, with_backpack
from exo_sim.machine.person import Person
from exo_sim.machine.wearer_body import Pack
from exo_sim.machine.wearer_moments import backpack_wrench
from exo_sim.simulation.walk import Walk
from exo_sim.simulation.wearer_alone import one_cycle
from exo_sim.simulation.wearer_inverse_dynamics import Held, held


def along(walk: Walk, table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Look a table of the motion, one row a sample of it, up at every row of the walk: shape (n, ...)."""
    count = len(table)
    phase = (walk.time / walk.motion.period) % 1.0 * count
    low = phase.astype(np.int64) % count
    part = (phase - np.floor(phase)).reshape(-1, *([1] * (table.ndim - 1)))
    return np.asarray((1.0 - part) * table[low] + part * table[(low + 1) % count])


def with_machine(walk: Walk) -> Held:
    """Return what the wearer gives with the machine on, at every row: one who moves by torques has shown it himself."""
    return walk.moved if walk.moved is not None else _on_rows(walk, walk.wrench)


def own(walk: Walk) -> Held:
    """Return what the wearer would give for the own body alone with this motion, at every row."""
    return _on_rows(walk, 0.0)


@dataclass(frozen=True)
class Wearing:
    """What the wearer gives at every row: with the machine, and for the own body alone with the same motion."""

    machine: Held
    body: Held


def wearing(walk: Walk) -> Wearing:
    """Return what the wearer gives with the machine on and for the own body."""
    known = _Known.along(walk)
    return Wearing(walk.moved if walk.moved is not None else _on_rows(walk, walk.wrench, known), _on_rows(walk, 0.0, known))


def with_pack(walk: Walk) -> Held:
    """Return what the wearer would give with the same load as a backpack and with this motion, at every row."""
    position, acceleration = (along(walk, table) for table in trunk(Moving.of(walk.motion)))
    place, inertia = pack(walk)
    wrench = backpack_wrench(position, acceleration, place, walk.payload + hung(walk), inertia)
    return _on_rows(walk, wrench)


def by_backpack(walk: Walk) -> NDArray[np.float64]:
    """Return the extra moments that the same payload asks as a backpack, with the same motion [N m], shape (n, 6)."""
    return with_pack(walk).moments - own(walk).moments


def alone(walk: Walk) -> Held:
    """Return what the wearer gives without machine or load, along one cycle of the own motion."""
    if walk.moved is not None:
        return one_cycle(reduced(walk.plain, walk.person), walk.person, None, walk.step)
    return prescribed_alone(walk.plain, walk.person)


def prescribed_alone(plain: Motion, person: Person) -> Held:
    """Return what a person gives who does a motion, recorded or drawn, without machine or load, along one cycle."""
    return _on_cycle(reduced(plain, person), person)


def with_payload(walk: Walk, mass: float) -> Held:
    """Return what the wearer gives with a payload [kg] as a backpack, along one cycle of a motion for it."""
    place, inertia = pack(walk)
    motion = with_backpack(walk.plain, walk.person, place, mass, inertia)
    if walk.moved is not None:
        return one_cycle(motion, walk.person, Pack(mass, place, inertia), walk.step)
    position, acceleration = trunk(Moving.of(motion))
    return _on_cycle(
        motion, walk.person, backpack_wrench(position, acceleration, place, np.full(len(position), mass), inertia)
    )


def hung(walk: Walk) -> float:
    """Return what hangs on the machine beside the payload [kg]: a backpack with the same load holds it too."""
    return sum(walk.request.found.hung.values())


def pack(walk: Walk) -> tuple[tuple[float, float], float]:
    """Return where the payload's mass centre is from the hips, x and z [m], and its inertia a kilogram [m^2]."""
    model = walk.model
    body = int(model.geom("payload").bodyid[0])
    place = model.body_pos[body] + model.body_ipos[body]
    return (float(place[0]), float(place[2])), float(model.body_inertia[body, 1] / model.body_mass[body])


@dataclass(frozen=True)
class _Known:
    """What a motion says of every row: weight and inertia of the segments, shares of the feet, centres of pressure, and support."""

    own: NDArray[np.float64]
    share: NDArray[np.float64]
    centre: NDArray[np.float64]
    support: NDArray[np.float64]

    @classmethod
    def along(cls, walk: Walk) -> _Known:
        motion = walk.motion
        tables = (body_loads(Moving.of(motion), walk.person)[1], motion.share, motion.pressure_centre, motion.support)
        return cls(*(along(walk, table) for table in tables))


def _on_rows(walk: Walk, wrench: NDArray[np.float64] | float, known: _Known | None = None) -> Held:
    it = known or _Known.along(walk)
    return held(walk.poses, it.own + wrench, it.share, it.centre, it.support, walk.person, walk.motion.ground.angle)


def _on_cycle(motion: Motion, person: Person, wrench: NDArray[np.float64] | float = 0.0) -> Held:
    poses, own = body_loads(Moving.of(motion), person)
    return held(poses, own + wrench, motion.share, motion.pressure_centre, motion.support, person, motion.ground.angle)
