"""The command run on a case, within this process and within a time."""

from __future__ import annotations

import io
import os
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

#: Seconds of work, and of all time, after which the command is interrupted, as a person would.
PATIENCE, LONGEST = 60.0, 400.0


@dataclass
class Outcome:
    """How it went.

    Attributes:
        status: Exit status; None where something other than a status came out.
        out, err: What it printed.
        below: What libraries wrote on the streams themselves, past Python.
        escaped: What came out in place of a status.
        interrupted: It was still at work after `PATIENCE`, or not done after `LONGEST`.
        seconds: How long it took.
        grown: Bytes by which the largest resident memory of this process grew.
        files: What lay in the folder afterwards: bytes by relative name, None for what is no regular file.
        before: The same before.
    """

    status: int | None = None
    out: str = ""
    err: str = ""
    below: str = ""
    escaped: str = ""
    interrupted: bool = False
    seconds: float = 0.0
    grown: int = 0
    files: dict[str, bytes | None] = field(default_factory=dict)
    before: dict[str, bytes | None] = field(default_factory=dict)


def run(words: tuple[str, ...], folder: Path, verb: Callable[[list[str]], int]) -> Outcome:
    """Run the command in a folder and return how it went."""
    outcome = Outcome(before=_files(folder))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    printed = io.TextIOWrapper(io.BytesIO(), "utf-8", newline="\n"), io.TextIOWrapper(io.BytesIO(), "utf-8", newline="\n")
    streams, home = (sys.stdout, sys.stderr), Path.cwd()

    def interrupt(number: int, frame: FrameType | None) -> None:
        outcome.interrupted = True
        signal.raise_signal(signal.SIGINT)

    former = [(number, signal.signal(number, interrupt)) for number in (signal.SIGALRM, signal.SIGPROF)]
    former.append((signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler)))
    os.chdir(folder)
    begun = time.monotonic()
    with _streams_themselves(folder.with_name(f"{folder.name}.below")) as below:
        sys.stdout, sys.stderr = printed
        try:
            signal.setitimer(signal.ITIMER_PROF, PATIENCE)
            signal.setitimer(signal.ITIMER_REAL, LONGEST)
            outcome.status = verb(list(words))
        except BaseException as error:
            outcome.escaped = f"{type(error).__name__}: {error}"
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            sys.stdout, sys.stderr = streams
    outcome.seconds = time.monotonic() - begun
    for number, handler in former:
        signal.signal(number, handler)
    os.chdir(home)
    outcome.below = below[0]
    texts = []
    for stream in printed:
        stream.flush()
        texts.append(stream.buffer.getvalue().decode("utf-8", "replace"))  # type: ignore[attr-defined]
    outcome.out, outcome.err = texts
    outcome.grown = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak)
    outcome.files = _files(folder)
    return outcome


@contextmanager
def _streams_themselves(kept: Path) -> Iterator[list[str]]:
    """Catch what is written on file descriptors 1 and 2 meanwhile; it stands in the list afterwards."""
    said: list[str] = []
    saved = os.dup(1), os.dup(2)
    file = os.open(kept, os.O_RDWR | os.O_CREAT | os.O_TRUNC)
    try:
        os.dup2(file, 1)
        os.dup2(file, 2)
        yield said
    finally:
        os.dup2(saved[0], 1)
        os.dup2(saved[1], 2)
        said.append(os.pread(file, 2000, 0).decode("utf-8", "replace"))
        for number in (*saved, file):
            os.close(number)
        kept.unlink()


def _files(folder: Path) -> dict[str, bytes | None]:
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() and not path.is_symlink() else None
        for path in sorted(folder.rglob("*"))
    }
