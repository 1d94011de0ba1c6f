"""Opening the seals: everything is checked first, then counted."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from exo_sim.errors import TrialError
from exo_sim.outputs import replacing
from exo_sim.trials.figures import figures
from exo_sim.trials.judge import judge
from exo_sim.trials.protocol import check_inputs, ledger_of, read_manifest
from exo_sim.trials.seal import digest_of, open_with, unseal
from exo_sim.trials.told import over_told, told_diagnoses


def score(
    folder: Path, key_file: Path, head: str | None = None, told: bool = False, jobs: int = 1, quiet: bool = False
) -> dict[str, Any]:
    """Open a finished trial and count; write score.json and score.html into its folder.

    Args:
        folder: The trial.
        key_file: What opens its seals.
        head: The last verdict's hash as `trial run` printed it; checked where given.
        told: Also run the tool once more on each case that hides physics of the list, told what it is, and compare errors.
        jobs: Cases told at a time.
        quiet: No progress.

    Raises:
        TrialError: a case, a seal, a verdict or a diagnosis was altered, verdicts are missing, or the seals were opened
            before the last verdict.
    """
    manifest = read_manifest(folder)
    check_inputs(folder, manifest)
    ledger = ledger_of(folder)
    records = ledger.check(sorted(manifest["cases"]))
    if head is not None and records[-1]["hash"] != head:
        raise TrialError(f"{ledger.path}: the last verdict is not the one noted, {head[:12]}; the ledger was rewritten")
    diagnoses = {record["case"]: _diagnosis(folder, record) for record in records}
    key = open_with(key_file, ledger.head(), len(records))
    marks, truths = [], {}
    for name in sorted(manifest["cases"]):
        stored = (folder / "sealed" / f"{name}.sealed").read_bytes()
        truth = unseal(stored, manifest["cases"][name]["commitment"], key, name)
        truths[name] = truth
        marks.append(judge(truth, diagnoses[name]))
    with replacing(folder / "opened.json") as beside:
        beside.write_text(json.dumps(truths, indent=1) + "\n")
    ratios: dict[str, float] = {}
    compared: dict[str, float | None] = {}
    if told:
        files = {name: list(entry["files"]) for name, entry in manifest["cases"].items()}
        answers = told_diagnoses(folder, files, truths, records[-1]["tool"], jobs, quiet)
        compared = {name: over_told(diagnoses[name], one) for name, one in answers.items()}
        ratios = {name: ratio for name, ratio in compared.items() if ratio is not None}
    result = {
        "schema": "exo-sim/score/1",
        "figures": figures(marks, records, ratios),
        "head": records[-1]["hash"],
        "tool": records[-1]["tool"],
        "marks": [asdict(mark) for mark in marks],
        "held_out_error_over_told": {"ratio": ratios, "told": len(compared)},
    }
    with replacing(folder / "score.json") as beside:
        beside.write_text(json.dumps(result, indent=1) + "\n")
    from exo_sim.trials.page import page

    with replacing(folder / "score.html") as beside:
        beside.write_text(page(result))
    return result


def _diagnosis(folder: Path, record: dict[str, Any]) -> dict[str, Any] | None:
    """Return the diagnosis that a verdict signed; None where the tool gave none or no JSON object."""
    path = folder / "run" / record["case"] / "diagnosis.json"
    if record["diagnosis"] is None:
        return None
    if not path.exists() or digest_of(path) != record["diagnosis"]:
        raise TrialError(f"{path}: not the diagnosis that was signed; it was altered after the verdict")
    try:
        answer = json.loads(path.read_text())
    except (json.JSONDecodeError, UnicodeDecodeError):
        return None
    return answer if isinstance(answer, dict) else None
