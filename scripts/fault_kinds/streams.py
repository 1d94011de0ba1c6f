"""Standard streams as a shell may hand them over: closed, full, or with nobody at the other end."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from fault_kinds.outcome import Outcome

_WORDS = {
    "help": ("--help",), "effects": ("effects",), "effects --json": ("effects", "--json"), "scenarios": ("scenarios",),
    "inspect": ("inspect", "bench.csv"), "inspect --rig": ("inspect", "bench.csv", "--rig", "bench.toml", "--json"),
    "a failure": ("inspect", "nothing.csv"),
}  # fmt: skip
#: What is done to the streams, and the exit statuses that are right where the command would end well and where it would fail.
_FAULTS = {
    ">/dev/full": ((2,), (2,)), ">&-": ((2,), (2,)), "2>/dev/full": ((0,), (2,)), "2>&-": ((0,), (2,)), "<&-": ((0,), (2,)),
    "<&- >&- 2>&-": ((2,), (2,)), ">/dev/full 2>/dev/full": ((2,), (2,)), "| true": ((0, 141), (2,)), "| head -c 10": ((0, 141), (2,)),
}  # fmt: skip


def break_streams(bases: Path, most: int) -> Outcome:
    """Run some commands under each fault; `most` commands."""
    outcome = Outcome("streams")
    for name, words in list(_WORDS.items())[-most:]:
        for fault, (well, ill) in _FAULTS.items():
            said = f'"{sys.executable}" -m exo_sim "$@" {fault}; exit ${{PIPESTATUS[0]}}'
            came = subprocess.run(["bash", "-c", said, "bash", *words], cwd=bases / "bench", capture_output=True, text=True)
            outcome.count(fault)
            if came.returncode not in (ill if name == "a failure" else well):
                outcome.broken.append(f"{name} {fault}: ended with {came.returncode}: {came.stderr[-300:]}")
            if "Traceback" in came.stderr or "Exception ignored" in came.stderr:
                outcome.broken.append(f"{name} {fault}: {came.stderr[-500:]}")
    return outcome
