"""The log of a worn machine: which numbers it has behind the time, and rows of it as a walk."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from exo_sim.simulation import loop, wearer_log
from exo_sim.simulation.walk import Walk, as_columns, layout

if TYPE_CHECKING:
    from exo_sim.simulation.worn import Simulation


def keys_of(it: Simulation) -> list[tuple[str, str]]:
    """Return key and unit of every number that the loop logs behind the time, in its order."""
    own_columns = [] if it.torques is None else wearer_log.layout()
    return layout(it.rig, it.straps, not it.request.ideal) + own_columns


def walk_of(it: Simulation, log: NDArray[np.float64], keys: list[tuple[str, str]], first: int, interrupted: bool) -> Walk:
    """Return rows of the log, the first of them that of step `first`, as a walk; `keys` as `keys_of` returns them."""
    columns, units, wrench = as_columns(log, keys)
    n = len(log)
    time = np.asarray(np.arange(first, first + n) * it.dt, dtype=np.float64)
    if (trial := it.motion.trial) is not None:
        columns["gait.phase"] = trial.phase_at(time / it.motion.period)
    moved = None if it.torques is None else wearer_log.moved(columns, wrench, it.person)
    poses = loop.person_along(time, it.motion, it.person) if moved is None else moved.poses
    if moved is not None:
        columns, units = wearer_log.shown(columns), wearer_log.shown(units)
    payload = np.full(n, it.request.payload)
    if it.added:
        payload += it.added.mass * np.clip((time - it.added_at) / it.added.over, 0.0, 1.0)
    gravity = float(-it.model.opt.gravity[2])
    return Walk(
        request=it.request,
        rig=it.rig,
        person=it.person,
        motion=it.motion,
        plain=it.plain,
        straps=it.straps,
        time=time,
        columns=columns,
        units=units,
        poses=poses,
        wrench=wrench,
        weight=(it.frame_mass + payload) * gravity,
        payload=payload,
        books=None if it.request.ideal or n == 0 else it.plugin.books(),
        step=it.dt,
        interrupted=interrupted,
        model=it.model,
        moved=moved,
        first=first,
    )
