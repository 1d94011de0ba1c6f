"""Say what is in a recording, and what looks wrong."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb

if TYPE_CHECKING:
    from exo_sim.recording.health import Facts


@verb(
    "exo-sim inspect walk.rrd",
    "exo-sim inspect bench.csv --columns bench_columns.toml --rig rig.toml --json",
    out="File for the summary; stdout when absent.",
)
@click.argument("recording", type=options.InputFile())
@click.option("--rig", type=options.InputFile(), default=None, help="The machine: more can then be found wrong.")
@click.option("--columns", type=options.InputFile(), default=None, help="Column map (TOML) for foreign names.")
def command(
    recording: Path, rig: Path | None, columns: Path | None, out: Path | None, as_json: bool, quiet: bool
) -> None:
    """Show the signals, gait events, pressures, torques and gas used of RECORDING, a .csv, .parquet or .rrd file."""
    from exo_sim.recording import read, summary, summary_text

    found = summary.summarise(read(recording, columns), _facts(rig))
    printing.show(summary.as_dict(found), summary_text.text(found), as_json=as_json, out=out)


def _facts(path: Path | None) -> Facts | None:
    """Return what a rig says that a sensor can be held against."""
    if path is None:
        return None
    import mujoco

    from exo_sim import rig as rigs
    from exo_sim.errors import ModelError
    from exo_sim.recording.health import Facts

    machine = rigs.read(path)
    try:
        model = mujoco.MjModel.from_xml_path(str(machine.model))
    except ValueError as error:
        raise ModelError(f'"{machine.model}": MuJoCo refuses it: {str(error).splitlines()[0]}') from None
    return Facts.of(machine, model)
