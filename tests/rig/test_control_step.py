"""How long a step a valve bears."""

from dataclasses import replace
from pathlib import Path

import pytest

from exo_sim import rig
from exo_sim.errors import ModelError
from exo_sim.rig.control_step import check_step, longest_step

ASSETS = Path(__file__).resolve().parents[2] / "assets"


def test_it_follows_the_settling_time_of_a_choked_volume() -> None:
    machine = rig.read(ASSETS / "exo_250_psi.toml")
    knee = next(iter(machine.cylinders.values()))
    volume = knee.dead_volume_1 + 0.5 * knee.area_1 * knee.stroke
    speed_of_sound = (1.4 * machine.specific_gas_constant * machine.supply.temperature) ** 0.5
    assert longest_step(machine, knee) == pytest.approx(0.5 * volume / (1.4 * knee.valve_area * speed_of_sound), rel=1e-3)
    assert longest_step(machine, replace(knee, valve_area=100.0 * knee.valve_area)) == pytest.approx(longest_step(machine, knee) / 100.0)


def test_without_a_valve_any_step_will_do() -> None:
    machine = rig.read(ASSETS / "exo_250_psi.toml")
    knee = next(iter(machine.cylinders.values()))
    assert longest_step(machine, replace(knee, valve_area=0.0)) == float("inf")


def test_the_committed_machine_runs_at_its_own_step() -> None:
    machine = rig.read(ASSETS / "exo_250_psi.toml")
    assert all(longest_step(machine, cylinder) > 1e-3 for cylinder in machine.cylinders.values())


def test_a_longer_step_is_refused_by_the_cylinder() -> None:
    machine = rig.read(ASSETS / "exo_250_psi.toml")
    shortest = min(machine.cylinders.values(), key=lambda one: longest_step(machine, one))
    check_step(machine, longest_step(machine, shortest))
    with pytest.raises(ModelError, match=f"timestep = .* {shortest.name}.*write at most"):
        check_step(machine, 1.01 * longest_step(machine, shortest))
