"""The held-out error of an oracle: the same tool, with a rig that has switched on what is hidden."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from exo_sim.progress import each
from exo_sim.trials.answer import read_answer
from exo_sim.trials.tool import STOPPED, command, lay_out, run_tool

#: Seconds that an oracle may take for a case.
TIMEOUT = 600.0


def oracle_rig(rig: str, hidden: Sequence[Mapping[str, Any]]) -> str:
    """Return the text of a rig to which hidden effects were added at their true values."""
    tables = []
    for entry in hidden:
        lines = [f"[effects.{entry['name']}.{entry['where'].split('.')[0]}]"]
        for name, given in entry["parameters"].items():
            if name == "sensor_at_valve":
                lines.append('sensor = "valve"')
                continue
            unit = "" if given["unit"] == "1" else f" {given['unit']}"
            lines.append(f'{name} = "{given["value"]!r}{unit}"' if unit else f"{name} = {given['value']!r}")
        tables.append("\n".join(lines))
    return "\n\n".join([rig.rstrip(), *tables]) + "\n"


def has_oracle(truth: Mapping[str, Any]) -> bool:
    """Return whether all that is hidden is physics that a rig file can have."""
    return bool(truth["hidden"]) and all(entry["kind"] == "missing_physics" for entry in truth["hidden"])


def oracle_diagnoses(
    folder: Path, files: Mapping[str, Sequence[str]], truths: Mapping[str, Mapping[str, Any]], tool: str, jobs: int = 1, quiet: bool = False
) -> dict[str, dict[str, Any]]:
    """Return, by case, the answer of an oracle: the tool with a rig that has what is hidden.

    Cases whose truth no rig file can hold are left out; a tool that does not answer within `TIMEOUT` gives an empty answer.

    Args:
        folder: The trial.
        files: Names of the files of each case.
        truths: What each case hides.
        tool: Command line; recordings, `--rig` and `--out` are appended.
        jobs: Cases at a time.
        quiet: No progress.
    """
    from joblib import Parallel, delayed

    names = [name for name, truth in truths.items() if has_oracle(truth)]
    results = Parallel(n_jobs=jobs, return_as="generator", prefer="threads")(
        delayed(_one)(folder / "cases" / name, files[name], truths[name], tool) for name in names
    )
    return dict(zip(names, each(results, "oracle", total=len(names), unit="case", quiet=quiet)))


def over_oracle(diagnosis: Mapping[str, Any] | None, oracle: Mapping[str, Any]) -> float | None:
    """Return by how much the worst signal's held-out error of a blind diagnosis is above that of an oracle.

    None where either gives no error, or where they kept different time for the proof.
    """
    blind, best = held_out_errors(diagnosis or {}), held_out_errors(oracle)
    if _kept(diagnosis or {}) != _kept(oracle):
        return None
    return max((blind[key] / best[key] for key in best if key in blind), default=None)


def _kept(diagnosis: Mapping[str, Any]) -> tuple[Any, Any]:
    fit = diagnosis.get("fit") or {}
    return fit.get("held_out"), fit.get("held_out_by_recording")


def held_out_errors(diagnosis: Mapping[str, Any]) -> dict[str, float]:
    """Return the held-out error of each signal of a diagnosis, as it is after."""
    signals = (diagnosis.get("fit") or {}).get("signal") or {}
    errors = {key: entry.get("after") for key, entry in signals.items() if isinstance(entry, Mapping)}
    return {key: float(error) for key, error in errors.items() if isinstance(error, int | float) and error > 0}


def _one(case: Path, files: Sequence[str], truth: Mapping[str, Any], tool: str) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="oracle_", ignore_cleanup_errors=True) as name:
        bare = Path(name)
        recordings = lay_out(case, files, bare)
        rig = bare / "rig.toml"
        rig.write_text(oracle_rig(rig.read_text(encoding="utf-8"), truth["hidden"]), encoding="utf-8")
        ran = run_tool(command(tool, recordings), bare, TIMEOUT)
        return (read_answer(bare / "out" / "diagnosis.json") if ran.status != STOPPED else None) or {}
