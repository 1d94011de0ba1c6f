"""The experiment that is proposed is the one in which two explanations differ beyond what either could adapt."""

from __future__ import annotations

import math

import benches
import numpy as np
import pytest
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.outcome.experiments import expected_gain, ranked
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.experiments import resisted
from exo_sim.rig import assembly


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> PlantParameters:
    rig = benches.bench(tmp_path_factory.mktemp("experiments"))
    return PlantParameters(assembly.world(rig), assembly.cylinders(rig))


def changed(plant: PlantParameters, effect: str, **values: float) -> PlantParameters:
    other = plant.copy()
    for name, value in values.items():
        other.cylinder[effect][name] = value
    return other


def test_the_gain_is_that_of_two_gaussian_explanations() -> None:
    first, second = np.zeros(8), np.full(8, 2.0)
    assert expected_gain(np.stack([first, second])) == pytest.approx(0.5 * 8 * 4.0 / math.log(10.0))
    assert expected_gain(np.stack([first, first])) == 0.0


def test_what_a_number_could_adapt_to_is_no_gain() -> None:
    second = np.linspace(1.0, 2.0, 8)
    free = expected_gain(np.stack([np.zeros(8), second]))
    held = expected_gain(np.stack([np.zeros(8), second, 0.1 * second]))
    loose = expected_gain(np.stack([np.zeros(8), second, 1e3 * second]))
    assert free > held > 100.0 * loose > 0.0
    assert expected_gain(np.stack([np.zeros(8), np.full(8, math.nan)])) == 0.0


def test_of_experiments_that_tell_as_much_the_easiest_is_listed() -> None:
    found = ranked({"in the room": 2057.0, "at pressure": 2060.0, "slowly": 500.0, "not at all": 0.0, "quickly": 90.0, "in the end": 3.0})
    assert found == (("in the room", 2057.0), ("slowly", 500.0), ("quickly", 90.0))


def test_a_leak_past_the_piston_shows_where_the_chambers_differ(plant: PlantParameters) -> None:
    moved = np.linspace(0.02, 0.12, 2000)
    run = run_of(np.full(2000, 3e5), np.full(2000, 3e5), length=moved, commanded=True, noise=(100.0, 100.0))
    predicted = GasModel([run], plant, Split({})).experiments([plant, changed(plant, "piston_leakage", area=1e-7)])
    gains = {do: expected_gain(both) for do, both in predicted.items()}
    (apart,) = (do for do in gains if "one chamber full and the other empty" in do)
    alike = [do for do in gains if "both chambers at" in do]
    assert max(gains, key=lambda do: gains[do]) == apart and max(gains[do] for do in alike) < 0.01 * gains[apart]
    silent = run_of(np.full(2000, 3e5), np.full(2000, 3e5), length=moved, commanded=False, noise=(100.0, 100.0))
    assert not any("valve fully" in do for do in GasModel([silent], plant, Split({})).experiments([plant, plant]))


def test_friction_that_grows_with_pressure_shows_at_another_pressure(plant: PlantParameters) -> None:
    gauge, level = 6e5, 20.0
    dry = changed(plant, "coulomb_friction", force=level)
    growing = changed(plant, "pressure_dependent_friction", coefficient=level / (2.0 * gauge))
    found = resisted(0.02, 0.12, gauge, [dry, growing])
    gains = {do: expected_gain(both) for do, both in found.items()}
    full, room = "at the highest pressure in both chambers", "with both chambers open to the room"
    assert max(gains, key=lambda do: gains[do]).endswith(room)
    assert max(gain for do, gain in gains.items() if do.endswith(full)) < 1e-3 * max(gains.values())
