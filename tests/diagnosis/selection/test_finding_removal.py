"""What is left where findings are put aside: numbers that were found beside them are found anew."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.finding_removal import open_to, without_findings
from exo_sim.diagnosis.selection.fitted_model import SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisance_calibration import Deviation
from exo_sim.diagnosis.selection.search import Search
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult

#: A wave that is for the most part the slow one.
NEAR = waves.SHAPES["slow"] + 0.5 * waves.SHAPES["quick"]
LIKE = waves.candidate("like", "near")
#: What an interval gains to either side where its number moved by one and the name that moved it is as likely right as wrong.
MOVED = 0.5**0.5 * HALF_WIDTH


def result(bound: float) -> SubsystemResult[waves.Waves]:
    model = waves.Waves(bound, shapes={**waves.SHAPES, "near": NEAR}, slow=3.0, near=2.0)
    search = Search(model, (), (waves.BASE, LIKE), cheap=True)
    found = decide("piston", model, search.fits, search.run())
    assert {finding.name for finding in found.findings} == {"base", "like"}
    return found


def test_the_numbers_of_the_others_are_found_anew() -> None:
    found = without_findings(result(bound=10.0), {LIKE.at})
    (finding,) = found.findings
    (estimate,) = finding.parameters.values()
    slow = waves.SHAPES["slow"]
    assert estimate.value == pytest.approx(3.0 + 2.0 * float(slow @ NEAR) / float(slow @ slow), abs=0.3)
    assert found.final.named == {waves.BASE.at} and {c.at for c in found.named} == {waves.BASE.at}
    assert np.mean(found.final.fit.residual**2) > 1.2
    assert estimate.low < 3.0 < estimate.value < estimate.high  # as it was beside what may be right all the same


def test_where_the_rest_alone_leaves_something_unknown_only_the_names_go() -> None:
    before = result(bound=1.0)
    found = without_findings(before, {waves.BASE.at, LIKE.at})
    assert found.findings == ()
    assert found.final is before.final and not found.has_unknown


def test_where_only_a_name_goes_a_dead_volume_holds_again_what_was_counted_in_it() -> None:
    dead = FreeParameter(DEAD_VOLUME, "piston", "dead_volume_1", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.15), neutral=1.0)
    counted = Deviation(dead, 0.2, 0.02, counted_in="like", with_it=1.5)
    before = replace(result(bound=1.0), deviations=(counted,))
    (kept,) = without_findings(before, {waves.OTHER.at}).deviations
    assert kept is counted
    (back,) = without_findings(before, {waves.BASE.at, LIKE.at}).deviations
    assert back.factor == 1.5


def _friction(effect: str, *numbers: str) -> Candidate:
    parameters = tuple(replace(waves.parameter(effect, "", low=0.0), parameter=name) for name in numbers)
    return Candidate(effect, "piston", "+".join(numbers), parameters, ((1.0,) * len(numbers),))


@pytest.mark.parametrize(("backward", "left"), [(9.0, "coulomb_friction"), (6.0, "asymmetric_friction")])
def test_two_levels_of_friction_that_are_alike_without_the_rest_are_one(backward: float, left: str) -> None:
    outward = np.sin(waves.AT / 7.0) > 0.0
    shapes = {**waves.SHAPES, "near": NEAR, "forward": 1.0 * outward, "backward": -1.0 * ~outward, "force": np.where(outward, 1.0, -1.0)}
    model = waves.Waves(10.0, shapes, forward=9.0, backward=backward, near=0.5)
    apart, plain = _friction("asymmetric_friction", "forward", "backward"), _friction("coulomb_friction", "force")
    fits = ModelFits(model, (), cheap=True)
    bare, final = (fits.refined(fits.fit(names)) for names in ((), (apart, LIKE)))
    found = decide("piston", model, fits, SearchResult(bare, final, rivals={apart.key: [(plain, 25.0)]}))
    assert {c.effect for c in without_findings(found, {LIKE.at}).final.candidates} == {left}


def test_a_name_that_is_not_there_changes_nothing() -> None:
    before = result(bound=10.0)
    after = without_findings(before, {waves.OTHER.at})
    assert after.findings == before.findings and after.final is before.final


def of(value: float, low: float, high: float) -> Finding:
    return Finding("viscous_friction", "piston", Kind.MISSING_PHYSICS, "", {"coefficient": Estimate(value, "N*s/m", low, high)}, 9.0, 0.5)


@pytest.mark.parametrize(
    ("anew", "before", "low", "high"),
    [
        ((10.0, 9.0, 11.0), (10.0, 9.0, 11.0), 9.0, 11.0),
        ((10.0, 9.0, 11.0), (6.0, 5.5, 6.5), 10.0 - math.hypot(1.0, MOVED * 4.0), 10.0 + math.hypot(1.0, MOVED * 4.0)),
        ((10.0, 9.0, 11.0), (10.0, 7.0, 14.0), 7.0, 14.0),
        ((10.0, 9.0, 11.0), (30.0, 29.0, 31.0), 0.0, 10.0 + math.hypot(1.0, MOVED * 20.0)),
    ],
    ids=["unmoved", "moved", "was less known", "not below nil"],
)  # fmt: skip
def test_an_interval_carries_what_a_number_was_beside_what_was_put_aside(
    anew: tuple[float, float, float], before: tuple[float, float, float], low: float, high: float
) -> None:
    estimate = open_to(of(*anew), of(*before)).parameters["coefficient"]
    assert (estimate.value, estimate.low, estimate.high) == pytest.approx((anew[0], low, high))
