"""What a controller of one's own is: what it is given, what it must have, and how often it is asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from exo_sim.control.user_controller import faults
from exo_sim.errors import ScenarioError
from exo_sim.rig import Rig

#: Seconds between two calls of `act` where the controller does not tell.
PERIOD = 0.002


@dataclass(frozen=True)
class Context:
    """What a controller gets before the first step.

    Attributes:
        rig: The machine.
        cylinders: Their names, in the order of commands without names.
        joints: Joints whose torque can be asked for.
        signals: What the observation holds, beside "time".
        period: Seconds between two calls of `act`.
        step: Of the simulation [s].
        duration: Of the run [s].
        cycle: Of the scenario's motion [s]; None where there is none.
        scenario: Its name.
        payload: On the back [kg].
        seed: Where chance starts.
        reference: What each joint is to do at a time [s]: `reference(time)` gives joint to position and velocity.
    """

    rig: Rig
    cylinders: tuple[str, ...]
    joints: tuple[str, ...]
    signals: tuple[str, ...]
    period: float
    step: float
    duration: float
    cycle: float | None = None
    scenario: str = ""
    payload: float = 0.0
    seed: int = 0
    reference: Any = field(default=None, compare=False)


class Controller(Protocol):
    """What people bring."""

    def reset(self, context: Context) -> None:
        """Begin anew."""

    def act(self, observation: Mapping[str, float]) -> Any:
        """Return commands."""


def period_of(controller: Any, step: float, source: str) -> int:
    """Return how many steps of the simulation lie between two calls of `act`.

    Raises:
        ScenarioError: its `period` is no time, or shorter than a step.
    """
    period = faults.attribute(controller, "period", PERIOD)
    number = isinstance(period, int | float | np.integer | np.floating) and not isinstance(period, bool)
    if not number or not step * 0.999 <= period <= 1.0:
        raise ScenarioError(
            f"controller {source}: period = {faults.shown(period)}: write seconds between two calls, {step:g} (one step) to 1"
        )
    return max(1, round(float(period) / step))
