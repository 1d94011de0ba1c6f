"""Find what physics a rig leaves out, tested on held-out time."""

from __future__ import annotations

from pathlib import Path

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb


@verb(
    "exo-sim diagnose bench.csv --rig rig.toml --out found",
    "exo-sim diagnose monday.parquet tuesday.parquet --rig rig.toml --out found --json",
    out="Folder for report.html, improved.toml, comparison.rrd and diagnosis.json; diagnosis/ when absent.",
    seed=True,
)
@click.argument("recordings", type=options.InputFile(), nargs=-1, required=True, metavar="RECORDING...")
@click.option("--rig", type=options.RigFile(), required=True, help="The machine as its owner gives it.")
@click.option("--columns", type=options.InputFile(), default=None, help="Column map (TOML) for foreign names.")
@click.option("--budget", type=options.Quantity("s", low=1.0), default=None, help="After this time the best answer so far comes.")
@click.option("--jobs", type=click.IntRange(1, 1024), default=None, help="Threads; all cores when absent. The answer is the same.")
def command(
    recordings: tuple[Path, ...], rig: Path, columns: Path | None, budget: float | None, jobs: int | None, out: Path | None,
    as_json: bool, quiet: bool, seed: int,
) -> int:  # fmt: skip
    """Find what the rig of a machine leaves out, from one or more RECORDINGS of it.

    Exit status: 0 where they agree, at most after numbers of the rig were corrected; 3 where physics is missing or a sensor
    is at fault; 4 where the recordings cannot tell; 2 for unusable input.
    """
    from exo_sim.api.diagnosing import FILES, diagnose, refuse_own_rig
    from exo_sim.outputs import check_writable
    from exo_sim.progress import Stages
    from exo_sim.report import diagnosis_text

    folder = out or Path("diagnosis")
    check_writable(folder)
    refuse_own_rig(folder, rig)
    with Stages(quiet) as stages:
        found = diagnose(
            list(recordings), rig, budget=budget, columns=columns, jobs=jobs, seed=seed, progress=stages.say, out=folder
        )
    lines = [f"{folder / name}: {what}" for name, what in FILES.values()]
    data = found.summary | {"files": {key: folder / name for key, (name, _) in FILES.items()}}
    printing.show(data, diagnosis_text.text(found.result, lines), as_json=as_json)
    return found.exit_status
