"""What a healthy machine loses slowly."""

from __future__ import annotations

from pathlib import Path

import benches
import pytest

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.healthy_limits import healthy_limit, with_healthy_losses
from exo_sim.diagnosis.subsystems.healthy_leak import BY_UNIT, swept_volume
from exo_sim.physics.effects import external_leakage, piston_leakage, valve_null_leakage, wall_heat_transfer
from exo_sim.rig import assembly


@pytest.fixture
def plant(tmp_path: Path) -> PlantParameters:
    rig = benches.bench(tmp_path)
    return PlantParameters(assembly.world(rig), assembly.cylinders(rig))


def lost(plant: PlantParameters) -> set[tuple[str, str]]:
    """Return what each variant has on."""
    effects = (external_leakage.EFFECT, piston_leakage.EFFECT, valve_null_leakage.EFFECT, wall_heat_transfer.EFFECT)
    return {
        (effect.name, p.name)
        for one in with_healthy_losses(plant)
        for effect in effects
        for p in effect.parameters
        if float(one.cylinder[effect.name][p.name][0]) > 0.0 and one.is_on(effect) and not plant.is_on(effect)
    }


def test_each_slow_loss_is_there_once_at_its_limit(plant: PlantParameters) -> None:
    assert lost(plant) == {
        ("external_leakage", "area_1"), ("external_leakage", "area_2"), ("piston_leakage", "area"), ("valve_null_leakage", "area"),
        ("wall_heat_transfer", "conductance"),
    }  # fmt: skip
    leak = piston_leakage.EFFECT
    assert healthy_limit(leak, leak.parameter("area"), plant) == pytest.approx(BY_UNIT["m^2"] * swept_volume(plant))


def test_what_was_found_is_known_by_its_own_error(plant: PlantParameters) -> None:
    leaky = plant.copy()
    leaky.cylinder["piston_leakage"]["area"] = 3e-8
    assert ("piston_leakage", "area") not in lost(leaky) and ("external_leakage", "area_1") in lost(leaky)


def test_a_single_acting_cylinder_has_one_chamber_to_lose_from(plant: PlantParameters) -> None:
    single = plant.copy()
    single.cylinder["single_acting"] = 1.0
    assert lost(single) == {("external_leakage", "area_1"), ("valve_null_leakage", "area"), ("wall_heat_transfer", "conductance")}
