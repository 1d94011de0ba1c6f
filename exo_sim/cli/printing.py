"""What verbs print: data to stdout, words to stderr."""

from __future__ import annotations

import json
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from exo_sim.cli import streams
from exo_sim.errors import printable
from exo_sim.plain_text import json_text, table

__all__ = ["compiling", "json_text", "prints_on_stderr", "remark", "show", "table"]


def show(data: dict[str, Any], text: str, *, as_json: bool, out: Path | None = None) -> None:
    """Print a result once: as one JSON object or as text for people, to stdout or into the file `out`.

    Raises:
        OutputError: `out` cannot be written.
    """
    shown = json_text(data) if as_json else printable(text.rstrip("\n"))
    if out is None:
        print(shown if streams.holds_unicode(sys.stdout) else _in_ascii(shown))
        return
    from exo_sim.outputs import replacing

    with replacing(out) as beside:
        beside.write_text(shown + "\n", encoding="utf-8")


def prints_on_stderr() -> redirect_stdout[Any]:
    """Send what somebody's own code prints meanwhile to stderr: stdout is for the result."""
    return redirect_stdout(sys.stderr)


def remark(text: str, *, quiet: bool = False) -> None:
    """Print a line for a person, on stderr."""
    if not quiet:
        streams.say(text)


def compiling(seconds: float) -> str:
    """Return what a first run took to compile as words behind its time; "" where next to nothing was compiled."""
    return f", beside {seconds:.1f} s of compiling" if seconds >= 0.05 else ""


def _in_ascii(text: str) -> str:
    """Return text with escapes, which JSON reads back, for every other character than ASCII's."""
    return "".join(each if each.isascii() else json.dumps(each)[1:-1] for each in text)
