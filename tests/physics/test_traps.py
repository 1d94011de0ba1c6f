"""Machines at the bounds of what a rig file may say: finite with closed books, or an error that says what to change."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from exo_sim.errors import ModelError
from exo_sim.physics import state
from exo_sim.physics.declaration import Effect, Parameter, declared
from exo_sim.physics.plant_records import CYLINDER, WORLD
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world

Numbers = Mapping[str, Mapping[str, float | np.ndarray]]

#: Effects of cylinders, supply and exhaust; those of joints alone and of sensors have no gas.
EFFECTS = {name: effect for name, effect in declared().items() if name in (CYLINDER.names or ()) or name in (WORLD.names or ())}


def extreme(parameter: Parameter, high: bool) -> float | np.ndarray:
    """Return a bound of a parameter; a list steps from one bound to the other."""
    if parameter.most:
        return np.linspace(parameter.low, parameter.high, parameter.most)
    return parameter.high if high else parameter.low


def at_bounds(effect: Effect, high: bool) -> dict[str, float | np.ndarray]:
    """Return every number of an effect at one end of what a rig file may say."""
    return {parameter.name: extreme(parameter, high) for parameter in effect.parameters}


def work(numbers: Numbers, bore: float, dead: float, dt: float, seed: int = 0) -> Pneumatics:
    """Drive a piston from end to end with its valve swinging, twice; return the machine, its books closed and its state finite."""
    world, cylinder = paper_world(), paper_cylinder(bore, 0.3 * bore, 0.1, 5e-6, dead, dead)
    cylinder["effective_mass"] = 1.0
    for name, entries in numbers.items():
        record = cylinder if name in (CYLINDER.names or ()) else world
        for key, value in entries.items():
            record[name][key] = value
    gas = Pneumatics(world, cylinder, dt=dt)
    time = np.arange(24) * dt
    x = 0.05 - 0.05 * np.cos(2 * np.pi * time / (12 * dt))
    command = np.sin(2 * np.pi * time / (7 * dt) + seed)
    gas.fill(x[:1], 3e5, 4e5)
    gas.settle_transmission(x[:1])
    for i in range(1, len(x)):
        gas.advance(x[i - 1 : i], x[i : i + 1], command[i - 1 : i])
        assert np.isfinite(gas.forces(x[i : i + 1], (x[i : i + 1] - x[i - 1 : i]) / dt)).all()
    return gas


def holds_or_says(numbers: Numbers, bore: float, dead: float, dt: float, seed: int = 0) -> None:
    """Check that a machine works soundly, or is refused with a remedy."""
    try:
        gas = work(numbers, bore, dead, dt, seed)
    except ModelError as error:
        said = str(error)
        assert "\n" not in said and ("give it" in said or "fill it" in said), said
        return
    assert np.isfinite(gas.vector).all()
    assert (gas.pressures(np.array([0.05])) > 0.0).all() and (gas.temperatures() > 0.0).all()
    books, y = gas.books(), gas.integrated[0]
    passed = float(np.abs(y[[state.DRAWN, state.EXHAUSTED, state.LEAKED]]).sum())
    assert books.mass_residual < 1e-9 or books.mass_residual * passed < 1e-12 * y[[state.MASS_1, state.MASS_2]].sum()  # what rounding loses
    assert books.energy_residual < 1e-9


@pytest.mark.parametrize(("bore", "dt"), [(0.2, 5e-3), (0.2, 1e-3), (0.008, 5e-3)])
def test_a_cylinder_without_effects_survives_tiny_dead_volumes(bore: float, dt: float) -> None:
    gas = work({}, bore, 1e-9, dt)
    books = gas.books()
    assert np.isfinite(gas.vector).all() and books.mass_residual < 1e-9 and books.energy_residual < 1e-9


@pytest.mark.parametrize("high", [False, True], ids=["low", "high"])
@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_every_effect_at_its_bounds(name: str, high: bool) -> None:
    effect = EFFECTS[name]
    numbers: dict[str, Mapping[str, float | np.ndarray]] = {name: at_bounds(effect, high)}
    if effect.requires:
        numbers[effect.requires] = at_bounds(EFFECTS[effect.requires], high)
    for bore, dead, dt in ((0.2, 1e-9, 5e-3), (0.02, 1e-8, 1e-3)):
        holds_or_says(numbers, bore, dead, dt)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_random_mixtures_at_their_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    chosen = rng.choice(sorted(EFFECTS), rng.integers(2, 9), replace=False)
    numbers = {
        str(name): {p.name: extreme(p, bool(rng.random() < 0.5)) for p in EFFECTS[name].parameters if p.required or rng.random() < 0.7}
        for name in chosen
    }
    bore, dead, dt = rng.choice([0.008, 0.032, 0.2]), 10.0 ** rng.uniform(-9.0, -5.0), rng.choice([1e-3, 5e-3])
    holds_or_says(numbers, float(bore), float(dead), float(dt), seed)


def test_what_is_too_fast_is_named_with_what_makes_it_so(monkeypatch: pytest.MonkeyPatch) -> None:
    impatient = paper_world()
    impatient["most_steps"] = 4.0
    monkeypatch.setitem(globals(), "paper_world", lambda: impatient)
    with pytest.raises(ModelError, match=r"cylinder number 1: chamber [12], [\d.]+ cm\^3 there, settles in .* less wall_heat_transfer"):
        work({"wall_heat_transfer": {"conductance": 1e3}}, 0.032, 1e-9, 5e-3)


def test_a_number_that_is_none_is_named() -> None:
    with pytest.raises(ModelError, match=r"wall_heat_transfer\.conductance is not a number"):
        work({"wall_heat_transfer": {"conductance": np.nan}}, 0.032, 1e-6, 1e-3)
