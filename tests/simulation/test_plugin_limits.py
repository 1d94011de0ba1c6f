"""The plug-in where it is hard: a stuck load, a piston that hits its ends, effects at the ends of their bounds."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from simulation.started import go, start

from exo_sim.machine.rig_model import load
from exo_sim.rig import parse
from exo_sim.simulation.plugin import PneumaticPlugin


@pytest.mark.parametrize("where", ["piston", "slide"])
@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_a_stuck_load_stays_where_it_is_for_a_minute(bench: Path, where: str, step: float) -> None:
    rig = parse(bench.read_text() + f'\n[effects.coulomb_friction.{where}]\nforce = "20 N"\n', bench)
    model = load(rig)
    model.opt.timestep = step
    data = mujoco.MjData(model)
    data.qpos[0] = 0.08
    plugin = PneumaticPlugin(model, rig)
    plugin.pneumatics.cylinders["vented"] = 1.0
    plugin.reset(data)
    at = []
    for i in range(round(60.0 / step)):
        data.qfrc_applied[0] = 18.0 * min(1.0, i * step) + plugin.plant.felt.sum()
        plugin.step(data)
        at.append(data.qpos[0])
    assert np.ptp(at[len(at) // 20 :]) < 1e-8
    assert abs(at[-1] - 0.08) < 2e-4
    for _ in range(round(1.0 / step)):
        data.qfrc_applied[0] = 22.0 + plugin.plant.felt.sum()
        plugin.step(data)
    assert data.qpos[0] > 0.1


@pytest.mark.parametrize("dead", ["0 cm^3", "0.1 cm^3", "1 cm^3"])
@pytest.mark.parametrize("step", [1e-3, 2.5e-4])
def test_a_piston_that_hits_its_ends_with_little_dead_volume_stays_finite(bench: Path, dead: str, step: float) -> None:
    rig = parse(bench.read_text().replace('"12 cm^3"', f'"{dead}"').replace('"10 cm^3"', f'"{dead}"'), bench)
    model = load(rig)
    model.opt.timestep = step
    data = mujoco.MjData(model)
    data.qpos[0] = 0.08
    plugin = PneumaticPlugin(model, rig)
    plugin.reset(data, 3e5, 3e5)
    highest = 0.0
    for _ in range(round(1.0 / step)):
        plugin.command[0] = 1.0 if data.time % 0.5 < 0.25 else -1.0
        plugin.step(data)
        highest = max(highest, plugin.pressures().max())
    assert np.isfinite(plugin.pressures()).all() and highest < 1e7
    assert not data.warning.number.any()
    assert plugin.books().mass_residual < 1e-9 and plugin.books().energy_residual < 1e-9


@pytest.mark.parametrize(
    "extreme",
    [
        '[effects.viscous_friction.piston]\ncoefficient = "1e5 N s/m"',
        '[effects.quadratic_drag.slide]\ncoefficient = "1e6 N s^2/m^2"',
        '[effects.coulomb_friction.piston]\nforce = "50 N"\n[effects.presliding.piston]\nstiffness = "1e9 N/m"\ndamping = "1e6 N s/m"',
        '[effects.transmission_compliance.piston]\nstiffness = "100 N/m"',
        '[effects.transmission_compliance.piston]\nstiffness = "1e10 N/m"',
        '[effects.backlash.piston]\ngap = "5 cm"',
        '[effects.wall_heat_transfer.piston]\nconductance = "1000 W/K"',
        '[effects.external_leakage.piston]\nlaminar_1 = "1e-12 kg/(s Pa^2)"',
        '[effects.supply_regulator.supply]\ndroop = "1e10 Pa s/kg"',
        '[effects.piston_leakage.piston]\narea = "100 mm^2"',
    ],
)
def test_effects_at_the_ends_of_their_bounds_stay_finite(bench: Path, extreme: str) -> None:
    _, data, plugin = start(bench, f"\n{extreme}\n")
    found = go(data, plugin, 600)
    assert np.isfinite(found).all() and not data.warning.number.any()
    assert plugin.books().mass_residual < 1e-9
