"""The rows of several runs together: in their order, each block of time its own, initial pressures integrated out."""

from __future__ import annotations

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.inputs import inputs
from exo_sim.diagnosis.subsystems.gas.row_set import RowSet
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.physics.plant_records import CYLINDER, WORLD
from exo_sim.rig import assembly


@pytest.fixture(scope="module")
def sets(tmp_path_factory: pytest.TempPathFactory) -> tuple[RowSet, RowSet]:
    """Return the rows of one run, and of the same run twice."""
    rig = benches.bench(tmp_path_factory.mktemp("rows"))
    model = load(rig)
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    (run,) = cylinder_runs(benches.led(rig, 3.0), rig, model, linkages(rig, model))
    given = inputs(run, plant.world, 1.2)
    return RowSet([given], plant, Split({}), False), RowSet([given, given], plant, Split({}), False)


def test_rows_of_two_runs_follow_each_other_and_share_no_block(sets: tuple[RowSet, RowSet]) -> None:
    one, two = sets
    n = one.blocks().size
    assert one.sides == two.sides == (0, 1) and two.scale.size == two.recordings.size == two.blocks().size == 2 * n
    np.testing.assert_array_equal(two.scale[:n], two.scale[n:])
    assert not set(two.blocks()[:n]) & set(two.blocks()[n:])
    assert one.usual_scale == two.usual_scale > 0.0


def test_an_error_that_a_wrong_start_explains_hardly_counts(sets: tuple[RowSet, RowSet]) -> None:
    one, _ = sets
    samples = len(one.unsampled[0])
    change = np.full((samples, 2), 500.0)  # a start that is off by so much is felt all along its window
    known, unknown = one.no_responses(), one.responses([change])
    as_it_stands, explained = (one.whitened([0.05 * change], which) for which in (known, unknown))
    np.testing.assert_allclose(as_it_stands, one.means([0.05 * change]), rtol=1e-12)
    assert np.linalg.norm(explained) < 0.5 * np.linalg.norm(as_it_stands)
    waves = np.stack([25.0 * np.sin(40.0 * np.arange(samples) / 100.0)] * 2, axis=1)
    apart = [np.linalg.norm(one.whitened([waves], which)) for which in (known, unknown)]
    assert apart[1] > 0.95 * apart[0]


def test_without_runs_there_is_no_row() -> None:
    nothing = RowSet([], PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER)), Split({}), False)
    assert nothing.blocks().size == nothing.scale.size == nothing.whitened([], []).size == 0 and nothing.sides == ()
