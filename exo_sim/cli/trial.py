"""Draw sealed cases, diagnose them blind, open the seals, count."""

from __future__ import annotations

from pathlib import Path

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import group, verb
from exo_sim.errors import TrialError

command = group("Draw truths and seal them, diagnose them blind, open the seals and count.", "trial")
_CASES = 40
TRUTHS = ("own", "whole", "cantera")
_FOLDER = click.argument("folder", type=click.Path(path_type=Path, file_okay=False))
_JOBS = click.option(
    "--jobs", type=click.IntRange(-1), default=-1, show_default=True, help="Cases at a time; -1: all cores."
)


@verb(
    "exo-sim trial make --cases 400 --out trial --key ../trial.key",
    "exo-sim trial make --truth whole --cases 70 --out whole --key ../whole.key",
    name="make",
    out="Folder of the trial.",
    seed=True,
)
@click.option("--cases", type=click.IntRange(1), default=None, help=f"How many cases, drawn by chance.  [default: {_CASES}]")
@click.option("--every", type=click.IntRange(1), default=None, metavar="DRAWS",
              help="Instead: every effect at ten detection limits, so many times each; on a bench, on a bench whose nominal "
              "numbers hide it, and on a walking leg.")
@click.option("--truth", type=click.Choice(TRUTHS), default="own", show_default=True,
              help="own: effects one at a time or a few together; whole: whole machines of an independent truth, every real effect at "
              "once, with errors of the improved rigs on recordings that nobody has seen; cantera: the same, computed by Cantera.")
@click.option("--make", "makes", default=None, metavar="A,B",
              help="Makes of whole machines (X500-X509: drawn by number), or learn, report, all.  [default: report]")
@click.option("--cell", "hides", default=None, metavar="CELL,..",
              help="What whole machines hide: whole (five to eight effects), single, nothing, outside, or all of these in equal parts; "
              "a mix when absent.")
@click.option("--duration", type=options.Quantity("s", low=4.0, high=3600.0), default="24 s", show_default=True,
              help="Length of a recording.")
@click.option("--key", type=click.Path(path_type=Path, dir_okay=False), default=None,
              help="Where the key goes that opens the seals, once; OUT.key when absent. Keep it from who diagnoses.")
@_JOBS
def make(cases: int | None, every: int | None, truth: str, makes: str | None, hides: str | None, duration: float, key: Path | None,
         jobs: int, out: Path | None, as_json: bool, quiet: bool, seed: int) -> None:  # fmt: skip
    """Draw cases as users would have them, with their truth sealed."""
    from exo_sim.trials import case_mix, protocol
    from exo_sim.trials.seal import digest_of

    if cases is not None and every is not None:
        raise TrialError("--cases and --every exclude each other: cases are drawn by chance, or every effect is")
    if truth == "own" and (makes, hides) != (None, None):
        raise TrialError(f"{'--cell' if makes is None else '--make'} is for whole machines; say --truth whole too, or leave it out")
    if truth != "own" and every is not None:
        raise TrialError("--every is for --truth own; whole machines are drawn with --cases")
    folder = out or Path("trial")
    key = key or folder.with_name(folder.name + ".key")
    if truth == "own":
        plans = case_mix.draw_plans(cases or _CASES, seed) if every is None else case_mix.every_plan(every, seed)
        manifest = protocol.make(folder, plans, key, duration, jobs, quiet=quiet)
    else:
        from exo_sim.trials import sealed_machines as sealed

        machines = sealed.plans_of(truth, cases or _CASES, seed, makes, hides)
        manifest = protocol.make(folder, machines, key, duration, jobs, "csv", quiet, truth, sealed.make_one)
    note = digest_of(folder / protocol.MANIFEST)
    printing.show(
        {"schema": "exo-sim/trial/1", "folder": folder, "cases": manifest["count"], "key": key, "manifest": note},
        f"{manifest['count']} cases in {folder}, sealed; the key is {key}\nmanifest {note}: note it",
        as_json=as_json,
    )


@verb("exo-sim trial run trial", name="run", out="File for the summary; verdicts go into FOLDER.")
@_FOLDER
@click.option("--tool", default=None, help="Command to diagnose with; exo-sim diagnose when absent.")
@click.option("--timeout", type=options.Quantity("s", low=1.0), default="600 s", show_default=True, help="Longest time for one case.")
@click.option("--scheduler", default=None, help="Address of a Dask scheduler to spread the cases over.")
@_JOBS
def run(folder: Path, tool: str | None, timeout: float, scheduler: str | None, jobs: int, out: Path | None,
        as_json: bool, quiet: bool) -> None:  # fmt: skip
    """Diagnose the cases of FOLDER blind and sign the verdicts; goes on where it was interrupted."""
    from exo_sim.trials import protocol

    try:
        done = protocol.run(folder, tool or protocol.OWN_TOOL, jobs, scheduler, timeout, quiet)
    except KeyboardInterrupt:
        kept = len(protocol.ledger_of(folder).records())
        raise KeyboardInterrupt(f"{kept} verdicts are kept; the same command goes on from there") from None
    printing.show(
        {"schema": "exo-sim/trial/1", "folder": folder, **done},
        f"{done['verdicts']} verdicts, {done['new']} of them new; last verdict {done['head']}: note it",
        as_json=as_json,
        out=out,
    )


@verb(
    "exo-sim trial score trial --key trial.key",
    name="score",
    out="File for the table; score.json and score.html go into FOLDER.",
)
@_FOLDER
@click.option("--key", type=click.Path(path_type=Path, dir_okay=False), default=None,
              help="Key of the seals; FOLDER.key when absent.")
@click.option("--head", default=None, help="Last verdict as trial run printed it, to be held against the ledger.")
@click.option("--oracle", is_flag=True, help="Diagnose once more with the truth in the rig, and compare held-out errors.")
@_JOBS
def score(folder: Path, key: Path | None, head: str | None, oracle: bool, jobs: int, out: Path | None, as_json: bool,
          quiet: bool) -> None:  # fmt: skip
    """Open the seals of FOLDER, check them and count."""
    from exo_sim.trials.protocol import read_manifest
    from exo_sim.trials.score import score as open_and_count
    from exo_sim.trials.score_page import named_from, percent
    from exo_sim.trials.score_words import shares

    key = key or folder.with_name(folder.name + ".key")
    if read_manifest(folder).get("truth", "own") != "own":
        _score_whole(folder, key, head, oracle, jobs, out, as_json, quiet)
        return
    result = open_and_count(folder, key, head, oracle, jobs, quiet)
    figures = result["figures"]
    rows = [
        (words, percent(one["share"]), f"{percent(one['low'])} to {percent(one['high'])}", one["of"]) for words, one in shares(figures)
    ]
    text = printing.table(rows, ("what is counted", "share", "95 % bounds", "of"))
    text += f"\nsize from which nine of ten are named, in detection limits: {named_from(figures)}; page: {folder / 'score.html'}"
    printing.show(
        {"schema": result["schema"], "figures": figures, "head": result["head"]}, text, as_json=as_json, out=out
    )


def _score_whole(folder: Path, key: Path, head: str | None, oracle: bool, jobs: int, out: Path | None, as_json: bool, quiet: bool) -> None:
    """Open the seals of whole machines: their tables, and how the improved rigs do on recordings that nobody has seen."""
    from exo_sim.trials import sealed_machines as sealed

    if oracle:
        raise TrialError("--oracle is for --truth own: the rigs of whole machines are held against fresh recordings without it")
    result = sealed.score(folder, key, head, jobs, quiet=quiet)
    printing.show(
        {name: result[name] for name in ("schema", "truth", "figures", "head")}, f"{result['text']}\n\ntables: {folder / 'score.md'}",
        as_json=as_json, out=out,
    )  # fmt: skip


command.add_command(make)
command.add_command(run)
command.add_command(score)
