"""Opening the seals: everything is checked first, then counted."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from exo_sim.errors import TrialError
from exo_sim.outputs import replacing
from exo_sim.trials.answer import read_answer
from exo_sim.trials.judge import judge
from exo_sim.trials.oracle import oracle_diagnoses, over_oracle
from exo_sim.trials.protocol import check_inputs, ledger_of, read_manifest
from exo_sim.trials.score_statistics import figures
from exo_sim.trials.seal import digest_of, open_with, stored, unseal


@dataclass(frozen=True)
class Opened:
    """A finished trial whose seals are open.

    Attributes:
        manifest: What `make` wrote.
        records: The verdicts, in the order of the ledger.
        diagnoses: Each case's, as signed; None where there is none.
        truths: Each case's, in the order of their names.
    """

    manifest: dict[str, Any]
    records: list[dict[str, Any]]
    diagnoses: dict[str, dict[str, Any] | None]
    truths: dict[str, dict[str, Any]]


def open_trial(folder: Path, key_file: Path, head: str | None = None) -> Opened:
    """Check everything that was written and signed, and open the seals; arguments and errors as in `score`."""
    manifest = read_manifest(folder)
    check_inputs(folder, manifest)
    ledger = ledger_of(folder)
    records = ledger.check(sorted(manifest["cases"]))
    if head is not None and records[-1]["hash"] != head:
        raise TrialError(f"{ledger.path}: the last verdict is not the one noted, {head[:12]}; the ledger was rewritten")
    diagnoses = {record["case"]: _diagnosis(folder, record) for record in records}
    for record in records:
        _check_improved(folder, record)
    truths: dict[str, dict[str, Any]] = {}

    def try_on(key: str) -> None:
        for name in sorted(manifest["cases"]):
            sealed = stored(folder / "sealed" / f"{name}.sealed")
            truths[name] = unseal(sealed, manifest["cases"][name]["commitment"], key, name)

    open_with(key_file, manifest, ledger.head(), len(records), try_on)
    return Opened(manifest, records, diagnoses, truths)


def score(
    folder: Path, key_file: Path, head: str | None = None, oracle: bool = False, jobs: int = 1, quiet: bool = False
) -> dict[str, Any]:
    """Open a finished trial and count; write score.json and score.html into its folder.

    Args:
        folder: The trial.
        key_file: What opens its seals.
        head: The last verdict's hash as `trial run` printed it; checked where given.
        oracle: Also run the tool once more on each case that hides physics of the list, with the truth in its rig, and compare errors.
        jobs: Cases at a time.
        quiet: No progress.

    Raises:
        TrialError: a case, a seal, a verdict or a diagnosis was altered, verdicts are missing, or the seals were opened
            before the last verdict.
    """
    opened = open_trial(folder, key_file, head)
    manifest, records, diagnoses, truths = opened.manifest, opened.records, opened.diagnoses, opened.truths
    marks = [judge(truth, diagnoses[name]) for name, truth in truths.items()]
    with replacing(folder / "opened.json") as beside:
        beside.write_text(json.dumps(truths, indent=1) + "\n")
    ratios: dict[str, float] = {}
    compared: dict[str, float | None] = {}
    if oracle:
        files = {name: list(entry["files"]) for name, entry in manifest["cases"].items()}
        answers = oracle_diagnoses(folder, files, truths, records[-1]["tool"], jobs, quiet)
        compared = {name: over_oracle(diagnoses[name], one) for name, one in answers.items()}
        ratios = {name: ratio for name, ratio in compared.items() if ratio is not None}
    result = {
        "schema": "exo-sim/score/1",
        "figures": figures(marks, records, ratios),
        "head": records[-1]["hash"],
        "tool": records[-1]["tool"],
        "marks": [asdict(mark) for mark in marks],
        "held_out_error_over_oracle": {"ratio": ratios, "compared": len(compared)},
    }
    with replacing(folder / "score.json") as beside:
        beside.write_text(json.dumps(result, indent=1) + "\n")
    from exo_sim.trials.score_page import page

    with replacing(folder / "score.html") as beside:
        beside.write_text(page(result), encoding="utf-8")
    return result


def _check_improved(folder: Path, record: dict[str, Any]) -> None:
    """Check the improved rig that a verdict signed; verdicts of older trials name none."""
    path = folder / "run" / record["case"] / "improved.toml"
    if "improved" in record and record["improved"] != (digest_of(path) if path.exists() else None):
        raise TrialError(f"{path}: not the rig that was signed; it was altered after the verdict")


def _diagnosis(folder: Path, record: dict[str, Any]) -> dict[str, Any] | None:
    """Return the diagnosis that a verdict signed; None where the tool gave none, or none that is one."""
    path = folder / "run" / record["case"] / "diagnosis.json"
    if record["diagnosis"] is None:
        return None
    if not path.is_file() or digest_of(path) != record["diagnosis"]:
        raise TrialError(f"{path}: not the diagnosis that was signed; it was altered after the verdict")
    return read_answer(path)
