"""Folders of sound inputs, which the edits of a case then break."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np

from fuzzing import foreign_bases

ASSETS = Path(__file__).resolve().parents[2] / "assets"
#: Samples and step [s] of the bench's recording.
_SAMPLES, _STEP = 400, 1e-3
_MAP = """[file]
delimiter = ";"

[columns]
"t(ms)" = "time [ms]"
"Valve" = "piston.valve_command [1]"
"P1" = { column = "piston.pressure_1 [bar]", offset = 1.01325 }
"P2" = { column = "piston.pressure_2 [bar]", offset = 1.01325 }
"Pos" = "slide.position [in]"
"""
_ANSWER = {
    "schema": "exo-sim/diagnosis/1",
    "verdict": "mismatch",
    "effects": [{"name": "coulomb_friction", "where": "piston", "kind": "missing_physics", "parameters": {"force": {"value": 20.0}}}],
}
TOOL = """import pathlib
pathlib.Path("out").mkdir(exist_ok=True)
pathlib.Path("out/diagnosis.json").write_text(pathlib.Path("../answer.json").read_text())
"""


def make(folder: Path) -> None:
    """Write every base into a folder of its name."""
    _bench(folder / "bench")
    _exoskeleton(folder / "exo")
    _trial(folder / "trial")
    foreign_bases.walk(folder / "walk")


def _bench(folder: Path) -> None:
    """A load on a rail, a recording of it in every format, and the same in a stranger's words with a column map."""
    import mujoco

    from exo_sim import rig as rigs
    from exo_sim.machine.rig_model import load
    from exo_sim.recording import Recording, write_rrd
    from exo_sim.recording.table_file import write_table
    from exo_sim.simulation.plugin import PneumaticPlugin

    folder.mkdir(parents=True)
    for name in ("bench.toml", "bench.xml"):
        shutil.copyfile(ASSETS / name, folder / name)
    rig = rigs.read(folder / "bench.toml")
    model = load(rig)
    data, plugin = mujoco.MjData(model), PneumaticPlugin(model, rig)
    plugin.reset(data, 4e5, 4.5e5)
    time = np.arange(_SAMPLES, dtype=np.float64) * _STEP
    command = 0.6 * np.sign(np.sin(25.0 * time + 0.3))
    rows = np.empty((_SAMPLES, 3))
    for i in range(_SAMPLES):
        rows[i] = data.qpos[0], *plugin.pressures()[0]
        plugin.command[:] = command[i]
        plugin.step(data)
    columns = {
        "piston.valve_command": command, "piston.pressure_1": rows[:, 1], "piston.pressure_2": rows[:, 2], "slide.position": rows[:, 0],
    }  # fmt: skip
    units = {"piston.valve_command": "1", "piston.pressure_1": "Pa", "piston.pressure_2": "Pa", "slide.position": "m"}
    recording = Recording("bench", time, columns, units)
    write_table(folder / "bench.csv", recording)
    write_table(folder / "bench.parquet", recording)
    write_rrd(folder / "bench.rrd", recording)
    foreign_bases.recordings(folder, time, columns, units)
    (folder / "map.toml").write_text(_MAP)
    strange = np.column_stack([time * 1e3, command, (rows[:, 1:] - 101325.0) / 1e5, rows[:, 0] / 0.0254])
    lines = ["t(ms);Valve;P1;P2;Pos", *(";".join(f"{value:.9g}" for value in row) for row in strange)]
    (folder / "strange.csv").write_text("\n".join(lines) + "\n")


def _exoskeleton(folder: Path) -> None:
    folder.mkdir()
    for name in ("exo_250_psi.toml", "exo.xml"):
        shutil.copyfile(ASSETS / name, folder / name.replace("_250_psi", ""))  # what is kept edits the lines of this one


def _trial(folder: Path) -> None:
    """A trial of two short cases, one half diagnosed by a tool that always says the same, and one not diagnosed."""
    import sys

    from exo_sim.trials import protocol
    from exo_sim.trials.case_mix import draw_plans

    folder.mkdir()
    protocol.make(folder / "trial", draw_plans(2, 11), folder / "trial.key", duration=4.0, quiet=True)
    (folder / "tool.py").write_text(TOOL.replace("../answer.json", str(folder / "answer.json")))
    (folder / "answer.json").write_text(json.dumps(_ANSWER))
    shutil.copytree(folder / "trial", folder / "undone")
    protocol.run(folder / "trial", f"{sys.executable} {folder / 'tool.py'}", quiet=True)
