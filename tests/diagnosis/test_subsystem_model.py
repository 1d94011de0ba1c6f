"""A subsystem is asked through its model: what selection, validation and outcome do depends on no kind of subsystem."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest
from diagnosis import waves

import exo_sim.diagnosis
from exo_sim.diagnosis.findings import Subsystem

ROOT = Path(exo_sim.diagnosis.__file__).parent


@pytest.mark.parametrize("room", ["selection", "validation", "outcome", "coupling", "discrepancy", "estimation"])
def test_no_room_above_asks_which_kind_it_is(room: str) -> None:
    kinds = {kind.name for kind in Subsystem}
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in sorted((ROOT / room).rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "Subsystem" and node.attr in kinds
    ]
    assert found == [], "ask the model: give `SubsystemModel` an attribute that says what is meant"


def test_a_residual_is_that_of_the_plant_with_its_parameters_changed() -> None:
    model, size = waves.Waves(slow=3.0), waves.BASE.parameters[0]
    assert model.size == waves.AT.size
    np.testing.assert_allclose(model.residual({size: 3.0}) - model.residual({}), 3.0 * waves.SHAPES["slow"])
    np.testing.assert_array_equal(model.residual({}, [(size, 3.0)]), model.residual({size: 3.0}))


def test_what_a_subsystem_does_not_say_is_that_of_the_plainest() -> None:
    model = waves.Waves()
    plant = model.apply({})
    assert not (model.demands_larger_part or model.calibrates_pressures or model.is_input_of_others)
    assert model.main_discrepancy(plant).unit == model.discrepancies(plant)[0].unit
    assert model.is_observed(waves.BASE.parameters[0]) and not model.has_bursts(plant) and model.structural_error == 0.0
    assert model.healthy_variants(plant) == () and dict(model.experiments([plant])) == {}
