"""What healthy machines show of a gas beside fitted numbers: parts of what the rig's effects do, and laws of another form."""

from __future__ import annotations

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy.healthy import LAW_ERROR
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import assembly


@pytest.fixture(scope="module")
def gas(tmp_path_factory: pytest.TempPathFactory) -> GasModel:
    folder = tmp_path_factory.mktemp("laws")
    rig = benches.bench(folder, '[effects.valve_lag.piston]\ntime_constant = "0.01 s"\n')
    table = benches.recorded(rig, 3.0)
    model = load(rig)
    runs = cylinder_runs(table, rig, model, linkages(rig, model))
    return GasModel(runs, PlantParameters(assembly.world(rig), assembly.cylinders(rig)), Split({}))


def columns(basis: DiscrepancyBasis, name: str) -> np.ndarray:
    return np.asarray(basis.columns[:, basis.kinds == basis.names.index(name)])


def test_an_effect_of_the_rig_gives_parts_that_add_up_to_what_it_does(gas: GasModel) -> None:
    basis = gas.healthy_discrepancy(gas.nominal)
    lag = columns(basis, "valve_lag")
    assert basis.healthy[basis.names.index("valve_lag")] == LAW_ERROR
    assert 4 <= lag.shape[1] <= 8
    quick = gas.nominal.copy()
    quick.cylinder["valve_lag"]["time_constant"] = 0.0
    whole = gas.residual_of(gas.nominal) - gas.residual_of(quick)
    np.testing.assert_allclose(lag.sum(axis=1), whole, atol=1e-6 * rms(whole))


def test_laws_that_every_machine_has_in_some_form_give_one_column_a_parameter(gas: GasModel) -> None:
    basis = gas.healthy_discrepancy(gas.nominal)
    assert columns(basis, "valve_edges").shape[1] == 8  # overlap and area of each edge, all of which this recording uses
    wider = gas.nominal.copy()
    wider.cylinder["valve_edges"]["excess_supply_1"] = 0.05
    change = gas.residual_of(wider) - gas.residual_of(gas.nominal)
    alike = [float(abs(change @ each) / np.linalg.norm(change) / np.linalg.norm(each)) for each in columns(basis, "valve_edges").T]
    assert max(alike) == pytest.approx(1.0)


def test_an_effect_that_the_rig_does_not_have_gives_none(gas: GasModel) -> None:
    assert not {"line_restriction", "valve_hysteresis", "exhaust_back_pressure"} & set(gas.healthy_discrepancy(gas.nominal).names)
