"""What a run comes to: the numbers of the `run` JSON, also of one that comes piece by piece."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import SAMPLES
from exo_sim.machine.wearer import backpack_wrench, extra_moments
from exo_sim.physics.pneumatics import Books
from exo_sim.simulation.reduction import Change, Mean, Peak, Rms, joined, values
from exo_sim.simulation.walk import JOINTS, Walk

#: Cycles at the start that are left out, where enough others remain.
SETTLING = 2


def span(walk: Walk) -> slice:
    """Return the rows that count: whole cycles, the first two of the run left out where at least one other remains.

    A later piece of a run begins with a whole cycle, and its first piece, where others follow, holds more than it leaves out.
    """
    per_cycle = walk.motion.period / walk.step
    end = walk.first + len(walk.time)
    whole = int((end + 0.5) / per_cycle + 1e-9)
    if whole < 1:
        return slice(0, len(walk.time))
    first = max(walk.first, round(min(SETTLING, whole - 1) * per_cycle))
    return slice(first - walk.first, min(round(whole * per_cycle), end) - walk.first)


class Summary:
    """Takes in a run piece by piece."""

    def __init__(self) -> None:
        self._measured: dict[str, Any] | None = None
        self._scenario, self._simulated = "", 0.0
        self._books: Books | None = None

    def add(self, walk: Walk) -> None:
        """Take in the next piece."""
        self._scenario, self._books = walk.request.scenario, walk.books
        self._simulated = float((walk.first + len(walk.time)) * walk.step)
        rows = span(walk)
        if rows.stop > rows.start:
            measured = measure(walk, rows)
            self._measured = measured if self._measured is None else joined(self._measured, measured)

    def numbers(self) -> dict[str, Any]:
        """Return the numbers over whole cycles, without file names and wall time."""
        out = {"schema": "exo-sim/run/1", "scenario": self._scenario, "simulated_s": self._simulated, **values(self._measured or {})}
        if self._books is not None:
            out["books"] = {
                "gas_mass_residual": self._books.mass_residual,
                "gas_energy_residual": self._books.energy_residual,
            }
        return out


def summarise(walk: Walk) -> dict[str, Any]:
    """Return the numbers of a whole run over whole cycles, without file names and wall time."""
    summary = Summary()
    summary.add(walk)
    return summary.numbers()


def _along(walk: Walk, table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Look a table of the motion up at every row, shape (n, m)."""
    phase = (walk.time / walk.motion.period) % 1.0
    grid = np.arange(SAMPLES + 1) / SAMPLES
    closed = np.concatenate([table, table[:1]])
    return np.stack([np.interp(phase, grid, column) for column in closed.T], axis=1)


def wearer_moments(walk: Walk) -> NDArray[np.float64]:
    """Return the extra moments that the straps ask of the wearer [N m], columns as `walk.JOINTS`, shape (n, 6)."""
    share, centre = _along(walk, walk.motion.share), _along(walk, walk.motion.pressure_centre)
    return extra_moments(walk.poses, walk.wrench, share, centre, walk.person.ankle_height) * _on_feet(walk)


def backpack_moments(walk: Walk) -> NDArray[np.float64]:
    """Return the extra moments that the same payload asks as a backpack [N m], shape (n, 6)."""
    motion, model = walk.motion, walk.model
    body = int(model.geom("payload").bodyid[0])
    place = model.body_pos[body] + model.body_ipos[body]
    inertia = float(model.body_inertia[body, 1] / model.body_mass[body])
    position = _along(walk, np.concatenate([motion.position[:, :3], motion.slope[:, :3] / motion.period], axis=1))
    acceleration = _along(walk, motion.curvature[:, :3] / motion.period**2)
    wrench = backpack_wrench(position, acceleration, (float(place[0]), float(place[2])), walk.payload, inertia)
    share, centre = _along(walk, motion.share), _along(walk, motion.pressure_centre)
    return extra_moments(walk.poses, wrench, share, centre, walk.person.ankle_height) * _on_feet(walk)


def _on_feet(walk: Walk) -> NDArray[np.float64]:
    """Return how far the wearer stands on the feet, 0 where a seat carries, shape (n, 1)."""
    return _along(walk, walk.motion.support[:, None])


def measure(walk: Walk, rows: slice) -> dict[str, Any]:
    """Return what some rows of a walk come to, as reductions in the places of the JSON's numbers."""
    part = {key: column[rows] for key, column in walk.columns.items()}
    torso = [name for name in walk.straps.names if name.startswith("torso")]
    up = {name: part[f"{name}.strap_force_z"] for name in walk.straps.names}
    ahead = {name: part[f"{name}.strap_force_x"] for name in walk.straps.names}
    torso_up = np.sum([up[name] for name in torso], axis=0)
    extra, backpack = wearer_moments(walk)[rows], backpack_moments(walk)[rows]
    moments = {
        title: {name: Rms.of(table[:, [k, k + 3]]) for k, name in enumerate(("hip", "knee", "ankle"))}
        for title, table in (("extra_moment_rms_nm", extra), ("backpack_moment_rms_nm", backpack))
    }
    out: dict[str, Any] = {
        "supported_weight_n": Mean.of(walk.weight[rows]),
        "mean_ground_force_n": Mean.of(part["foot_l.ground_force_z"] + part["foot_r.ground_force_z"]),
        "strap_load_n": {
            "vertical_mean": Mean.of(np.sum(list(up.values()), axis=0)),
            "torso_vertical_mean": Mean.of(torso_up),
            "torso_rms": Rms.of(torso_up),
            "torso_peak": Peak.of(np.abs(torso_up)),
            "torso_forward_rms": Rms.of(np.sum([ahead[name] for name in torso], axis=0)),
        },
        "wearer": moments,
        "joints": {
            name: {
                "torque_peak_nm": Peak.of(np.abs(part[f"{name}.torque"])),
                "torque_rms_nm": Rms.of(part[f"{name}.torque"]),
                "torque_error_rms_nm": Rms.of(part[f"{name}.torque"] - part[f"{name}.torque_demanded"]),
            }
            for name in JOINTS
        },
    }
    if walk.books is not None:
        cycles = (rows.stop - rows.start) * walk.step / walk.motion.period
        out["cylinders"] = {
            name: {
                "pressure_peak_pa": Peak.of([part[f"{name}.pressure_1"].max(), part[f"{name}.pressure_2"].max()]),
                "choked_share": Mean.of(part[f"{name}.choked"] / 2),
                "gas_kg_per_stride": Change(float(part[f"{name}.gas_used"][0]), float(part[f"{name}.gas_used"][-1]), cycles),
            }
            for name in walk.rig.cylinders
        }
    return out
