"""`exo-sim run MOTION --rig RIG`: a machine that nobody wears follows a recorded motion."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from exo_sim.cli import printing
from exo_sim.control import own
from exo_sim.errors import OutputError, RecordingError
from exo_sim.outputs import check_writable, replacing_all
from exo_sim.recording import reader, write_rrd, write_table
from exo_sim.rig import Rig
from exo_sim.simulation import unworn_record
from exo_sim.simulation.kept import interrupts_noted
from exo_sim.simulation.unworn import UnwornSimulation


def command(rig: Rig, motion: Path, controller: str, out: Path | None, as_json: bool, quiet: bool, seed: int) -> None:
    """Let a machine follow a motion, write what happened and print the numbers."""
    path = out or Path(f"{motion.stem}_{rig.name}.rrd")
    if path.suffix.lower() != ".rrd":
        raise OutputError(f'cannot write "{path}": a recording for the viewer ends in .rrd')
    beside = path.with_suffix(".parquet")
    if motion.exists() and any(each.exists() and each.samefile(motion) for each in (path, beside)):
        raise RecordingError(f'"{motion}" would be overwritten by the run; name another file with --out')
    check_writable(path.parent)
    begun = time.perf_counter()
    reading = reader.read(motion)
    for finding in reading.findings:
        if finding.severity != "info":
            printing.remark(f"exo-sim: {finding.says}", quiet=quiet)
    brought: str | own.Controller = own.load(controller) if own.is_path(controller) else controller
    simulation = UnwornSimulation(rig, reading.recording, brought, controller, seed)
    prepared = time.perf_counter()
    with interrupts_noted() as asked_to_stop:
        run = simulation.run(quiet, asked_to_stop)
    table = unworn_record.recording(run, path.stem, seed)
    with replacing_all(path, beside) as (rrd, parquet):
        write_rrd(rrd, table, scene=unworn_record.scene(run))
        write_table(parquet, table)
    numbers = unworn_record.summarise(run)
    data: dict[str, Any] = {
        **{key: numbers.pop(key) for key in ("schema", "scenario", "simulated_s")},
        "wall_s": time.perf_counter() - prepared, "prepared_s": prepared - begun, "recording": path, "table": beside, **numbers,
        **({"remarks": list(simulation.remarks)} if simulation.remarks else {}),
    }  # fmt: skip
    for words in simulation.remarks:
        printing.remark(f"exo-sim: {words}", quiet=quiet)
    printing.show(data, _words(data), as_json=as_json)
    if run.interrupted:
        raise KeyboardInterrupt(f"{data['simulated_s']:.2f} s were simulated and are in {path} and {beside}")


def _words(data: dict[str, Any]) -> str:
    """Return the result as a short report."""
    rows = []
    for name, one in data["joints"].items():
        turns = "position_error_rms_rad" in one
        unit, factor = ("deg", 57.29577951308232) if turns else ("mm", 1e3)
        key, force, newton = ("rad", "torque", "nm") if turns else ("m", "force", "n")
        rows.append([
            name, f"{factor * one[f'position_error_rms_{key}']:.2f} {unit}", f"{factor * one[f'position_error_peak_{key}']:.2f} {unit}",
            f"{one[f'{force}_rms_{newton}']:.1f}", f"{one[f'{force}_peak_{newton}']:.1f} {'N m' if turns else 'N'}",
        ])  # fmt: skip
    cylinders = [
        [name, f"{one['pressure_peak_pa'] / 1e5:.1f}", f"{100 * one['choked_share']:.0f}", f"{one['force_error_rms_n']:.1f}",
         f"{1e3 * one['gas_kg']:.2f}"]
        for name, one in data["cylinders"].items()
    ]  # fmt: skip
    books = data["books"]
    return "\n".join([
        f"{data['scenario']}: {data['simulated_s']:.2f} s simulated in {data['wall_s']:.2f} s", "",
        printing.table(rows, ["joint", "error rms", "error peak", "made rms", "made peak"]), "",
        printing.table(cylinders, ["cylinder", "peak bar", "paths choked %", "force error rms N", "gas g"]), "",
        f"books: gas mass {books['gas_mass_residual']:.0e}, energy {books['gas_energy_residual']:.0e}",
        f"recording {data['recording']}, table {data['table']}",
    ])  # fmt: skip
