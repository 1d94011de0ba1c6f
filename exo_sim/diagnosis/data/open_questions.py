"""The questions that recordings may leave open."""

from __future__ import annotations

from exo_sim.diagnosis.findings import OpenQuestion

_GAS = ("gas and valve effects",)
_FORCES = ("friction, load and joint effects",)


def of_gas(cylinder: str, recording: str, why: str) -> OpenQuestion:
    """Return the question that the pressures of a cylinder would answer."""
    return OpenQuestion(f"the gas of {cylinder} in {recording}", _GAS, why)


def of_balance(joint: str, recording: str, why: str) -> OpenQuestion:
    """Return the question that a balance of forces would answer."""
    return OpenQuestion(f"the balance of forces at {joint} in {recording}", _FORCES, why)


def of_remainder(where: str) -> OpenQuestion:
    """Return the question what remains in a balance of forces one of whose pressures was not measured."""
    why = "it does not close, and one of its pressures was not recorded: the chamber may be at fault"
    return OpenQuestion(f"the rest of the balance of forces of {where}", _FORCES, why)
