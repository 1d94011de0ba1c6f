"""Simulate what was recorded and show both."""

from __future__ import annotations

from pathlib import Path

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb


@verb(
    "exo-sim compare bench.csv --rig rig.toml",
    "exo-sim compare fresh.parquet --rig found/improved.toml --out fresh.rrd --json",
    out="Recording for the viewer (.rrd), recorded and simulated overlaid; RECORDING_compared.rrd when absent.",
)
@click.argument("recording", type=options.InputFile())
@click.option("--rig", type=options.RigFile(), required=True, help="The machine as its owner gives it.")
@click.option("--columns", type=options.InputFile(), default=None, help="Column map (TOML) for foreign names.")
@click.option(
    "--motion",
    type=options.Choice(["auto", "predicted", "recorded"]),
    default="auto",
    show_default=True,
    help="Whether positions are predicted too or taken as recorded; auto: as recorded where forces that nobody measured moved them.",
)
def command(
    recording: Path, rig: Path, columns: Path | None, motion: str, out: Path | None, as_json: bool, quiet: bool
) -> None:
    """Compare RECORDING (.csv, .parquet or .rrd) with what the rig would have done.

    Every measured pressure and position is predicted twice: over windows of 0.5 s, each from the measured state, and in
    one run from the first.
    """
    from exo_sim.api.arguments import check_target
    from exo_sim.api.comparing import compare
    from exo_sim.outputs import check_writable
    from exo_sim.progress import Bar

    path = check_target(out or f"{recording.stem}_compared.rrd")
    check_writable(path.parent)
    with Bar(1.0, "simulating", "of it", quiet) as bar:
        found = compare(recording, rig, motion=motion, columns=columns, progress=bar.to)
    found.save(path)
    for words in found.remarks:
        printing.remark(f"exo-sim: {words}", quiet=quiet)
    data = {**found.summary, "recording": recording, "rig": rig, "comparison": path}
    printing.show(data, f"{found}\nrecorded and simulated: {path} (exo-sim view {path})", as_json=as_json)
