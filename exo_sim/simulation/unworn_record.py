"""From a machine that followed a motion to what is written and printed: the table, the scene, the numbers."""

from __future__ import annotations

from importlib import metadata
from typing import Any

import numpy as np

from exo_sim.physics.nozzle import critical_ratio
from exo_sim.recording.scene import Scene
from exo_sim.recording.table import Recording
from exo_sim.simulation.machine_scene import FRAME_RATE, machine_scene
from exo_sim.simulation.sensors import observe
from exo_sim.simulation.unworn import MotionRun
from exo_sim.version import VERSION


def recording(run: MotionRun, name: str, seed: int = 0) -> Recording:
    """Return a run as a table with the contract's columns, as the rig's sensors show it."""
    notes = {
        "motion": run.motion.name, "controller": run.controller, "rig": run.rig.text, "seed": str(seed), "exo-sim": VERSION,
        **{package: metadata.version(package) for package in ("mujoco", "numpy", "numba")},
    }  # fmt: skip
    return observe(Recording(name, run.time, run.columns, run.units, notes), run.rig)


def scene(run: MotionRun) -> Scene:
    """Return the bodies and cylinders at `FRAME_RATE`."""
    every = max(1, round(1.0 / (FRAME_RATE * run.model.opt.timestep)))
    return machine_scene(run.model, run.rig, run.time[::every], run.qpos[::every])


def summarise(run: MotionRun) -> dict[str, Any]:
    """Return the numbers of the `run` JSON that make sense without a wearer, without file names and wall time.

    Of each joint: the error of its position, and the force that the cylinders made. The first tenth of the motion, 1 s at the most, in
    which the chambers fill, is left out of errors and shares.
    """
    n = len(run.time)
    first = min(int(0.1 * n), int(1.0 / run.model.opt.timestep))
    columns = run.columns
    joints = {}
    for name in run.motion.joints:
        error = columns[f"{name}.position"][first:] - columns[f"{name}.position_demanded"][first:]
        made = columns[f"{name}.torque"][first:]
        turns = run.units[f"{name}.position"] == "rad"
        unit, force = ("rad", "torque") if turns else ("m", "force")
        newton = "nm" if turns else "n"
        joints[name] = {
            f"position_error_rms_{unit}": float(np.sqrt(np.mean(error**2))), f"position_error_peak_{unit}": float(np.abs(error).max()),
            f"{force}_peak_{newton}": float(np.abs(made).max()), f"{force}_rms_{newton}": float(np.sqrt(np.mean(made**2))),
        }  # fmt: skip
    critical = critical_ratio(run.rig.heat_capacity_ratio)
    supply, exhaust = columns["supply.pressure"], columns["exhaust.pressure"]
    cylinders = {}
    for name in run.rig.cylinders:
        p_1, p_2 = (columns[f"{name}.{signal}"] for signal in ("pressure_1", "pressure_2"))
        commands = [columns[f"{name}.{signal}"] for signal in run.rig.cylinders[name].commands]
        choked = np.zeros(n)
        for u, p in ((commands[0], p_1), (commands[1] if len(commands) > 1 else -commands[0], p_2)):
            choked += (u != 0.0) * np.where(u > 0.0, p < critical * supply, exhaust < critical * p)
        off = columns[f"{name}.force"][first:] - columns[f"{name}.force_demanded"][first:]
        used = columns[f"{name}.gas_used"]
        cylinders[name] = {
            "pressure_peak_pa": float(max(p_1.max(), p_2.max())), "choked_share": float(np.mean(choked[first:] / 2)),
            "force_error_rms_n": float(np.sqrt(np.mean(off**2))), "gas_kg": float(used[-1] - used[0]),
        }  # fmt: skip
    return {
        "schema": "exo-sim/run/1", "scenario": run.motion.name, "simulated_s": float(n * run.model.opt.timestep), "joints": joints,
        "cylinders": cylinders,
        "books": {"gas_mass_residual": run.books.mass_residual, "gas_energy_residual": run.books.energy_residual},
    }  # fmt: skip
