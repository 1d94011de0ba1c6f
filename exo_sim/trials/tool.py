"""How a case is handed to a tool: copies in a folder of their own, one command, one thread, and nothing that outlives its time."""

from __future__ import annotations

import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import time
from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from exo_sim.errors import TrialError, printable
from exo_sim.trials.json_file import MOST_BYTES

#: File in the bare folder that takes what a tool says, and how much of its end is kept.
WORDS = "words"
_LONGEST_WORDS = 500
#: Status of a tool that had to be stopped.
STOPPED = -1


@dataclass(frozen=True)
class Ran:
    """How a tool ended: its exit status or STOPPED, the end of what it said, and what it used."""

    status: int
    words: str
    wall_s: float
    cpu_s: float
    peak_bytes: int


def lay_out(case: Path, files: Collection[str], bare: Path) -> list[str]:
    """Copy a case's files into a bare folder; return the names of its recordings."""
    for file in files:
        shutil.copy(case / file, bare)
    return sorted(file for file in files if file.startswith("recording"))


def bring_back(answer: Path, out: Path, case: Path) -> bool:
    """Copy what a tool wrote; say whether there was an answer.

    The improved rig finds its MJCF beside the case, no longer in the bare folder. What is no regular file of a reasonable size is
    no answer.
    """
    if not _is_reasonable(answer / "diagnosis.json"):
        return False
    out.mkdir(parents=True, exist_ok=True)
    shutil.copy(answer / "diagnosis.json", out)
    improved = answer / "improved.toml"
    if _is_reasonable(improved):
        there = Path(os.path.relpath(case, out)).as_posix()
        text = improved.read_text(encoding="utf-8", errors="surrogateescape")
        text = re.sub(r'^(model\s*=\s*")\.\./', rf"\g<1>{there}/", text, flags=re.MULTILINE)
        (out / improved.name).write_text(text, encoding="utf-8", errors="surrogateescape")
    return True


def _is_reasonable(path: Path) -> bool:
    return path.is_file() and not path.is_symlink() and path.stat().st_size <= MOST_BYTES


def command(tool: str, recordings: Collection[str]) -> list[str]:
    """Return the command line that diagnoses what lies in the folder it is started in; its answer goes to `out`.

    Raises:
        TrialError: the tool is no command line.
    """
    try:
        words = shlex.split(tool)
    except ValueError as error:
        raise TrialError(f'cannot read the command "{tool}": {error}') from None
    if not words:
        raise TrialError("the tool is an empty command; name one with --tool, or leave --tool away")
    return [*words, *recordings, "--rig", "rig.toml", "--out", "out"]


def environment() -> dict[str, str]:
    """Return the environment of a tool: cases share the cores, so each takes one thread."""
    return {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


def run_tool(line: list[str], bare: Path, timeout: float) -> Ran:
    """Run a command in a bare folder; what it started and left running is ended with it.

    Raises:
        TrialError: it cannot be started.
    """
    with (bare / WORDS).open("w+b") as said:
        start = time.monotonic()
        try:
            process = subprocess.Popen(
                line, cwd=bare, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, env=environment(),
                start_new_session=True,
            )  # fmt: skip
        except (OSError, ValueError) as error:
            raise TrialError(f'cannot run "{line[0]}": {getattr(error, "strerror", None) or error}') from None
        try:
            status, used = wait(process, start + timeout)
        finally:
            end_group(process)
        words = end_of(said)
    wall = time.monotonic() - start
    return Ran(status, words, round(wall, 2), round(used.ru_utime + used.ru_stime, 2), used.ru_maxrss * 1024)


def wait(process: subprocess.Popen[bytes], deadline: float) -> tuple[int, resource.struct_rusage]:
    """Wait for a process; return its exit status or STOPPED and what it used."""
    stopped = False
    while True:
        pid, status, used = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return (STOPPED if stopped else process.returncode), used
        if time.monotonic() > deadline and not stopped:
            end_group(process)
            stopped = True
        time.sleep(0.02)


def end_of(said: IO[bytes]) -> str:
    """Return the end of what a tool said into a file, as text that can be shown."""
    said.seek(max(0, said.seek(0, os.SEEK_END) - 8 * _LONGEST_WORDS))
    return printable(said.read().decode(errors="replace")).strip()[-_LONGEST_WORDS:]


def end_group(process: subprocess.Popen[bytes]) -> None:
    """End a process and all that it started, unless they left its session."""
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    if process.returncode is None:
        with suppress(ProcessLookupError):
            os.kill(process.pid, signal.SIGKILL)  # Popen.kill may reap the process, and what it used would be lost
