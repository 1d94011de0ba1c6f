"""MuJoCo's own warnings, as Python's: each given once, and no MUJOCO_LOG.TXT in the working folder. Importing this does it."""

from __future__ import annotations

import re
import warnings

import mujoco

_NUMBER = re.compile(r"[-+]?\d[\d.]*(?:e[-+]?\d+)?")
_given: set[str] = set()


class MujocoWarning(UserWarning):
    """What MuJoCo warns of."""


def listen() -> None:
    """Let MuJoCo hand its warnings over to Python's `warnings`, whatever it is doing; they are never raised into it."""
    mujoco.set_mju_user_warning(_tell)


def _tell(message: str) -> None:
    line = " ".join(message.split())
    kind = _NUMBER.sub("#", line)  # the same at another time or place was given already
    if kind in _given:
        return
    _given.add(kind)
    try:
        warnings.warn(f"MuJoCo: {line}", MujocoWarning, stacklevel=2)
    except Warning:  # where warnings are errors: an exception may not pass through MuJoCo's own code
        return


listen()
