"""The discrepancy of a fitted model as a signal: the force or flow that is missing, and on which variable it depends."""

from __future__ import annotations

from dataclasses import dataclass

from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.policy.verdicts import LEAST_CURVE


@dataclass(frozen=True)
class Discrepancy:
    """What a subsystem's model misses.

    Attributes:
        acts: "force", "friction" (against the motion), "flow", "flow_1" or "flow_2".
        unit: Of what is missing.
        place: Which balance it is missing in, in words.
        curves: Against each variable, the one that predicts most first; variables of the simulator and others (command, time).
        size: Root mean square of what is missing.
        bursts: Whether it comes in bursts too fast for the rows of the fit.
        otherwise: Largest share of its variance that the first curve's variable predicts of it as a friction where it acts as a force, and
            as a force where it acts as a friction; None where only one of the two was asked.
    """

    acts: str
    unit: str
    place: str
    curves: tuple[Curve, ...]
    size: float
    bursts: bool = False
    otherwise: float | None = None

    @property
    def best(self) -> Curve | None:
        """The curve that predicts most, if any predicts enough."""
        return self.curves[0] if self.curves and self.curves[0].explains > LEAST_CURVE else None

    @property
    def pattern(self) -> float:
        """Largest share of the variance that one variable predicts."""
        return self.curves[0].explains if self.curves else 0.0
