"""How far one run over a recording strays, and what explains it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest
from diagnosis import waves
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters
from exo_sim.diagnosis.findings import Subsystem
from exo_sim.diagnosis.policy.validation import HEALTHY_KNOWN
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.validation.long_run import Straying, straying
from exo_sim.rig import assembly

SPLIT = Split({"recording": ((0.0, 400.0),)})


class Growing(waves.Waves):
    """Waves that are `grown` times as large in one run as in windows, and imperfections of a healthy machine."""

    def __init__(self, grown: float, healthy: float = 0.0, **sizes: float):
        super().__init__(1.0, waves.SHAPES, **sizes)
        self.grown, self.healthy, self.sizes = grown, healthy, sizes

    def in_one_run(self, split: Split) -> waves.Waves:
        return waves.Waves(1.0, {name: self.grown * wave for name, wave in waves.SHAPES.items()}, **self.sizes)

    def healthy_variants(self, plant: PlantParameters) -> tuple[PlantParameters, ...]:
        return (plant.with_values([(waves.parameter("loss", "level"), self.healthy)]),)


def fitted(model: waves.Waves | GasModel, nuisances: Sequence[FreeParameter]) -> SubsystemResult[waves.Waves | GasModel]:
    fits = ModelFits(model, nuisances)
    final = FittedModel((), fit(model.residual, tuple(nuisances), {q: q.start for q in nuisances}))
    return SubsystemResult("piston", model, fits, SearchResult(final, final), final)


def test_what_windows_do_not_show_adds_up() -> None:
    found = straying(fitted(Growing(100.0, slow=0.1), ()), SPLIT)
    assert found is not None and (found.healthy, found.spread) == pytest.approx((1.0, math.sqrt(1.0 + HEALTHY_KNOWN**2)))
    assert found.error == pytest.approx(100.0 * 0.1 * np.std(waves.SHAPES["slow"]), rel=0.1)
    assert found.beyond == pytest.approx((found.error - 1.0) / found.spread) and found.beyond > 3.0


def test_a_number_that_is_known_only_so_well_explains_what_it_adds_up_to() -> None:
    """A wave that was fitted is known to sqrt(2 / 400): a hundred times larger it strays by a hundred times that."""
    found = straying(fitted(Growing(100.0, slow=0.1), [waves.parameter("size", "slow")]), SPLIT)
    assert found is not None
    assert found.spread == pytest.approx(math.sqrt(1.0 + 100.0**2 / 400.0), rel=0.05) and found.beyond < 3.0


def test_numbers_that_stand_in_for_each_other_explain_no_more_than_both_do() -> None:
    """Neither of two equal waves is known, their sum is: the priors of 10 are no reason for a run to stray."""
    twins = [waves.parameter(name, "slow", (0.0, 10.0)) for name in ("one", "other")]
    found = straying(fitted(Growing(100.0, slow=0.1), twins), SPLIT)
    alone = straying(fitted(Growing(100.0, slow=0.1), twins[:1]), SPLIT)
    assert found is not None and alone is not None and found.spread == pytest.approx(alone.spread, rel=0.01)


def test_what_a_healthy_machine_loses_explains_as_much() -> None:
    found = straying(fitted(Growing(100.0, healthy=0.1, slow=0.1), ()), SPLIT)
    assert found is not None and found.healthy == pytest.approx(math.hypot(1.0, 10.0)) and found.beyond < 3.0


def test_a_subsystem_that_predicts_nothing_over_time_does_not_stray() -> None:
    assert straying(fitted(waves.Waves(slow=5.0), ()), SPLIT) is None


def test_what_does_not_exceed_a_healthy_machine_has_no_odds() -> None:
    assert Straying(1.0, 2.0, 1.5).log10_odds == Straying(1.0, 2.0, 1.5).beyond == 0.0
    assert Straying(8.0, 2.0, 1.5).log10_odds == pytest.approx(8.0 / math.log(10.0)) and Straying(8.0, 2.0, 1.5).explained == 3.5


@pytest.mark.parametrize(("half_life", "explained"), [(400.0, True), (5.0, False)])
def test_a_decay_strays_that_no_healthy_leak_explains(tmp_path: Path, half_life: float, explained: bool) -> None:
    """5 bar of which half is gone in so many seconds; a cylinder that takes minutes is healthy."""
    rig = benches.bench(tmp_path)
    time = np.arange(0.0, 12.0, 0.01)
    gauge = 4e5 * 0.5 ** (time / half_life)
    noise = np.random.default_rng(2).normal(0.0, 200.0, (2, time.size))
    n = time.size
    run = run_of(101325.0 + gauge + noise[0], np.full(n, 101325.0) + noise[1], time=time, noise=(200.0, 200.0))
    run = replace(run, length=np.full(n, 0.1), command=np.zeros(n), speed=np.zeros(n))
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    parts = Split({"recording": ((8.0, 12.0),)})
    model = GasModel([run], plant, parts)
    one = fitted(model, ())
    assert one.key == (Subsystem.GAS, "piston")
    found = straying(one, parts)
    assert found is not None and (found.beyond < 3.0) is explained
