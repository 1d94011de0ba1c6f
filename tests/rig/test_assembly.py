"""From a rig to records: numbers in SI, effects at their parts, and what gives in a joint's drive felt by its cylinder."""

from __future__ import annotations

from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim.rig import assembly

MORE = """
[effects.valve_lag.piston]
delay = "5 ms"
[effects.viscous_friction.slide]
coefficient = "30 N s/m"
[effects.transmission_compliance.slide]
stiffness = "2e5 N/m"
[effects.supply_droop.supply]
volume = "2 l"
conductance = "4e-8 kg/(s Pa)"
"""


def test_each_effect_is_on_in_the_record_of_its_part_and_nowhere_else(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path, MORE)
    (cylinder,), (world,), (joint,) = assembly.cylinders(rig), assembly.world(rig), assembly.joints(rig, ["slide"])
    assert cylinder["stroke"] == pytest.approx(0.2) and cylinder["valve_area"] == pytest.approx(2e-6)
    assert cylinder["area_1"] == pytest.approx(np.pi * 0.032**2 / 4) and cylinder["dead_volume_2"] == pytest.approx(15e-6)
    assert cylinder["valve_lag"]["delay"] == pytest.approx(5e-3) and cylinder["viscous_friction"]["coefficient"] == 0.0
    assert joint["viscous_friction"]["coefficient"] == pytest.approx(30.0)
    assert world["supply_droop"]["volume"] == pytest.approx(2e-3) and world["supply_pressure"] == pytest.approx(7e5)
    assert assembly.joints_with_effects(rig) == ("slide",)


def test_a_soft_drive_is_felt_by_the_cylinder_that_drives_the_joint(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path, MORE)
    assert assembly.cylinders(rig)["drive_stiffness"][0] == 0.0
    assert assembly.cylinders(rig, {"piston": "slide"})["drive_stiffness"][0] == pytest.approx(2e5)


def test_a_plant_is_named_after_the_rigs_cylinders(tmp_path: Path) -> None:
    gas = assembly.pneumatics(benches.bench(tmp_path), 1e-3)
    gas.fill(np.array([0.1]), 3e5, 3e5)
    assert gas.pressures(np.array([0.1]))[0] == pytest.approx([3e5, 3e5])
