"""Standard streams as a shell may hand them over: closed, full, or unable to hold every character."""

from __future__ import annotations

import errno
import os
import sys
from typing import TextIO

from exo_sim.errors import OutputError, printable


def prepare() -> None:
    """Make stdin, stdout and stderr fit to be used; call it first.

    A stream that is closed becomes the null device, so that no file that is opened later takes its number. Characters that a
    stream cannot hold, such as the bytes of a file name that is not UTF-8, are written as escapes.

    Raises:
        OutputError: stdout is closed.
    """
    closed = [number for number in (0, 1, 2) if not _is_open(number)]
    for number in closed:  # the lowest free number is taken first
        null = os.open(os.devnull, os.O_RDWR)
        if null != number:
            os.dup2(null, number)
            os.close(null)
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115
        raise OutputError("stdout is closed, so no result can be shown; send it to a file, or to /dev/null")
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def say(text: str) -> None:
    """Print a line for people on stderr; where nobody can read it, go on without."""
    try:
        print(printable(text), file=sys.stderr, flush=True)
    except OSError:
        _silence(sys.stderr)
    except ValueError:  # somebody's own code closed it
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115


def flush() -> None:
    """Hand everything printed over to its reader.

    Raises:
        BrokenPipeError: the reader has gone.
        OutputError: it cannot be written.
    """
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        if error.errno == errno.ENOSPC:
            raise
        raise OutputError(f"cannot write to stdout: {error.strerror or error}; send it elsewhere") from error


def leave() -> None:
    """See to it that nothing is left which the interpreter would fail to write when it ends, with a status of its own."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            _silence(stream)


def holds_unicode(stream: TextIO) -> bool:
    """Return whether a stream takes every character as it is."""
    return (getattr(stream, "encoding", None) or "").lower().replace("-", "") in ("utf8", "")


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True


def _silence(stream: TextIO) -> None:
    """Send what a stream still holds, and all that follows, to the null device."""
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(null, stream.fileno())
    except (OSError, ValueError):
        pass
    finally:
        os.close(null)
