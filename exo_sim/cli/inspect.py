"""Show what is in a recording, and what looks wrong."""

from __future__ import annotations

from pathlib import Path

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb


@verb(
    "exo-sim inspect walk.rrd",
    "exo-sim inspect bench.csv --columns bench_columns.toml --rig rig.toml --json",
    out="File for the summary; stdout when absent.",
)
@click.argument("recording", type=options.InputFile())
@click.option("--rig", type=options.RigFile(), default=None, help="The machine: more can then be found wrong.")
@click.option("--columns", type=options.InputFile(), default=None, help="Column map (TOML) for foreign names.")
@click.option("--all", "every_column", is_flag=True, help="The numbers of every column, also where there are many.")
def command(
    recording: Path, rig: Path | None, columns: Path | None, every_column: bool, out: Path | None, as_json: bool, quiet: bool
) -> None:
    """Show what looks wrong in RECORDING, a .csv, .parquet or .rrd file, and its signals, gait events, pressures, torques and gas used.

    What looks wrong is marked: !! where a sensor or the file is wrong, ! where results may be spoilt.
    """
    from exo_sim.api.inspecting import inspect

    found = inspect(recording, rig, columns=columns)
    printing.show(found.summary, found.text(every_column), as_json=as_json, out=out)
