"""Open a recording in the rerun viewer, or take a picture of it."""

from __future__ import annotations

from pathlib import Path

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb


@verb(
    "exo-sim view walk.rrd",
    "exo-sim view walk.rrd --out walk.png --at 4.3",
    out="Picture (.png) to take instead of opening a window; needs no display.",
)
@click.argument("recording", type=options.InputFile())
@click.option("--columns", type=options.InputFile(), default=None, help="Column map (TOML) for foreign names.")
@click.option("--at", type=float, default=None, metavar="SECONDS", help="Time to show in a picture.")
def command(
    recording: Path, columns: Path | None, at: float | None, out: Path | None, as_json: bool, quiet: bool
) -> None:
    """Show RECORDING with its scene and plots. A .csv or .parquet file is laid out like a recorded run."""
    from exo_sim.recording import viewer

    with viewer.as_rrd(recording, columns, keep=out is None) as rrd:
        if out is None:
            viewer.open_window(rrd)
            data, words = {"window": True, "recording": str(recording)}, f"opened {recording} in the rerun viewer"
        else:
            from exo_sim.recording.picture import take_picture

            take_picture(rrd, out, at)
            data, words = {"window": False, "recording": str(recording), "picture": str(out)}, str(out)
    printing.show({"schema": "exo-sim/view/1", **data}, words, as_json=as_json)
