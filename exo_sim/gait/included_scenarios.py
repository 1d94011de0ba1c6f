"""The scenarios that come along: every module in `exo_sim.gait.scenarios` holds one, `SCENARIO`."""

from __future__ import annotations

import importlib
import pkgutil

from exo_sim.errors import ScenarioError, nearest
from exo_sim.gait.scenario_record import Scenario

_PACKAGE = "exo_sim.gait.scenarios"


def names() -> tuple[str, ...]:
    """Return the names of all of them, in alphabetical order."""
    package = importlib.import_module(_PACKAGE)
    return tuple(sorted(entry.name for entry in pkgutil.iter_modules(package.__path__)))


def included(name: str) -> Scenario:
    """Return the one of this name.

    Raises:
        ScenarioError: there is none; the nearest names are offered.
    """
    if name not in names():
        raise ScenarioError(f'no scenario "{name}"{nearest(name, names())}')
    found: Scenario = importlib.import_module(f"{_PACKAGE}.{name}").SCENARIO
    return found
