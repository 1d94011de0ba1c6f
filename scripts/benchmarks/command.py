"""Runs of the command line in a process of their own."""

from __future__ import annotations

import os
import subprocess
import sys
import time

#: Runs the verb, then says what this process held at most; its parent's memory does not count.
WATCHED = """
import resource, sys
from exo_sim.cli import main
status = main(sys.argv[1:])
try:
    lines = open("/proc/self/status").read().splitlines()
    peak = 1024 * int(next(line for line in lines if line.startswith("VmHWM")).split()[1])
except OSError:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
print("peak", peak, file=sys.stderr, flush=True)
sys.exit(status)
"""


def one_core() -> None:
    """Keep this process on one core."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])


def seconds(words: list[str], **environment: str) -> tuple[float, str]:
    """Run the command on one core; return how long it took and what it printed."""
    begun = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "exo_sim", *words],
        check=True, capture_output=True, text=True, preexec_fn=one_core, env={**os.environ, **environment},
    )  # fmt: skip
    return time.perf_counter() - begun, done.stdout


def seconds_and_peak(words: list[str], fine: tuple[int, ...] = (0,)) -> tuple[float, int]:
    """Run the command on every core; return how long it took and its largest resident memory in bytes.

    Raises:
        RuntimeError: it ended with a status that is not among the fine ones; the message is its first line.
    """
    begun = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", WATCHED, *words], capture_output=True, text=True)
    taken = time.perf_counter() - begun
    said = done.stderr.splitlines() or ["nothing was said"]
    peaks = [int(line.split()[1]) for line in said if line.startswith("peak ")]
    if done.returncode not in fine or not peaks:
        raise RuntimeError(f"exo-sim {' '.join(words)} ended with {done.returncode}: {said[0]}")
    return taken, peaks[-1]
