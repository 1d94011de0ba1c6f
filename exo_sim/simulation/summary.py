"""What a run comes to: the numbers of the `run` JSON."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import SAMPLES
from exo_sim.machine.wearer import backpack_wrench, extra_moments
from exo_sim.simulation.walk import JOINTS, Walk

#: Cycles at the start that are left out, where enough others remain.
SETTLING = 2


def span(walk: Walk) -> slice:
    """Return the rows that count: whole cycles, the first two left out where at least one other remains."""
    per_cycle = walk.motion.period / walk.step
    whole = int((len(walk.time) - 1) / per_cycle + 1e-6)
    if whole < 1:
        return slice(0, len(walk.time))
    first = min(SETTLING, whole - 1)
    return slice(round(first * per_cycle), round(whole * per_cycle))


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


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def summarise(walk: Walk) -> dict[str, Any]:
    """Return the numbers of a run over whole cycles, without file names and wall time."""
    if len(walk.time) < 2:
        return {"scenario": walk.request.scenario, "simulated_s": 0.0}
    rows, column = span(walk), walk.columns
    part = {key: values[rows] for key, values in column.items()}
    torso = [name for name in walk.straps.names if name.startswith("torso")]
    up = {name: part[f"{name}.strap_force_z"] for name in walk.straps.names}
    ahead = {name: part[f"{name}.strap_force_x"] for name in walk.straps.names}
    torso_up = np.sum([up[name] for name in torso], axis=0)
    extra, backpack = wearer_moments(walk)[rows], backpack_moments(walk)[rows]
    moments = {
        title: {name: _rms(table[:, [k, k + 3]]) for k, name in enumerate(("hip", "knee", "ankle"))}
        for title, table in (("extra_moment_rms_nm", extra), ("backpack_moment_rms_nm", backpack))
    }
    ground = part["foot_l.ground_force_z"] + part["foot_r.ground_force_z"]
    out: dict[str, Any] = {
        "schema": "exo-sim/run/1",
        "scenario": walk.request.scenario,
        "simulated_s": float(len(walk.time) * walk.step),
        "supported_weight_n": float(np.mean(walk.weight[rows])),
        "mean_ground_force_n": float(np.mean(ground)),
        "strap_load_n": {
            "vertical_mean": float(np.mean(np.sum(list(up.values()), axis=0))),
            "torso_vertical_mean": float(np.mean(torso_up)),
            "torso_rms": _rms(torso_up),
            "torso_peak": float(np.abs(torso_up).max()),
            "torso_forward_rms": _rms(np.sum([ahead[name] for name in torso], axis=0)),
        },
        "wearer": moments,
        "joints": {
            name: {
                "torque_peak_nm": float(np.abs(part[f"{name}.torque"]).max()),
                "torque_rms_nm": _rms(part[f"{name}.torque"]),
                "torque_error_rms_nm": _rms(part[f"{name}.torque"] - part[f"{name}.torque_demanded"]),
            }
            for name in JOINTS
        },
    }
    if walk.books is not None:
        cycles = (rows.stop - rows.start) * walk.step / walk.motion.period
        out["cylinders"] = {
            name: {
                "pressure_peak_pa": float(max(part[f"{name}.pressure_1"].max(), part[f"{name}.pressure_2"].max())),
                "choked_share": float(np.mean(part[f"{name}.choked"]) / 2),
                "gas_kg_per_stride": float(part[f"{name}.gas_used"][-1] - part[f"{name}.gas_used"][0]) / cycles,
            }
            for name in walk.rig.cylinders
        }
        out["books"] = {
            "gas_mass_residual": walk.books.mass_residual,
            "gas_energy_residual": walk.books.energy_residual,
        }
    return out
