"""A command run in a process that is forked from one where the imports are done: starting takes no time, so that kills meet the work."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import time
from dataclasses import dataclass
from multiprocessing.synchronize import Event
from pathlib import Path

_SERVER = multiprocessing.get_context("forkserver")
_SERVER.set_forkserver_preload(["exo_sim.cli", "mujoco", "numba", "scipy.optimize", "pyarrow.parquet"])


@dataclass(frozen=True)
class Ended:
    """How it ended.

    Attributes:
        status: Exit status; below 0 the signal that ended it.
        err: What it said on stderr.
        seconds: How long it took.
    """

    status: int
    err: str
    seconds: float


def _work(words: tuple[str, ...], folder: str, said: str, begun: Event) -> None:
    os.setsid()
    os.chdir(folder)
    out = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(out, 1)
    os.dup2(out, 2)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    from exo_sim.cli import main

    begun.set()
    try:
        status = main(list(words))
        sys.stdout.flush()
    except KeyboardInterrupt:  # before or behind the command's own handlers, where the interpreter itself would end
        os._exit(130)
    os._exit(status)


def run(words: tuple[str, ...], folder: Path, said: Path, ended_after: float | None = None, by: int = signal.SIGKILL) -> Ended:
    """Run a command in a folder; end it, and all that it started, some seconds after it began its work where these are given."""
    ready = _SERVER.Event()
    process = _SERVER.Process(target=_work, args=(words, str(folder), str(said), ready))
    process.start()
    assert process.pid is not None
    ready.wait(60.0)
    begun = time.monotonic()
    process.join(ended_after)
    if process.exitcode is None and ended_after is not None:
        try:
            os.killpg(process.pid, by)
        except ProcessLookupError:
            os.kill(process.pid, by)  # before it had a group of its own
        process.join(300.0)
    if process.exitcode is None:
        os.killpg(process.pid, signal.SIGKILL)
        process.join()
    assert process.exitcode is not None
    return Ended(process.exitcode, said.read_text(errors="replace") if said.exists() else "", time.monotonic() - begun)
