"""What is printed when a verb does not end well: one line on stderr, and the exit status."""

from __future__ import annotations

import errno
import traceback

import click
from click.exceptions import Exit

from exo_sim.cli.streams import say
from exo_sim.errors import ExoSimError, nearest, one_line

INTERRUPTED = 130
BROKEN_PIPE = 141  # as a process that SIGPIPE ends
OUR_FAULT = 70  # EX_SOFTWARE of sysexits.h


def report(error: BaseException, debug: bool = False, interrupted: bool = False) -> int:
    """Print what went wrong as one line on stderr and return the exit status.

    Args:
        error: What ended the verb. An interrupt may carry a sentence on what was kept.
        debug: Show the traceback first.
        interrupted: Ctrl-C came before it: what would be a fault of ours is then what a library made of that.
    """
    if isinstance(error, Exit):
        return error.exit_code
    if isinstance(error, SystemExit):
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    if isinstance(error, click.exceptions.NoArgsIsHelpError):
        say(error.format_message())
        return 2
    if isinstance(error, BrokenPipeError):
        return BROKEN_PIPE
    if debug and not isinstance(error, click.ClickException):
        say("".join(traceback.format_exception(error)).rstrip("\n"))
    line, status = _line_and_status(error)
    if interrupted and status == OUR_FAULT:
        line, status = _line_and_status(KeyboardInterrupt())
    say(f"exo-sim: {one_line(line)}")
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
    if isinstance(error, ModuleNotFoundError) and error.name and error.name.split(".")[0] != "exo_sim":
        return f"the package {error.name} is not installed; install exo-sim again with all that it needs (exo-sim doctor lists it)", 2
    if isinstance(error, MemoryError):
        return "out of memory; ask for fewer strides, trials or jobs at once", 2
    if type(error).__module__.startswith("numba") and (own := _own_effects()):
        said = next((line for line in str(error).splitlines() if line.strip() and not line.startswith("Failed in")), "")
        return f"no machine code can be made with effects of your own ({own}): {said}; write them with what numba knows", 2
    detail = f"{type(error).__name__}: {error}".rstrip(": ")
    return f"{detail} (a fault of exo-sim, not of your input; --debug shows where)", OUR_FAULT


def _own_effects() -> str:
    from exo_sim.physics import external_effects

    return ", ".join(source.label for source in external_effects.sources())


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

