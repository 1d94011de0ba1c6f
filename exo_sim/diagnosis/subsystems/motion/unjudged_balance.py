"""Why the forces at a joint cannot be judged: something pushed it that no recording holds."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.open_questions import Unjudged
from exo_sim.diagnosis.policy.recordings import LEAST_KNOWN
from exo_sim.machine.linkage import Linkage
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

Array = NDArray[np.float64]


def bound_by_model(model: mujoco.MjModel) -> str:
    """Return what of the MJCF pushes and is in no recording, or ""."""
    bound = [model.equality(i).name or f"number {i + 1}" for i in range(model.neq) if model.eq_active0[i]]
    return f'the equality constraint "{bound[0]}" of the MJCF holds parts of it by a force that nobody recorded' if bound else ""


def not_recorded(recording: Recording, rig: Rig, driven: Sequence[Linkage], external: bool, fed: Collection[str]) -> str:
    """Return why the balance of a joint that these cylinders drive, of which some are fed without a command, cannot be judged, or ""."""
    for link in driven:
        if f"{link.cylinder}.force" in recording:
            continue
        sides = ("pressure_1",) if rig.cylinders[link.cylinder].single_acting else ("pressure_1", "pressure_2")
        lacking = [s for s in sides if f"{link.cylinder}.{s}" not in recording]
        if lacking:
            return f"{link.cylinder}.{lacking[0]} was not recorded"
        commands = rig.cylinders[link.cylinder].commands
        commanded = any(f"{link.cylinder}.{command}" in recording for command in commands)
        if not commanded and not external and link.cylinder not in fed:
            return f"nothing that was recorded drives {link.cylinder}: what moved it from outside is not known"
    return ""


def rarely_known(time: Array, known: NDArray[np.bool_]) -> Unjudged | None:
    """Return why too little of the time has all forces at a joint recorded, or None."""
    if _is_enough(time, known):
        return None
    if known.all():
        return Unjudged(f"it was recorded for {float(np.ptp(time)):.2g} s", f"record {LEAST_KNOWN:g} s of its motion or more")
    why = "where the ground pushes is not known, and the foot is hardly ever in the air"
    return Unjudged(why, "record <foot>.pressure_centre as well")


def rarely_free(time: Array, free: NDArray[np.bool_]) -> Unjudged | None:
    """Return why a joint that hardly ever leaves its stops cannot be judged, or None."""
    if _is_enough(time, free):
        return None
    why = "it lies against a stop that the MJCF gives it (range) nearly all the time: what the stop pushes is not known"
    return Unjudged(why, "move it between its stops, or correct its range in the MJCF")


def rarely_whole(time: Array, whole: NDArray[np.bool_], columns: Sequence[str]) -> Unjudged | None:
    """Return why a joint cannot be judged of whose columns one or another has a hole nearly all the time, or None."""
    if _is_enough(time, whole):
        return None
    why = f"{' or '.join(columns)} has holes nearly all the time, which no filter bridges"
    return Unjudged(why, f"record {LEAST_KNOWN:g} s or more without holes")


def _is_enough(time: Array, usable: NDArray[np.bool_]) -> bool:
    """Return whether so much of a time is usable that a joint can be judged by it."""
    return float(usable.mean()) * float(np.ptp(time)) >= LEAST_KNOWN
