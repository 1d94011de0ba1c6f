"""Cases to diagnoses to a table: several at a time, going on where it was interrupted."""

from __future__ import annotations

import json
import shlex
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from exo_sim.errors import TrialError
from exo_sim.outputs import replacing
from exo_sim.progress import each
from exo_sim.trials.answer import read_answer
from exo_sim.trials.resource_use import used_by
from exo_sim.trials.tool import bring_back, command, environment, lay_out
from exo_sim.trials.whole_machines import unseen_recording
from exo_sim.trials.whole_machines.judge import MATTERS, Mark, judge

DIAGNOSE = f"{shlex.quote(sys.executable)} -m exo_sim diagnose --quiet"
COMPARE = f"{shlex.quote(sys.executable)} -m exo_sim compare"


def cases(folder: Path) -> list[Path]:
    """Return the folders of the cases in a folder, sorted.

    Raises:
        TrialError: there is none.
    """
    found = sorted(path.parent.parent for path in folder.glob("*/truth/truth.json"))
    if not found:
        make = f"python -m exo_sim.trials.whole_machines make --out {folder}"
        raise TrialError(f"{folder} holds no case of a whole machine; make some with {make}")
    return found


def spread(work: Callable[[Any], Any], items: Sequence[Any], jobs: int, words: str, quiet: bool, threads: bool = True) -> list[Any]:
    """Do the same with every item, some at a time; return the results in order."""
    if jobs == 1:
        return list(each(map(work, items), words, total=len(items), unit="case", quiet=quiet))
    from joblib import Parallel, delayed

    results = Parallel(n_jobs=jobs, return_as="generator", prefer="threads" if threads else None)(delayed(work)(item) for item in items)
    return list(each(results, words, total=len(items), unit="case", quiet=quiet))


def run(folder: Path, out: Path, tool: str = DIAGNOSE, compare: str = COMPARE, jobs: int = 1, timeout: float = 900.0,
        prove: bool = True, only: str = "*", quiet: bool = False) -> int:  # fmt: skip
    """Diagnose every case that has no answer yet; return how many were.

    Args:
        folder: Cases.
        out: Where answers go: OUT/CASE/diagnosis.json, improved.toml, spent.json, fresh.json.
        tool, compare: Command lines.
        jobs: Cases at a time.
        timeout: Processor seconds that a case may take.
        prove: Whether rigs are held against the fresh recordings too.
        only: Pattern of the cases' names.
        quiet: No progress.
    """
    todo = [case for case in cases(folder) if case.match(only) and not _done(out / case.name, prove)]

    def one(case: Path) -> None:
        answer = out / case.name
        answer.mkdir(parents=True, exist_ok=True)
        if not (answer / "spent.json").exists():
            spent = _diagnose(case, answer, tool, timeout)
            _write(answer / "spent.json", spent)
        if prove and not (answer / "fresh.json").exists():
            before = case / "truth" / "rigs.json"
            known = json.loads(before.read_text()) if before.exists() else None
            errors = unseen_recording.errors(shlex.split(compare), case, answer / "improved.toml", known)
            if known is None and errors["before"] and errors["nearest"]:
                _write(before, {key: errors[key] for key in ("before", "nearest")})
            _write(answer / "fresh.json", errors)

    spread(one, todo, jobs, "diagnosing", quiet)
    return len(todo)


def _done(answer: Path, prove: bool) -> bool:
    return (answer / "spent.json").exists() and (not prove or (answer / "fresh.json").exists())


def _diagnose(case: Path, answer: Path, tool: str, timeout: float) -> dict[str, Any]:
    files = [path.name for path in case.iterdir() if path.is_file()]
    with tempfile.TemporaryDirectory(prefix="whole_") as bare:
        line = command(tool, lay_out(case, files, Path(bare)))
        start = time.monotonic()
        status, words, used = used_by(line, Path(bare), environment(), timeout)
        if (Path(bare) / "out" / "diagnosis.json").exists():
            bring_back(Path(bare) / "out", answer, case)
    return {
        "status": status,
        "words": words,
        "wall_s": round(time.monotonic() - start, 2),
        "cpu_s": round(used.ru_utime + used.ru_stime, 2),
        "peak_bytes": used.ru_maxrss * 1024,
    }


def marks(folder: Path, out: Path, matters: float = MATTERS) -> list[Mark]:
    """Return the marks of all cases that were answered."""
    found = []
    for case in cases(folder):
        answer = out / case.name
        if not (answer / "spent.json").exists():
            continue
        diagnosis = read_answer(answer / "diagnosis.json")
        spent = _read(answer / "spent.json") or {}
        truth = json.loads((case / "truth" / "truth.json").read_text())
        found.append(judge(truth, diagnosis, _read(answer / "fresh.json"), spent.get("cpu_s"), matters))
    return found


def write_marks(found: Iterable[Mark], path: Path) -> None:
    """Write marks as JSON."""
    _write(path, [asdict(mark) for mark in found])


def _read(path: Path) -> dict[str, Any] | None:
    try:
        answer = json.loads(path.read_text())
    except (FileNotFoundError, ValueError):
        return None
    return answer if isinstance(answer, dict) else None


def _write(path: Path, content: object) -> None:
    with replacing(path) as beside:
        beside.write_text(json.dumps(content, indent=1) + "\n")
