"""How a scenario is found, by name or in a file, and its motion at a speed."""

from __future__ import annotations

from pathlib import Path

from exo_sim import units
from exo_sim.errors import ScenarioError, UnitError
from exo_sim.gait.included_scenarios import included, names
from exo_sim.gait.motion import Motion
from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.speed_and_slope import at_speed, on_slope
from exo_sim.machine.person import Person

__all__ = ["SPEED_RANGE", "cadence", "find", "motion", "names"]

SPEED_RANGE = (0.7, 1.3)


def find(name: str) -> Scenario:
    """Return the scenario of this name, the one in a scenario file (`gait.scenario_file`), or walking as in a gait file.

    Raises:
        ScenarioError: there is none; the nearest names are offered. A file that cannot be one.
    """
    if name.lower().endswith(".toml"):
        from exo_sim.gait import scenario_file

        return scenario_file.read(name)
    if name.lower().endswith((".mot", ".sto", ".c3d")):
        from exo_sim.gait import own_gait

        return own_gait.scenario(own_gait.GaitFile(Path(name)))
    return included(name)


def motion(scenario: str | Scenario, person: Person, speed: float | str) -> Motion:
    """Return a scenario's reference motion for one person at one speed.

    Args:
        scenario: The scenario or its name.
        person: Who does it.
        speed: Factor on the cadence within `SPEED_RANGE`, strides staying as long; or the speed of walking like "1.3 m/s", for which
            strides get longer or shorter as well (`speed_and_slope.at_speed`).

    Raises:
        ScenarioError: no such scenario, or a speed outside the range.
    """
    found = find(scenario) if isinstance(scenario, str) else scenario
    usual = found.motion(person)
    scaled = usual.advance > 0.0 and usual.trial is None and usual.ground.level and not usual.from_rest
    if (found.pace is not None or found.grade) and not scaled:
        raise ScenarioError("speed and grade of a scenario file are for the mean stride of a level walk; leave them out")
    if found.pace is not None:
        usual = at_speed(usual, person, found.pace / (usual.advance / usual.period))
    wanted = _pace(speed)
    if wanted is not None and scaled:
        usual = at_speed(usual, person, wanted / (usual.advance / usual.period))
    else:
        usual = usual.at_cadence(cadence(usual, speed))
    return on_slope(usual, person, found.grade) if found.grade else usual


def _pace(speed: float | str) -> float | None:
    """Return the speed that a text with a unit is [m/s]; None for a factor, or for what is neither."""
    try:
        float(speed)
        return None
    except ValueError:
        pass
    try:
        return units.parse(speed, "m/s")
    except UnitError:
        return None


def cadence(usual: Motion, speed: float | str) -> float:
    """Return the factor on the recorded cadence that a speed is.

    Args:
        usual: The motion at the recorded cadence.
        speed: The factor itself, also as text, or the speed of walking like "1.3 m/s", strides staying as long.

    Raises:
        ScenarioError: it is no speed, outside `SPEED_RANGE`, or a speed in space of a motion that goes nowhere.
    """
    low, high = SPEED_RANGE
    try:
        factor = float(speed)
    except ValueError:
        pace = usual.advance / usual.period
        try:
            wanted = units.parse(speed, "m/s")
        except UnitError as error:
            raise ScenarioError(f'speed {error} (or write a factor on the recorded cadence, like "1.1")') from None
        if pace < 0.05 or usual.from_rest:
            why = "begins and ends at rest" if usual.from_rest else "goes nowhere"
            raise ScenarioError(f'speed "{speed}": this motion {why}; write a factor on its cadence, {low:g} to {high:g}') from None
        factor = wanted / pace
        if not low <= factor <= high:
            raise ScenarioError(
                f'speed "{speed}" is {factor:.2g} times the recorded {pace:.2f} m/s; write {low * pace:.2f} to {high * pace:.2f} m/s'
            ) from None
    if not low <= factor <= high:
        raise ScenarioError(f"speed {factor:g} is outside {low:g} to {high:g} times the recorded cadence")
    return factor
