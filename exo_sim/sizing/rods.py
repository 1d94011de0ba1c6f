"""What a walk asks of rods and their bearings, beside what the gas pushes: buckling and side load, with numbers."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.anthropometry import GRAVITY
from exo_sim.machine.linkage import linkages, tendon_ends
from exo_sim.rig.catalogue import find
from exo_sim.simulation.walk import Walk

#: Young's modulus of a steel rod [Pa].
_STEEL = 2.06e11
_SAMPLES = 200


@dataclass(frozen=True)
class RodCheck:
    """One cylinder along a walk.

    Attributes:
        name: Of the cylinder.
        push: Largest push on its rod [N], 0 where it only pulls.
        length: Distance of the pivots there [m].
        buckling: Euler's load of the rod, hinged at both ends over that length, over that push; infinite where it only pulls.
        side: Largest force across the rod at its eye that turns and carries the cylinder [N], an upper bound: its mass spread evenly
            between its pivots; None where the catalogue does not know its mass.
        speed: Fastest piston [m/s].
    """

    name: str
    push: float
    length: float
    buckling: float
    side: float | None
    speed: float


def rod_checks(walk: Walk) -> tuple[RodCheck, ...]:
    """Return what a walk asks of each cylinder whose transmission is a tendon between two sites."""
    data = mujoco.MjData(walk.model)
    period, found = walk.motion.period, []
    phases = np.arange(_SAMPLES) / _SAMPLES
    links = linkages(walk.rig, walk.model)
    ends = {link.cylinder: tendon_ends(walk.model, walk.rig.cylinders[link.cylinder].actuator) for link in links}
    places: dict[str, list[NDArray[np.float64]]] = {name: [] for name, pair in ends.items() if pair}
    for q in walk.motion.at(phases):
        data.qpos[:] = q
        mujoco.mj_kinematics(walk.model, data)
        for name in places:
            pair = ends[name]
            assert pair
            places[name].append(np.stack([data.site_xpos[site] for site in pair]))
    for link in links:
        name, cylinder = link.cylinder, walk.rig.cylinders[link.cylinder]
        if name not in places:
            continue
        force, length = walk.columns[f"{name}.force"], walk.columns[f"{name}.length"] + cylinder.retracted_length
        at = int(np.argmax(force))
        push, euler = max(float(force[at]), 0.0), np.pi**2 * _STEEL * np.pi / 64 * cylinder.rod**4 / float(length[at]) ** 2
        entry = find(cylinder.bore, cylinder.rod)
        side = None if entry is None else _side_load(np.array(places[name]), entry.mass(cylinder.stroke), period)
        speed = float(np.abs(np.gradient(length, walk.step)).max())
        found.append(RodCheck(name, push, float(length[at]), euler / push if push > 0.0 else np.inf, side, speed))
    return tuple(found)


def _side_load(ends: NDArray[np.float64], mass: float, period: float) -> float:
    """Return the largest force across the rod at its eye [N].

    Args:
        ends: Of the barrel's pivot and the rod's eye over a cycle [m], shape (n, 2, 3), the even advance left out.
        mass: Of the cylinder [kg].
        period: Of the cycle [s].
    """
    between = (ends[:, 1] - ends[:, 0])[:, [0, 2]]
    length = np.linalg.norm(between, axis=1)
    along = between / length[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    angle = np.unwrap(np.arctan2(between[:, 1], between[:, 0]))
    turning = _rate(_rate(angle, period), period)
    base = ends[:, 0][:, [0, 2]]
    pivot = np.stack([_rate(_rate(base[:, i], period), period) for i in range(2)], axis=1)
    pivot[:, 1] += GRAVITY
    moment = mass * length**2 / 3.0 * turning + mass * 0.5 * length * np.einsum("ni,ni->n", pivot, across)
    return float(np.abs(moment / length).max())


def _rate(values: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    """Return the derivative by time of even samples of a periodic number, its first ten harmonics alone."""
    spectrum = np.fft.rfft(values)
    order = np.arange(len(spectrum))
    spectrum[order > 10] = 0.0
    return np.asarray(np.fft.irfft(2j * np.pi * order / period * spectrum, len(values)))
