"""Commands that write files, and a look at whether what lies under a final name is whole."""

from __future__ import annotations

import json
import shutil
import tomllib
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Command:
    """One command.

    Attributes:
        name: What it is called here.
        base: Folder of inputs that it begins with, see `fuzzing.bases`.
        words: What stands behind `exo-sim`.
        outputs: What it writes, by name in the folder.
        same: Those of `outputs` whose bytes are the same each time.
        growing: Patterns of files that a kill leaves on purpose: what was done until then.
        statuses: Exit status where all went well.
    """

    name: str
    base: str
    words: tuple[str, ...]
    outputs: tuple[str, ...]
    same: tuple[str, ...] = ()
    growing: tuple[str, ...] = ()
    statuses: tuple[int, ...] = (0,)


_FOUND = ("found/diagnosis.json", "found/report.html", "found/improved.toml", "found/comparison.rrd")
COMMANDS = (
    Command("inspect", "bench", ("inspect", "bench.csv", "--json", "--out", "summary.json"), ("summary.json",), ("summary.json",)),
    Command("compare", "bench", ("compare", "bench.csv", "--rig", "bench.toml", "-q", "--out", "seen.rrd"), ("seen.rrd",)),
    Command(
        "diagnose", "bench", ("diagnose", "bench.csv", "--rig", "bench.toml", "-q", "--jobs", "1", "--out", "found"), _FOUND, _FOUND[:3],
        statuses=(0, 3, 4),
    ),
    Command(
        "run", "exo", ("run", "level_walk", "--rig", "exo.toml", "--strides", "6", "--assist", "vented", "-q", "--out", "walk.rrd"),
        ("walk.rrd", "walk.parquet"), ("walk.parquet",), ("*.unfinished-*.rrd",),
    ),
    Command(
        "size", "exo", ("size", "--rig", "exo.toml", "--trials", "10", "--jobs", "1", "-q", "--out", "sized"),
        ("sized/sized.toml", "sized/report.html", "sized/sized.rrd"), ("sized/sized.toml",), ("sized/*.journal", "sized/sized.parquet"),
    ),
    Command(
        "make", "bench", ("trial", "make", "--cases", "1", "--duration", "4 s", "--jobs", "1", "-q", "--out", "drawn"),
        ("drawn/manifest.json", "drawn.key"),
    ),
    Command(
        "wearer", "exo", ("run", "level_walk", "--rig", "exo.toml", "--wearer", "torques", "--strides", "2", "-q", "--out", "walk.rrd"),
        ("walk.rrd", "walk.parquet"), ("walk.parquet",), ("*.unfinished-*.rrd",),
    ),
    Command(
        "tank", "exo",
        ("size", "--rig", "exo.toml", "--valves", "independent", "--tank", "2 l", "--trials", "4", "--jobs", "1", "-q", "--out", "sized"),
        ("sized/sized.toml", "sized/report.html", "sized/sized.rrd"), ("sized/sized.toml",), ("sized/*.journal", "sized/sized.parquet"),
    ),
    Command(
        "whole", "bench",
        ("trial", "make", "--truth", "whole", "--make", "A", "--cell", "single", "--cases", "1", "--duration", "4 s", "--jobs", "1", "-q",
         "--out", "drawn"),
        ("drawn/manifest.json", "drawn.key"),
    ),
    Command("score", "trial", ("trial", "score", "trial", "--jobs", "1", "-q"), ("trial/score.json", "trial/score.html", "trial.key")),
)  # fmt: skip


def lay_out(command: Command, bases: Path, folder: Path) -> None:
    """Make the folder in which a command is run."""
    shutil.copytree(bases / command.base, folder, dirs_exist_ok=True)


def half_written(command: Command, folder: Path) -> list[str]:
    """Return which outputs lie under their names and are not whole."""
    out = []
    for name in command.outputs:
        path = folder / name
        if path.exists():
            try:
                _read(path)
            except Exception as error:
                out.append(f"{command.name}: {name} is not whole: {type(error).__name__}: {str(error)[:200]}")
    return out


def left_behind(command: Command, folder: Path, before: set[str]) -> list[str]:
    """Return what lies in a folder that is neither an input nor an output nor meant to stay."""
    known = set(command.outputs)
    return [
        str(path.relative_to(folder))
        for path in sorted(folder.rglob("*"))
        if path.is_file() and (name := str(path.relative_to(folder))) not in known and name not in before
        and not any(path.relative_to(folder).match(pattern) for pattern in command.growing)
    ]  # fmt: skip


def _read(path: Path) -> None:
    from exo_sim.recording import read

    if path.suffix in (".json", ".key"):
        json.loads(path.read_text())
    elif path.suffix == ".toml":
        tomllib.loads(path.read_text())
    elif path.suffix == ".html":
        if not path.read_text().rstrip().endswith("</html>"):
            raise ValueError("its end is missing")
    else:
        read(path)
