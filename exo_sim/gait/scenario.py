"""What a scenario is, and how scenarios are found: every module in `exo_sim.gait.scenarios` holds one, `SCENARIO`."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass

from exo_sim.errors import ScenarioError, nearest
from exo_sim.gait.motion import Motion
from exo_sim.machine.person import Person

SPEED_RANGE = (0.7, 1.3)


@dataclass(frozen=True)
class AddedLoad:
    """Mass put on the back while the scenario runs.

    Attributes:
        mass: [kg].
        at: When, in cycles of the motion.
        over: How long it takes until it hangs fully on the frame [s].
    """

    mass: float
    at: float
    over: float


@dataclass(frozen=True)
class Scenario:
    """One thing that a person does in the machine.

    Attributes:
        summary: One line for the list.
        motion: Gives the reference motion of a person.
        cycle: What one cycle is called: "stride", "repetition", "second".
        cycles: How many, unless told otherwise.
        gait: Name of the recorded gait that the angles can be held against, or None.
        added: Load put on while it runs, or None.
    """

    summary: str
    motion: Callable[[Person], Motion]
    cycle: str = "stride"
    cycles: int = 10
    gait: str | None = None
    added: AddedLoad | None = None


def names() -> tuple[str, ...]:
    """Return the names of all scenarios, in alphabetical order."""
    package = importlib.import_module("exo_sim.gait.scenarios")
    return tuple(sorted(entry.name for entry in pkgutil.iter_modules(package.__path__)))


def find(name: str) -> Scenario:
    """Return the scenario of this name.

    Raises:
        ScenarioError: there is none; the nearest names are offered.
    """
    if name not in names():
        raise ScenarioError(f'no scenario "{name}"{nearest(name, names())}')
    return importlib.import_module(f"exo_sim.gait.scenarios.{name}").SCENARIO


def motion(name: str, person: Person, speed: float) -> Motion:
    """Return a scenario's reference motion for one person at one cadence.

    Args:
        name: Of the scenario.
        person: Who does it.
        speed: Factor on the recorded cadence, `SPEED_RANGE`.

    Raises:
        ScenarioError: no such scenario, or a speed outside the range.
    """
    low, high = SPEED_RANGE
    if not low <= speed <= high:
        raise ScenarioError(f"speed {speed:g} is outside {low:g} to {high:g} times the recorded cadence")
    return find(name).motion(person).at_cadence(speed)
