"""Whole machines, and those of Cantera, whose truth is sealed: cases as owners would hand them over, and the figures when it is opened.

With the truth of a case its fresh recording and the rig with the true names are sealed, so that nobody who diagnoses can learn from them.
"""

from __future__ import annotations

import json
import math
import shlex
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from exo_sim.errors import TrialError
from exo_sim.outputs import replacing
from exo_sim.trials.protocol import seal_case
from exo_sim.trials.score import open_trial
from exo_sim.trials.whole_machines import score_tables, unseen_recording
from exo_sim.trials.whole_machines.diagnose_cases import COMPARE, spread
from exo_sim.trials.whole_machines.draw import cells_of
from exo_sim.trials.whole_machines.judge import judge
from exo_sim.trials.whole_machines.makes import find, letters

#: The one make whose cases Cantera computes; see `exo_sim.trials.cantera`.
CANTERA = "cantera"
#: Share of the cases in each cell where none is asked for.
SHARES = {"whole": 0.6, "single": 0.15, "nothing": 0.15, "outside": 0.1}


@dataclass(frozen=True)
class WholePlan:
    """A case to be made: its name, make, cell and seed."""

    name: str
    make: str
    cell: str
    seed: int


def plans_of(truth: str, count: int, seed: int, makes: str | None, cells: str | None) -> tuple[WholePlan, ...]:
    """Return plans as words of a command line ask for them; see `draw_plans`.

    Raises:
        TrialError: there is no such make or cell, or Cantera is not there.
    """
    if truth != CANTERA:
        return draw_plans(count, seed, letters("report" if makes is None else makes), () if cells is None else cells_of(cells))
    from exo_sim.trials.cantera import case, network

    network.library()
    if makes is not None:
        raise TrialError("--make is for --truth whole: Cantera's machines are of one make")
    return draw_plans(count, seed, (CANTERA,), cells_of("all" if cells is None else cells, case.CELLS))


def draw_plans(count: int, seed: int, makes: Sequence[str], cells: Sequence[str] = ()) -> tuple[WholePlan, ...]:
    """Return plans: every make about equally often, cells by `SHARES` or, where some are named, about equally often.

    Args:
        count: How many, at least one.
        seed: The same seed gives the same plans.
        makes: Of `makes.MAKES`, or `CANTERA` alone.
        cells: Of `draw.CELLS`.
    """
    rng = np.random.default_rng([seed, 20264])
    shares = np.array([1.0] * len(cells) or list(SHARES.values()))
    wanted = np.floor(np.arange(1, count + 1)[:, None] * shares / shares.sum() + 0.5)
    names = tuple(cells) or tuple(SHARES)
    chosen: list[str] = []
    for row in wanted:  # the cell that lags furthest behind its share
        chosen.append(max(names, key=lambda name: row[names.index(name)] - chosen.count(name)))
    hides = rng.permutation(chosen)
    return tuple(
        WholePlan(f"case_{number:03d}", makes[int(i) % len(makes)], str(hides[i]), int(rng.integers(2**31)))
        for number, i in enumerate(rng.permutation(count))
    )


def make_one(plan: WholePlan, folder: Path, key: str, duration: float, fmt: str = "csv") -> tuple[str, dict[str, Any]]:
    """Write one case and its sealed truth; return its entry of the manifest.

    Args:
        plan: Which.
        folder: Of the trial.
        key: Seals.
        duration: Of a recording [s].
        fmt: "parquet" or "csv".
    """
    where = folder / "cases" / plan.name
    where.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="whole_") as bare:
        _write(plan, Path(bare), duration)
        hidden = Path(bare) / "truth"
        truth = json.loads((hidden / "truth.json").read_text())
        truth["files"] = {path.name: path.read_text() for path in sorted(hidden.iterdir()) if path.name != "truth.json"}
        written = [_copied(path, where, fmt) for path in sorted(Path(bare).iterdir()) if path.is_file()]
    return seal_case(plan.name, plan.cell, folder, written, truth, key)


def _write(plan: WholePlan, folder: Path, duration: float) -> None:
    if plan.make == CANTERA:
        from exo_sim.trials.cantera.case import make_case as make_cantera_case
        from exo_sim.trials.whole_machines.case import write_case

        write_case(make_cantera_case(plan.name, plan.cell, plan.seed, duration=duration), folder)
    elif find(plan.make).build == "legs":
        from exo_sim.trials.whole_machines.walk.case import make_worn_case, write_worn_case

        write_worn_case(make_worn_case(plan.name, plan.make, plan.cell, plan.seed, duration=duration), folder)
    else:
        from exo_sim.trials.whole_machines.case import make_case, write_case

        write_case(make_case(plan.name, plan.make, plan.cell, plan.seed, duration=duration), folder)


def _copied(path: Path, where: Path, fmt: str) -> Path:
    if path.suffix != ".csv" or fmt == "csv":
        return Path(shutil.copy(path, where))
    from exo_sim.recording import read, write_table

    there = where / f"{path.stem}.{fmt}"
    write_table(there, read(path).recording)
    return there


def score(
    folder: Path, key_file: Path, head: str | None = None, jobs: int = 1, compare: str = COMPARE, quiet: bool = False
) -> dict[str, Any]:
    """Open a finished trial of whole machines and count; write score.json and score.md into its folder.

    The improved rigs are held against the fresh recordings now; where that was interrupted it goes on.

    Args:
        folder: The trial.
        key_file: What opens its seals.
        head: The last verdict's hash as `trial run` printed it; checked where given.
        jobs: Rigs at a time.
        compare: Command line that holds a rig against a recording.
        quiet: No progress.

    Raises:
        TrialError: as in `exo_sim.trials.score.score`.
    """
    opened = open_trial(folder, key_file, head)
    spent = {record["case"]: record["cpu_s"] for record in opened.records}

    def errors(name: str) -> dict[str, Any]:
        there = folder / "opened" / name
        done = there / "errors.json"
        if not done.exists():
            _lay_open(folder / "cases" / name, opened.truths[name], there)
            found = unseen_recording.errors(shlex.split(compare), there, folder / "run" / name / "improved.toml")
            with replacing(done) as beside:
                beside.write_text(json.dumps(found, indent=1) + "\n")
        return dict(json.loads(done.read_text()))

    names = list(opened.truths)
    proved = dict(zip(names, spread(errors, names, jobs, "holding rigs against fresh recordings", quiet)))
    marks = [judge(opened.truths[name], opened.diagnoses[name], proved[name], spent[name]) for name in names]
    result = {
        "schema": "exo-sim/whole-score/1",
        "truth": opened.manifest["truth"],
        "figures": score_tables.plain(marks),
        "head": opened.records[-1]["hash"],
        "tool": opened.records[-1]["tool"],
        "marks": [_plain(asdict(mark)) for mark in marks],
    }
    text = score_tables.tables(marks)
    for file, content in (("score.json", json.dumps(result, indent=1, allow_nan=False)), ("score.md", text)):
        with replacing(folder / file) as beside:
            beside.write_text(content + "\n")
    return result | {"text": text}


def _lay_open(case: Path, truth: Mapping[str, Any], there: Path) -> None:
    """Write what was sealed of a case beside copies of its rig and model."""
    (there / "truth").mkdir(parents=True, exist_ok=True)
    for path in case.iterdir():
        if not path.name.startswith("recording"):
            shutil.copy(path, there)
    for file, text in {**truth["files"], "truth.json": json.dumps({k: v for k, v in truth.items() if k != "files"}, indent=1)}.items():
        with replacing(there / "truth" / file) as beside:
            beside.write_text(text)


def _plain(value: Any) -> Any:
    """Return a value without infinities, which JSON does not have: None stands for a rig that left all bounds."""
    if isinstance(value, dict):
        return {key: _plain(inside) for key, inside in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inside) for inside in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
