"""How rigs do on a recording of the same machine that nobody has seen: as handed in, as improved, and with the true names."""

from __future__ import annotations

import json
import math
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from exo_sim.trials.tool import environment

TIMEOUT = 600.0
_MEASURES = ("windowed_rms", "free_run_rms")


def compared(tool: list[str], recording: Path, rig: Path) -> dict[str, Any] | None:
    """Return what `compare` says of each signal, or None where it failed.

    Args:
        tool: Command line of `exo-sim compare`.
        recording, rig: Files.
    """
    with tempfile.TemporaryDirectory(prefix="fresh_") as bare:
        line = [*tool, str(recording.resolve()), "--rig", str(rig.resolve()), "--out", "fresh.rrd", "--json", "--quiet"]
        try:
            done = subprocess.run(
                line, cwd=bare, stdin=subprocess.DEVNULL, capture_output=True, text=True, env=environment(), check=False, timeout=TIMEOUT
            )
            return dict(json.loads(done.stdout)["signal"])
        except (subprocess.TimeoutExpired, ValueError, KeyError):
            return None


def errors(tool: list[str], case: Path, improved: Path, known: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return the errors of the three rigs on the fresh recording of a case, and their ratios.

    Args:
        tool: Command line of `exo-sim compare`.
        case: Folder of the case.
        improved: The rig that a diagnosis wrote; it may be missing.
        known: An earlier answer, of which the rigs that do not depend on the diagnosis are taken.
    """
    recording = case / "truth" / "fresh.csv"
    known = known or {}
    result: dict[str, Any] = {
        "before": known.get("before") or compared(tool, recording, case / "rig.toml"),
        "nearest": known.get("nearest") or compared(tool, recording, case / "truth" / "nearest.toml"),
        "after": compared(tool, recording, improved) if improved.exists() else None,
    }
    for measure in _MEASURES:
        result[f"{measure}_after_over_before"] = _ratio(result["after"], result["before"], measure)
        result[f"{measure}_after_over_nearest"] = _ratio(result["after"], result["nearest"], measure)
        result[f"{measure}_before_over_nearest"] = _ratio(result["before"], result["nearest"], measure)
    return result


def _ratio(top: Mapping[str, Any] | None, bottom: Mapping[str, Any] | None, measure: str) -> float | None:
    """Return the geometric mean over the signals of one error over another, neither taken below the noise."""
    if not top or not bottom:
        return None
    logs = []
    for signal, entry in top.items():
        if signal not in bottom:
            continue
        a, b, floor = entry.get(measure), bottom[signal].get(measure), entry.get("noise") or 0.0
        if not _number(b):
            continue
        if not _number(a):
            return math.inf  # left all bounds
        logs.append(math.log(max(a, floor, 1e-12) / max(b, floor, 1e-12)))
    return math.exp(sum(logs) / len(logs)) if logs else None


def _number(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)
