"""A soft transmission that hides behind the friction of its piston: the gas asks for it once that friction is known."""

from __future__ import annotations

from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.split import split
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.pipeline.gas_stage import nominal_gas
from exo_sim.diagnosis.pipeline.hidden_give import friction_behind_hidden_give
from exo_sim.diagnosis.pipeline.plan import Plan
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.nuisances import nuisance_parameters
from exo_sim.recording import write_table

#: What resists the piston [N], and a parameter that says so.
RESISTS = 60.0
FORCE = FreeParameter("coulomb_friction", "piston", "force", "N", Target.CYLINDER, 1.0, 0.0, 1e3)
FRICTION = Candidate("coulomb_friction", "piston", "force", (FORCE,), ((1.0,),))


def closed_chambers(folder: Path, stiffness: float) -> Path:
    """Write closed chambers on a piston that a joint leads back and forth through a transmission of this stiffness [N/m]."""
    rig = benches.bench(folder)
    c = rig.cylinders["piston"]
    time = np.arange(6000) * 2e-3
    joint = 0.05 * np.sin(2.0 * np.pi * 0.5 * time) * np.sin(0.35 * time)
    against = RESISTS * np.tanh(np.gradient(joint, time) / 1e-3)
    give = np.zeros_like(time)
    for _ in range(60):
        volumes = c.dead_volume_1 + c.area_1 * (joint + give + 0.1), c.dead_volume_2 + c.area_2 * (0.1 - joint - give)
        one, two = (4e5 * (v[0] / v) ** 1.4 for v in volumes)
        drive = one * c.area_1 - two * c.area_2 - rig.environment.pressure * (c.area_1 - c.area_2)
        give = 0.5 * give + 0.5 * (drive - against) / stiffness
    noise = np.random.default_rng(5).normal(0.0, 150.0, (2, len(time)))
    columns = {"piston.pressure_1": one + noise[0], "piston.pressure_2": two + noise[1]}
    columns |= {"piston.valve_command": np.zeros_like(time), "slide.position": joint}
    path = folder / "closed.csv"
    write_table(path, benches.recording(time, columns))
    return path


@pytest.mark.parametrize(("stiffness", "named", "asks"), [(6e4, True, True), (6e4, False, False), (1e8, True, False)])
def test_a_gas_asks_for_a_transmission_that_gives_beside_the_friction_of_its_piston(
    tmp_path: Path, stiffness: float, named: bool, asks: bool
) -> None:
    data = gather([closed_chambers(tmp_path, stiffness)], tmp_path / "rig.toml", None)
    plan = Plan(split([(table.name, table.time) for table in data.recordings]))
    runs = data.cylinders["piston"]
    model = GasModel(runs, nominal_gas(data, plan, "piston", runs), plan.split)
    fits = ModelFits(model, nuisance_parameters(model.nominal, "piston", True, (1, 2), moves=True))
    bare = fits.refined(fits.fit(()))
    gas = SubsystemResult("piston", model, fits, SearchResult(bare, bare), bare)
    resisted = FittedModel((FRICTION,), Fit((FORCE,), {FORCE: RESISTS}, np.zeros(4), np.zeros((4, 1))))
    motion = SubsystemResult("slide", model, fits, SearchResult(resisted, resisted), resisted, (FRICTION,) if named else ())
    found = friction_behind_hidden_give([gas], [motion], plan.split, {"piston": "slide"})  # type: ignore[list-item]
    assert found == ({"piston": [(FORCE, RESISTS)]} if asks else {})
