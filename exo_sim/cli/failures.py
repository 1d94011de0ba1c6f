"""What is printed when a verb does not end well: one line on stderr, and the exit status."""

from __future__ import annotations

import errno
import os
import sys
import traceback

import click
from click.exceptions import Exit

from exo_sim.errors import ExoSimError, nearest

INTERRUPTED = 130
BROKEN_PIPE = 141  # as a process that SIGPIPE ends
OUR_FAULT = 70  # EX_SOFTWARE of sysexits.h


def report(error: BaseException, debug: bool = False) -> int:
    """Print what went wrong as one line on stderr and return the exit status.

    Args:
        error: What ended the verb. An interrupt may carry a sentence on what was kept.
        debug: Show the traceback first.
    """
    if isinstance(error, Exit):
        return error.exit_code
    if isinstance(error, SystemExit):
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    if isinstance(error, click.exceptions.NoArgsIsHelpError):
        print(error.format_message(), file=sys.stderr)
        return 2
    if isinstance(error, BrokenPipeError):
        _silence_stdout()
        return BROKEN_PIPE
    if debug and not isinstance(error, click.ClickException):
        traceback.print_exception(error, file=sys.stderr)
    line, status = _line_and_status(error)
    print(f"exo-sim: {' '.join(line.split())}", file=sys.stderr)
    return status


def _line_and_status(error: BaseException) -> tuple[str, int]:
    if isinstance(error, click.UsageError):
        return _usage(error), 2
    if isinstance(error, click.ClickException):
        return error.format_message(), 2
    if isinstance(error, ExoSimError):
        return str(error), error.exit_status
    if isinstance(error, KeyboardInterrupt | EOFError | click.Abort):
        kept = f"; {error}" if str(error) else ""
        return f"interrupted{kept}", INTERRUPTED
    if isinstance(error, OSError):
        return _system(error), 2
    if isinstance(error, MemoryError):
        return "out of memory; ask for fewer strides, trials or jobs at once", 2
    detail = f"{type(error).__name__}: {error}".rstrip(": ")
    return f"{detail} (a fault of exo-sim, not of your input; --debug shows where)", OUR_FAULT


def _usage(error: click.UsageError) -> str:
    path = error.ctx.command_path if error.ctx is not None else "exo-sim"
    if isinstance(error, click.NoSuchOption):
        known = _options(error.ctx.command) if error.ctx else []
        message = f'no option "{error.option_name}"' + nearest(error.option_name, known)
    else:
        text = error.format_message().rstrip(".")
        message = text[:1].lower() + text[1:]
    return f"{message} ({path} --help)"


def _options(command: click.Command) -> list[str]:
    return [name for parameter in command.params for name in parameter.opts if name.startswith("--")]


def _system(error: OSError) -> str:
    name = f'"{error.filename}": ' if error.filename else ""
    if error.errno == errno.ENOSPC:
        return f"{name}the disk is full; free some space or write elsewhere with --out"
    if isinstance(error, FileNotFoundError):
        return f"{name}no such file or folder"
    return f"{name}{error.strerror or error}"


def _silence_stdout() -> None:
    """Keep the interpreter from flushing to a reader that has gone."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (OSError, ValueError):
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115
