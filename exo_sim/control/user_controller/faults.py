"""What somebody's own Python does wrong, as one line that names file and line."""

from __future__ import annotations

import traceback
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

from exo_sim.errors import ScenarioError

_OWN = Path(__file__).parents[2]


def is_interrupt(error: BaseException) -> bool:
    """Return whether it is Ctrl-C; all else that comes out of somebody's code, `SystemExit` too, is a fault of that code."""
    return isinstance(error, KeyboardInterrupt)


def place(error: BaseException, path: Path | None = None) -> str:
    """Return file, line and what went wrong there, in one line."""
    if isinstance(error, SyntaxError) and error.filename:
        return f"{error.filename}:{error.lineno}: {type(error).__name__}: {error.msg}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if not frame.filename.startswith("<")]
    outside = [frame for frame in frames if _OWN not in Path(frame.filename).parents and "site-packages" not in frame.filename]
    at = outside[-1] if outside else frames[-1] if frames and path is None else None
    where = f"{at.filename}:{at.lineno}" if at else str(path or "")
    return f"{where}: {described(error)}"


def described(error: BaseException) -> str:
    """Return kind and words of an exception; its kind alone where it cannot tell its words."""
    try:
        return f"{type(error).__name__}: {error}"
    except Exception:
        return type(error).__name__


def attribute(given: Any, name: str, default: Any = None) -> Any:
    """Return an attribute of somebody's object, or the default where it has none.

    Raises:
        ScenarioError: its code fails when it is asked; the message names file and line.
    """
    try:
        return getattr(given, name, default)
    except BaseException as error:
        if is_interrupt(error):
            raise
        raise ScenarioError(f'controller {place(error)}, when it was asked for "{name}"') from None


def shown(value: Any) -> str:
    """Return how an object shows itself; its type where it cannot."""
    try:
        return repr(value)
    except Exception:
        return f"a {type(value).__name__}"


def is_within(frame: FrameType | None, *codes: CodeType) -> bool:
    """Return whether a frame is called, however deep, from one of these functions."""
    while frame is not None and frame.f_code not in codes:
        frame = frame.f_back
    return frame is not None
