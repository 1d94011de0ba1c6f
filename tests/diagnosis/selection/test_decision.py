"""From a search to a result: what is named with which interval, its rivals, and when something is unknown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis, joined
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.evidence import Evidence
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult, is_at_bound
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.search import Search, StoppingCriteria
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult

MISSING = Kind.MISSING_PHYSICS


def decided(model: waves.Waves, *candidates: waves.Candidate, cheap: bool = True) -> SubsystemResult[waves.Waves]:
    search = Search(model, (), candidates, cheap=cheap)
    return decide("piston", model, search.fits, search.run())


def test_what_is_there_is_named_with_an_interval_that_holds_it() -> None:
    result = decided(waves.Waves(slow=3.0), waves.BASE, waves.OTHER)
    (finding,) = result.findings
    (estimate,) = finding.parameters.values()
    assert (finding.name, finding.where, result.has_unknown) == ("base", "piston", False)
    assert estimate.low < 3.0 < estimate.high and estimate.high - estimate.low < 1.0
    assert finding.log10_odds > 20.0 and finding.ambiguous_with == ()


def test_of_two_names_for_the_same_wave_both_are_reported_with_their_probabilities() -> None:
    result = decided(waves.Waves(slow=3.0), waves.BASE, waves.candidate("twin", "slow"))
    (finding,) = result.findings
    assert {finding.name, *finding.ambiguous_with} == {"base", "twin"}
    assert list(finding.probabilities.values()) == pytest.approx([0.5, 0.5], abs=0.01)


def test_a_rejected_candidate_is_listed_once_and_no_finding_is() -> None:
    result = decided(waves.Waves(slow=3.0), waves.BASE, waves.OTHER)
    assert [(one.name, one.where) for one in result.rejected] == [("other", "piston")]


def test_what_was_left_out_for_it_strains_other_numbers_is_listed_with_that_reason() -> None:
    model = waves.Waves(slow=3.0)
    search = Search(model, (), (waves.BASE,), cheap=True)
    found = decide("piston", model, search.fits, replace(search.run(), straining=(waves.OTHER,)))
    assert [(one.name, one.why) for one in found.rejected] == [("other", wording.STRAINING)]


@pytest.mark.parametrize("is_law", [True, False])
def test_what_fits_worse_in_the_place_of_a_law_is_not_said(is_law: bool) -> None:
    """Of how a law is written nobody reads: it is no finding."""
    result = decided(waves.Waves(slow=3.0), replace(waves.BASE, is_law=is_law), waves.OTHER)
    assert any("in place of base" in one.why for one in result.rejected) is not is_law


@pytest.mark.parametrize(("bound", "unknown"), [(1.5, True), (1e9, False)])
def test_more_than_a_healthy_machine_leaves_is_unknown(bound: float, unknown: bool) -> None:
    result = decided(waves.Waves(bound, slow=6.0, quick=6.0), waves.candidate("nothing", "level"))
    assert result.has_unknown is unknown and result.findings == ()


def test_a_dip_that_is_narrower_than_the_slowest_motion_has_a_size() -> None:
    breakaway = FreeParameter("stribeck_friction", "piston", "breakaway", "N", Target.CYLINDER, 1.0, 0.0, 1e5)
    velocity = FreeParameter("stribeck_friction", "piston", "velocity", "m/s", Target.CYLINDER, 0.01, 0.012, 0.1)
    dip = Candidate("stribeck_friction", "piston", "breakaway+velocity", (breakaway, velocity), ((1.0, 0.02),))
    for force, at_bound in ((30.0, False), (1e5, True)):
        values = {breakaway: force, velocity: 0.012}
        assert is_at_bound(dip, FittedModel.at(values, (dip,))) is at_bound


@pytest.mark.parametrize(("wave", "unknown"), [("slow", False), ("quick", True)])
def test_what_laws_of_healthy_machines_get_wrong_is_nothing_unknown(wave: str, unknown: bool) -> None:
    """A law that may be wrong by a slow wave explains that one, however large a share it is of what is left, and no other."""

    class Bent(waves.Waves):
        def healthy_discrepancy(self, plant: PlantParameters) -> DiscrepancyBasis:
            return joined([("law", waves.SHAPES["slow"][:, None], 6.0)], waves.AT.size)

    result = decided(Bent(1.5, waves.SHAPES, **{wave: 6.0}), waves.candidate("nothing", "level"))
    assert result.has_unknown is unknown


def test_beside_something_unknown_only_what_is_beyond_doubt_is_named() -> None:
    plain = decided(waves.Waves(1.5, slow=9.5, quick=4.0), waves.BASE)
    assert plain.has_unknown and plain.named == () and plain.final.candidates == ()
    assert any("beside something without a name" in one.why for one in plain.rejected)


@pytest.mark.parametrize(
    ("wave", "kind", "named"), [("slow", MISSING, ["base"]), ("burst", MISSING, []), ("slow", Kind.SENSOR, [])]
)
def test_beside_something_unknown_a_name_stands_that_time_kept_back_surely_bears_out(wave: str, kind: Kind, named: list[str]) -> None:
    """A wave gains in every block of it, a burst in one, however high its odds are; what a sensor is off by may be any of both."""
    shapes = {**waves.SHAPES, "burst": np.where((waves.AT >= 80.0) & (waves.AT < 120.0), 1.0, 0.0)}
    model, one = waves.Waves(1.5, shapes, **{wave: 9.5, "quick": 4.0}), replace(waves.candidate("base", wave), kind=kind)
    fits = ModelFits(model, ())
    bare = fits.refined(fits.fit(()))
    final = fits.refined(fits.fit((one,), bare))
    evidence = Evidence(log10_odds=99.0, gain=230.0, share=0.6, steady=1.0)
    search = SearchResult(bare, final, {one.key: evidence})
    result = decide("piston", model, fits, search, Split({}, {"recording": ((0.0, 400.0),)}))
    assert result.has_unknown
    assert [finding.name for finding in result.findings] == named == [c.effect for c in result.final.candidates]
    assert decide("piston", model, fits, search).findings == ()  # nothing was kept back


def test_of_two_that_stand_in_for_each_other_beside_something_unknown_one_stands() -> None:
    """Beside the other neither is missed on held-out time; without both it is predicted far worse."""
    shapes = {**waves.SHAPES, "nearly": waves.SHAPES["slow"] + 0.02 * waves.SHAPES["quicker"]}
    model, both = waves.Waves(1.5, shapes, slow=9.5, quick=4.0), (waves.BASE, waves.candidate("second", "nearly"))
    fits = ModelFits(model, ())
    bare = fits.refined(fits.fit(()))
    final = fits.refined(fits.fit(both, bare))
    evidence = Evidence(log10_odds=99.0, gain=230.0, share=0.6, steady=1.0)
    search = SearchResult(bare, final, {one.key: evidence for one in both})
    result = decide("piston", model, fits, search, Split({}, {"recording": ((0.0, 400.0),)}))
    assert result.has_unknown and len(result.findings) == 1
    assert result.final.fit.sse < 0.5 * bare.fit.sse


def test_an_interrupted_search_is_not_judged_but_handed_on() -> None:
    """However much it leaves unexplained: the other subsystems go on with what was found so far."""
    model = waves.Waves(1e-3, slow=9.0, quick=4.0)
    search = Search(model, (), (waves.BASE, waves.ON_TOP, waves.OTHER), stopping=StoppingCriteria(until=lambda fitted: True))
    found = search.run()
    assert found.interrupted
    result = decide("piston", model, search.fits, found)
    assert (result.named, result.final, result.has_unknown, result.findings) == (found.final.candidates, found.final, False, ())


def test_too_few_rows_give_an_empty_result() -> None:
    model = waves.Waves(slow=3.0)
    model.blocks = model.blocks[:20]
    assert decided(model, waves.BASE).is_empty


@pytest.mark.parametrize(("size", "named"), [(12.0, False), (8.0, True)])
def test_what_only_an_effect_at_its_bound_explains_is_unknown(size: float, named: bool) -> None:
    model, leak = waves.Waves(1.5, slow=size), waves.candidate("piston_leakage", "slow")
    fits = ModelFits(model, ())
    bare = fits.refined(fits.fit(()))
    result = decide("piston", model, fits, SearchResult(bare, fits.refined(fits.fit((leak,), bare))))
    assert [one.name for one in result.findings] == (["piston_leakage"] if named else [])
    assert result.has_unknown is not named
    assert result.final.candidates == ((leak,) if named else ())


@pytest.mark.parametrize(("area", "at_bound"), [(1e-8, True), (1.005e-8, True), (3e-6, False), (1e-3, True)])
def test_a_number_that_ended_at_a_bound_was_not_found(area: float, at_bound: bool) -> None:
    one = FreeParameter("line_restriction", "piston", "area", "m^2", Target.CYLINDER, 1e-5, 1e-8, 1e-3, logarithmic=True)
    hose = Candidate("line_restriction", "piston", "area", (one,), ((1e-5,),))
    assert is_at_bound(hose, FittedModel((hose,), Fit((one,), {one: area}, np.zeros(3), np.zeros((3, 1))))) is at_bound


@pytest.mark.parametrize(("ratio", "named"), [(0.3, True), (0.52, False), (0.56, False)])
def test_nothing_chokes_at_a_greater_ratio_than_a_nozzle(ratio: float, named: bool) -> None:
    """A ratio that is greater mends something else, and is no finding."""
    model = waves.Waves(1e9, slow=4.0)
    one = FreeParameter("critical_ratio", "piston", "critical_ratio.slow", "1", Target.SENSOR, 0.1, 0.02, 0.6)
    valve = Candidate("critical_ratio", "piston", "ratio", (one,), ((0.3,),))
    fits = ModelFits(model, ())
    bare = fits.refined(fits.fit(()))
    fitted = FittedModel((valve,), Fit((one,), {one: ratio}, model.residual({one: ratio}), waves.SHAPES["slow"][:, None]))
    result = decide("piston", model, fits, SearchResult(bare, fitted))
    assert [found.name for found in result.findings] == (["critical_ratio"] if named else [])


def test_an_amount_that_ended_at_nothing_is_not_at_a_bound() -> None:
    one = FreeParameter("piston_leakage", "piston", "area", "m^2", Target.CYLINDER, 1e-8, 0.0, 1e-4)
    leak = Candidate("piston_leakage", "piston", "area", (one,), ((1e-8,),))
    assert not is_at_bound(leak, FittedModel((leak,), Fit((one,), {one: 0.0}, np.zeros(3), np.zeros((3, 1)))))


@pytest.mark.parametrize(("area", "at_bound"), [(1e-4, True), (2e-5, False)])
def test_a_hole_as_large_as_the_piston_is_at_a_bound_whatever_a_healthy_machine_leaks(area: float, at_bound: bool) -> None:
    one = FreeParameter("piston_leakage", "piston", "area", "m^2", Target.CYLINDER, 1e-8, 0.0, 1e-4, healthy_limit=1e-9)
    leak = Candidate("piston_leakage", "piston", "area", (one,), ((1e-8,),))
    assert is_at_bound(leak, FittedModel((leak,), Fit((one,), {one: area}, np.zeros(3), np.zeros((3, 1))))) is at_bound


@pytest.mark.parametrize(("size", "named"), [(0.5, ["base"]), (8.0, ["base", "shelf"])])
def test_beside_something_unknown_the_interval_of_a_name_lies_beyond_what_a_healthy_machine_shows(size: float, named: list[str]) -> None:
    model = waves.Waves(1.5, slow=6.0, quick=6.0, level=size)
    shelf = waves.candidate("shelf", "level")
    shelf = replace(shelf, parameters=tuple(replace(q, healthy_limit=0.3) for q in shelf.parameters))
    fits = ModelFits(model, ())
    bare = fits.refined(fits.fit(()))
    result = decide("piston", model, fits, SearchResult(bare, fits.refined(fits.fit((waves.BASE, shelf), bare)), weighed_together=True))
    assert result.has_unknown
    assert [one.name for one in result.findings] == named == [c.effect for c in result.final.candidates]


@pytest.mark.parametrize(("softest", "named"), [(2.09, []), (4.0, ["presliding"])])
def test_a_contact_that_may_be_as_firm_as_any_is_no_finding(softest: float, named: list[str]) -> None:
    """Its number is what was fitted, but the interval reaches the stiffness from which on every contact has it."""
    stiffness = FreeParameter("presliding", "piston", "stiffness", "1", Target.SENSOR, 1.0, -10.0, softest)
    contact = Candidate("presliding", "piston", "stiffness", (stiffness,), ((1.0,),))
    model = waves.Waves(shapes={"stiffness": waves.SHAPES["slow"]}, stiffness=2.0)
    fits = ModelFits(model, ())
    bare = fits.refined(fits.fit(()))
    result = decide("piston", model, fits, SearchResult(bare, fits.refined(fits.fit((contact,), bare))))
    assert [one.name for one in result.findings] == named
    assert result.final.fit.values[stiffness] == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize(("beyond", "named"), [(3.0, True), (1.0, False), (-1.0, False)])
def test_a_leak_is_named_where_its_interval_lies_beyond_what_healthy_seals_lose(beyond: float, named: bool) -> None:
    """One standard error beyond that is more than healthy, and not surely: whatever the odds, which a leak of that size has."""
    model, one = waves.Waves(1e9, slow=4.0), waves.candidate("piston_leakage", "slow")
    fits = ModelFits(model, ())
    bare = fits.refined(fits.fit(()))
    alone = fits.refined(fits.fit((one,), bare))
    ((parameter, error),) = fits.standard_errors(alone).items()
    limit = alone.fit.values[parameter] - beyond * error
    leak, fits = replace(one, parameters=(replace(parameter, healthy_limit=limit),)), ModelFits(model, ())
    result = decide("piston", model, fits, SearchResult(bare, fits.refined(fits.fit((leak,), bare)), weighed_together=True))
    assert [finding.name for finding in result.findings] == (["piston_leakage"] if named else [])


@pytest.mark.parametrize(("width", "named"), [(6.0, ["valve_deadband", "valve_edges"]), (2.05, ["valve_edges"]), (0.0, ["valve_edges"])])
def test_a_dead_band_beneath_edges_that_differ_is_named_where_their_mean_is_surely_one(width: float, named: list[str]) -> None:
    """A healthy one has up to 2. How much of an edge is its own nothing tells; the mean of all is known to 0.05."""
    at, differ = np.repeat(np.arange(4), 100), {"supply_1": 5.0, "exhaust_1": -5.0, "supply_2": 4.0, "exhaust_2": -4.0}
    shapes = {f"overlap_{edge}": np.where(at == k, 1.0, 0.0) for k, edge in enumerate(differ)} | {"width": np.ones(400)}
    sizes = {f"overlap_{edge}": size for edge, size in differ.items()} | {"width": width}

    def number(effect: str, name: str, most: float) -> FreeParameter:
        return FreeParameter(effect, "piston", name, "1", Target.SENSOR, 1.0, -10.0, 10.0, (0.0, 5.0), healthy_limit=most)

    band = Candidate("valve_deadband", "piston", "width", (number("valve_deadband", "width", 2.0),), ((1.0,),))
    overlaps = tuple(number("valve_edges", name, 3.0) for name in shapes if name != "width")
    edges = Candidate("valve_edges", "piston", "overlaps", overlaps, ((0.1,) * 4,), prerequisite="valve_deadband", is_law=True)
    model = waves.Waves(shapes=shapes, **sizes)
    fits = ModelFits(model, ())
    found = decide("piston", model, fits, SearchResult(fits.fit(()), fits.refined(fits.fit((band, edges)))))
    assert sorted(finding.name for finding in found.findings) == named
