"""An unknown effect: where it acts, on what it depends, and its curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.probability import MAY_BE_NIL
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult, Unnamed
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import effect_of, spread_of_size, unknown_effects


class Rail(waves.Waves):
    """A balance that lacks something along a place.

    Args:
        acts: Whether that is a force or a friction.
        explains: Share of its variance that a curve predicts.
        otherwise: Of it as the other of the two.
        variable: What it follows.
    """

    def __init__(self, acts: str, explains: float, otherwise: float, variable: str = "position"):
        super().__init__(quick=5.0)
        at = np.array([0.0, 1.0])
        self.missing = Discrepancy(acts, "N", self.balance, (Curve(variable, at, at, at, explains),), 5.0, otherwise=otherwise)

    def discrepancy_over(self, plant: PlantParameters, variables: Sequence[str]) -> Discrepancy:
        return self.missing


def said_of(model: Rail) -> str:
    """Return what is said of something that varies with the place, or with what a model's curve follows."""
    one = result(model, has_unknown=True)
    unnamed = (Unnamed(model.missing.curves[0].variable, 0.95, 0.28),)
    (effect,) = unknown_effects([replace(one, search=replace(one.search, unnamed=unnamed))])
    return effect.finding.says


def result(model: waves.Waves, has_unknown: bool = False) -> SubsystemResult[waves.Waves]:
    final = FittedModel((), Fit((), {}, model.residual({}), np.zeros((model.size, 0))))
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final, has_unknown=has_unknown)


def test_it_says_where_it_acts_and_on_what_it_depends() -> None:
    one = result(waves.Waves(slow=5.0), has_unknown=True)
    (effect,) = unknown_effects([one])
    finding = effect.finding
    assert (finding.kind, finding.where, finding.depends_on) == (Kind.UNKNOWN, "piston", ("slide.position",))
    assert "sum of waves of piston" in finding.says and "follows slide.position" in finding.says
    assert finding.curve is not None and finding.curve["values"] == [-1.0, 1.0]
    assert finding.log10_odds > 3.0
    assert effect_of([effect], one) is effect


def test_without_one_there_is_none() -> None:
    one = result(waves.Waves())
    assert unknown_effects([one]) == () and effect_of([], one) is None


def test_its_size_is_as_sure_as_independent_values_make_it() -> None:
    (effect,) = unknown_effects([result(waves.Waves(slow=5.0), has_unknown=True)])
    size = effect.finding.parameters["size"]
    assert size.low < size.value < size.high and (size.low > 0.0 or effect.finding.confidence <= MAY_BE_NIL)
    low, high = spread_of_size(200.0)
    assert (low, high) == (pytest.approx(0.902, abs=1e-3), pytest.approx(1.098, abs=1e-3))
    assert spread_of_size(1.0)[0] == 0.0


def test_a_force_and_a_friction_are_told_apart_where_the_recordings_do_that() -> None:
    assert "A force varies with position by 28 % of all that acts" in said_of(Rail("force", 0.9, 0.0))
    assert "Friction varies with position by 28 % of all that acts" in said_of(Rail("friction", 0.9, 0.0))
    assert "A force or a friction varies with position" in said_of(Rail("friction", 0.9, 0.9))


def test_what_its_curve_is_worth_is_said_and_why_a_rig_holds_none() -> None:
    assert said_of(Rail("force", 0.9, 0.0)).endswith("A curve over slide.position predicts 90 % of its variance.")
    assert "No curve over slide.position predicts enough of it" in said_of(Rail("force", 0.1, 0.0))
    assert "no rig can follow slide.time" in said_of(Rail("friction", 0.9, 0.0, "time"))
