"""A refused step or filling says which cylinder, which number, and what to change."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import bench

from exo_sim.physics.plant import NO_COMMAND
from exo_sim.physics.refusals import unfillable, why


@pytest.mark.parametrize(
    ("x", "p_1", "t", "says"),
    [(0.05, 5e5, 293.0, None), (np.nan, 5e5, 293.0, "piston is at nan m"), (0.05, -1.0, 293.0, "pressure_1 = -1 Pa"),
     (0.05, 5e5, 0.0, "absolute temperature above zero")],
)  # fmt: skip
def test_what_cannot_be_filled(x: float, p_1: float, t: float, says: str | None) -> None:
    ok = np.array([0.05, 5e5, 5e5, 293.0])
    rows = np.stack([ok, (x, p_1, 5e5, t)])
    refusal = unfillable(*rows.T)
    if says is None:
        assert refusal is None
    else:
        assert refusal is not None and refusal.cylinder == 1 and says in refusal.says


def test_a_command_that_is_no_number_is_named() -> None:
    gas = bench()
    at = np.array([0.05])
    refusal = why(NO_COMMAND, gas.world, gas.cylinders, gas.vector, at, at, np.array([np.nan]), 1e-3)
    assert "valve command is nan" in refusal.says and "-1 to 1" in refusal.says


def test_a_number_of_the_record_that_is_none_is_named_with_its_effect() -> None:
    gas = bench()
    gas.cylinders["wall_heat_transfer"]["conductance"] = np.nan
    at = np.array([0.05])
    assert why(1, gas.world, gas.cylinders, gas.vector, at, at, np.zeros(1), 1e-3).says.startswith("wall_heat_transfer.conductance")


@pytest.mark.parametrize(("effect", "number", "value"), [("wall_heat_transfer", "conductance", 1e7), ("piston_leakage", "area", 1.0)])
def test_gas_too_fast_for_any_step_names_what_makes_it_so(effect: str, number: str, value: float) -> None:
    gas = bench(dead=1e-8)
    gas.cylinders[effect][number] = value
    at = np.array([0.05])
    says = why(1, gas.world, gas.cylinders, gas.vector, at, at, np.zeros(1), 5e-3).says
    assert f"less {effect}" in says and "dead volume" in says
