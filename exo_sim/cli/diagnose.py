"""Say what physics a rig leaves out: locate, name, model and prove it."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb

if TYPE_CHECKING:
    from exo_sim.diagnosis.findings import Diagnosis

#: What is written, and what it holds.
FILES = {
    "report": ("report.html", "the page to read and to print"),
    "improved": ("improved.toml", "the rig with what was found"),
    "comparison": ("comparison.rrd", "recorded, before and after"),
    "diagnosis": ("diagnosis.json", "everything, for machines"),
}


@verb(
    "exo-sim diagnose bench.csv --rig rig.toml --out found",
    "exo-sim diagnose monday.parquet tuesday.parquet --rig rig.toml --out found --json",
    out="Folder for report.html, improved.toml, comparison.rrd and diagnosis.json; diagnosis/ when absent.",
    seed=True,
)
@click.argument("recordings", type=options.InputFile(), nargs=-1, required=True, metavar="RECORDING...")
@click.option("--rig", type=options.InputFile(), required=True, help="The machine as it is believed to be.")
@click.option("--columns", type=options.InputFile(), default=None, help="Column map (TOML) for foreign names.")
@click.option("--budget", type=options.Quantity("s", low=1.0), default=None, help="Time after which the best answer so far comes.")
@click.option("--jobs", type=click.IntRange(1, 1024), default=None, help="Threads; all cores when absent. No answer depends on it.")
def command(
    recordings: tuple[Path, ...], rig: Path, columns: Path | None, budget: float | None, jobs: int | None, out: Path | None,
    as_json: bool, quiet: bool, seed: int,
) -> int:  # fmt: skip
    """Hold one or more RECORDINGS of one machine against its rig.

    Exit status: 0 where they agree, at most after believed numbers were corrected; 3 where physics is missing or a sensor
    is at fault; 4 where the recordings cannot tell; 2 for unusable input.
    """
    from exo_sim.diagnosis.pipeline.diagnose import diagnose
    from exo_sim.outputs import check_writable
    from exo_sim.progress import Stages

    begun = time.monotonic()
    folder = out or Path("diagnosis")
    check_writable(folder)
    _refuse_own_rig(folder, rig)
    with Stages(quiet) as stages:
        diagnosis = diagnose(
            list(recordings), rig, column_map=columns, seed=seed, jobs=jobs, progress=stages.say, folder=folder,
            budget=math.inf if budget is None else budget,
        )  # fmt: skip
        stages.say("writing")
        write(folder, diagnosis, list(recordings), rig, columns)
    from exo_sim.report import diagnosis_text

    lines = [f"{folder / name}: {what}" for name, what in FILES.values()]
    spent = {"time_s": round(time.monotonic() - begun, 3)}
    data = diagnosis.as_dict() | spent | {"files": {key: folder / name for key, (name, _) in FILES.items()}}
    printing.show(data, diagnosis_text.text(diagnosis, lines), as_json=as_json)
    return diagnosis.exit_status


def write(folder: Path, diagnosis: Diagnosis, recordings: list[Path], rig: Path, columns: Path | None) -> None:
    """Write the four files into `folder`, each beside and then renamed into place.

    Raises:
        OutputError: the folder or a file cannot be written.
    """
    from dataclasses import replace

    from exo_sim.outputs import replacing
    from exo_sim.recording import read
    from exo_sim.report.comparison import write_comparison
    from exo_sim.report.diagnosis_page import page

    texts = {
        "improved": diagnosis.improved,
        "report": page(diagnosis, rig.read_text(encoding="utf-8"), rig.name),
        "diagnosis": printing.json_text(diagnosis.as_dict()) + "\n",
    }
    tables = diagnosis.tables or tuple(
        replace(read(path, columns).recording, name=name) for path, name in zip(recordings, diagnosis.recordings, strict=True)
    )
    write_comparison(folder / FILES["comparison"][0], diagnosis, tables)
    for key, text in texts.items():
        with replacing(folder / FILES[key][0]) as beside:
            beside.write_text(text, encoding="utf-8")


def _refuse_own_rig(folder: Path, rig: Path) -> None:
    """Keep `improved.toml` from being written over the rig that it improves."""
    from exo_sim.errors import OutputError

    improved = folder / FILES["improved"][0]
    if improved.exists() and improved.samefile(rig):
        raise OutputError(f'cannot write "{improved}": it is the rig that was handed in; name another folder with --out')
