"""Real machines laid out, diagnosed, held against what was held out, and marked; going on where it was interrupted."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from exo_sim.outputs import replacing
from exo_sim.recording import write_table
from exo_sim.trials.answer import read_answer
from exo_sim.trials.real.case import RealCase
from exo_sim.trials.real.errors import errors
from exo_sim.trials.real.honest import honest_errors
from exo_sim.trials.real.judge import Mark, judge
from exo_sim.trials.real.machines import real_case, rig_of
from exo_sim.trials.real.table import by_make, summary
from exo_sim.trials.resource_use import used_by
from exo_sim.trials.tool import bring_back, command, environment, lay_out
from exo_sim.trials.whole_machines.diagnose_cases import spread


def write_case(case: RealCase, repository: Path, folder: Path) -> None:
    """Write what the tool gets: rig.toml, its MJCF, and a recording_N.parquet for each recording."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in rig_of(case, repository).iterdir():
        if path.suffix in (".toml", ".xml"):
            shutil.copy(path, folder)
    for number, recording in enumerate(case.recordings, start=1):
        write_table(folder / f"recording_{number}.parquet", recording)


def run(names: Sequence[str], data: Path, repository: Path, out: Path, tool: str, compare: str, jobs: int = 1, timeout: float = 900.0,
        quiet: bool = False) -> list[Mark]:  # fmt: skip
    """Diagnose each case that has no answer yet, and mark all.

    Args:
        names: Of `machines.NAMES`.
        data: Folder of the recordings.
        repository: Checkout whose assets/real holds the rigs.
        out: OUT/CASE/case holds what the tool gets, OUT/CASE its answer.
        tool, compare: Command lines of `exo-sim diagnose` and `exo-sim compare`.
        jobs: Cases at a time.
        timeout: Processor seconds that a diagnosis may take.
        quiet: No progress.
    """

    def one(name: str) -> Mark:
        case = real_case(name, data)
        answer = out / name
        if not (answer / "spent.json").exists():
            write_case(case, repository, answer / "case")
            _write(answer / "spent.json", _diagnose(answer, tool, timeout))
        if not (answer / "errors.json").exists():
            _write(answer / "errors.json", _errors(case, answer, compare))
        return mark(case, answer)

    return spread(one, list(names), jobs, "diagnosing", quiet)


def mark(case: RealCase, answer: Path) -> Mark:
    """Return the mark of an answer in a folder."""
    found, spent = json.loads((answer / "errors.json").read_text()), json.loads((answer / "spent.json").read_text())
    diagnosis = read_answer(answer / "diagnosis.json")
    return judge(
        case.name,
        case.known,
        diagnosis,
        found["before"],
        found["after"],
        found["honest"],
        spent["cpu_s"],
        found["remarks"],
        case.variant_of,
        case.make,
    )


def _diagnose(answer: Path, tool: str, timeout: float) -> dict[str, Any]:
    files = [path.name for path in (answer / "case").iterdir()]
    with tempfile.TemporaryDirectory(prefix="real_") as bare:
        line = command(tool, lay_out(answer / "case", files, Path(bare)))
        status, words, used = used_by(line, Path(bare), environment(), timeout)
        if (Path(bare) / "out" / "diagnosis.json").exists():
            bring_back(Path(bare) / "out", answer, answer / "case")
    return {"status": status, "words": words, "cpu_s": round(used.ru_utime + used.ru_stime, 2), "peak_bytes": used.ru_maxrss * 1024}


def _errors(case: RealCase, answer: Path, compare: str) -> dict[str, Any]:
    rig, improved = answer / "case" / "rig.toml", answer / "improved.toml"
    before, _ = errors(case, rig, compare)
    after, remarks = errors(case, improved, compare) if improved.exists() else (None, ("no improved.toml was written",))
    honest = honest_errors(case, rig)
    for signal, value in case.known.published.items():
        honest[signal] = min(value, honest.get(signal, value))
    return {"before": before, "after": after, "honest": honest, "remarks": remarks}


def plain(marks: Sequence[Mark]) -> dict[str, Any]:
    """Return marks, the summary of all and of each make of rig, as plain numbers and text."""
    return {
        "schema": "exo-sim/real-machines/1",
        "summary": summary(marks),
        "makes": {make: summary(those) for make, those in by_make(marks).items()},
        "marks": [asdict(mark) for mark in marks],
    }


def write(marks: Sequence[Mark], path: Path) -> None:
    """Write marks and their summaries as JSON."""
    _write(path, plain(marks))


def _write(path: Path, content: object) -> None:
    with replacing(path) as beside:
        beside.write_text(json.dumps(content, indent=1) + "\n")
