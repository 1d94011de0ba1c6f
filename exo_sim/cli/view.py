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
@click.option("--at", type=float, default=None, metavar="SECONDS", help="Time to show in a picture; the middle when absent.")
def command(
    recording: Path, columns: Path | None, at: float | None, out: Path | None, as_json: bool, quiet: bool
) -> None:
    """Show RECORDING with its scene and plots. A .csv or .parquet file is laid out like a recorded run."""
    from exo_sim.errors import OutputError
    from exo_sim.recording import viewer

    if out is not None and out.suffix.lower() != ".png":
        raise OutputError(f'cannot write "{out}": a picture ends in .png')
    if at is not None or out is not None:
        at = _moment(recording, columns, at)
    with viewer.as_rrd(recording, columns, keep=out is None) as rrd:
        if out is None:
            viewer.open_window(rrd)
            data, words = {"window": True, "recording": str(recording)}, f"opened {recording} in the rerun viewer"
        else:
            from exo_sim.recording.rrd_picture import take_picture

            take_picture(rrd, out, at)
            data, words = {"window": False, "recording": str(recording), "picture": str(out)}, str(out)
    printing.show({"schema": "exo-sim/view/1", **data}, words, as_json=as_json)


def _moment(recording: Path, columns: Path | None, at: float | None) -> float:
    """Return the moment to show, by itself the middle; refuse one that was not recorded: the viewer would show an empty scene."""
    from exo_sim.errors import RecordingError
    from exo_sim.recording import read
    from exo_sim.recording.instants import instant

    time = read(recording, columns).recording.time
    if at is None:
        return float(0.5 * (time[0] + time[-1]))
    if not time[0] <= at <= time[-1]:
        asked, first, last = (instant(float(each), float(time[0]), float(time[-1])) for each in (at, time[0], time[-1]))
        raise RecordingError(f'--at {asked}: "{recording}" goes from {first} to {last} s')
    return at
