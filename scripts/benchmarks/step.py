"""The coupled step against bare MuJoCo steps on the same path."""

from __future__ import annotations

from functools import cache

from benchmarks.figure import Asked, Figure, Said
from benchmarks.walking_machine import ROOT, STEPS, Machine, quickest
from exo_sim import rig


@cache
def seconds() -> tuple[dict[str, float], float]:
    """Return seconds for `STEPS` steps by way of stepping, and contacts a step."""
    machine = Machine(rig.read(ROOT / "assets" / "exo_250_psi.toml"))
    machine.record()
    taken = quickest({"bare": machine.bare, "python": machine.from_python, "compiled": machine.compiled})
    return taken, machine.contacts / STEPS


def bare_step_us() -> float:
    """Return microseconds of one bare step of the walking machine."""
    return 1e6 * seconds()[0]["bare"] / STEPS


def measure(asked: Asked) -> Said:
    """Measure the step."""
    taken, contacts = seconds()
    return [
        Figure("bare_step_us", "bare step", bare_step_us(), "{:.2f} us"),
        Figure("contacts", "contacts a step", contacts, "{:.1f}"),
        Figure("python_ratio", "step, from Python", taken["python"] / taken["bare"], "{:.2f} times bare"),
        Figure("compiled_ratio", "step, compiled loop", taken["compiled"] / taken["bare"], "{:.2f} times bare"),
    ]
