"""Errors on held-out time: before and after, and what each finding is worth."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves
from scipy import stats

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.findings import SignalFit, Subsystem
from exo_sim.diagnosis.policy.validation import BEYOND_HEALTHY, FEWEST_CHANGED, LEAST_INFLUENCE
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.finding_removal import without_findings
from exo_sim.diagnosis.selection.held_out_gain import HeldOutGain
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.search import Search
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import unknown_effects
from exo_sim.diagnosis.validation.held_out import _amplitude, _beyond, held_out_errors
from exo_sim.diagnosis.validation.held_out_errors import BalanceError, HeldOutErrors
from exo_sim.recording.noise import by_chance

SPLIT = Split({"recording": ((0.0, 400.0),)})


def result(model: waves.Waves, *candidates: waves.Candidate) -> SubsystemResult[waves.Waves]:
    search = Search(model, (), candidates, cheap=True)
    return decide("piston", model, search.fits, search.run())


def test_a_true_finding_takes_the_error_down_to_the_noise() -> None:
    one = result(waves.Waves(slow=3.0), waves.BASE)
    errors = held_out_errors([one], (), SPLIT)
    assert errors.series and held_out_errors([one], (), SPLIT, keep_series=False) == replace(errors, series=())
    signal = errors.signals["piston.pressure_1"]
    size = math.sqrt(1.0 + 9.0 * float(np.mean(waves.SHAPES["slow"] ** 2)))
    assert signal.before == pytest.approx(size, rel=0.05) and signal.after == pytest.approx(1.0, rel=0.06)
    assert errors.drops["base@piston"] == pytest.approx(1.0 - signal.after / signal.before, rel=1e-6)
    assert errors.influence["base@piston"] == pytest.approx(math.sqrt(size**2 - 1.0), rel=0.05)
    assert errors.balances[Subsystem.GAS, "piston"].ratio == pytest.approx(1.0, abs=0.05)
    weights = waves.SHAPES["slow"] ** 2
    acting = math.sqrt(1.0 + 9.0 * float(weights @ weights / weights.sum()))  # larger than over all rows: it is where the wave is
    acting /= math.sqrt(by_chance(float(weights.sum()) ** 2 / float(weights @ weights)))
    assert errors.where_acting["base@piston"] == pytest.approx(acting, rel=0.05)
    assert errors.beyond_healthy == {}  # nobody knows what healthy waves are like
    assert errors.spans == SPLIT.test


def test_what_stays_as_parts_that_healthy_machines_may_each_have_is_held_to_what_a_healthy_machine_has() -> None:
    """Two parts of up to 1 each stay where a candidate is left out, of a quantity of which a healthy machine has 1."""

    def part(name: str, most: float, healthy: float = 0.0) -> FreeParameter:
        prior = None if healthy else (0.0, 1.0)
        return FreeParameter("late", "piston", f"late.{name}", "1", Target.SENSOR, 1.0, -most, most, prior, healthy_limit=healthy)

    asked, size = part("slow", 10.0, healthy=1.0), 6.0
    candidate = waves.Candidate("late", "piston", "slow", (asked,), ((1.0,),), additive=True)
    model = waves.Waves(shapes={**waves.SHAPES, "again": waves.SHAPES["slow"]}, slow=size)
    found = Search(model, (part("slow", 1.0), part("again", 1.0)), (candidate,), cheap=True).run()
    one = decide("piston", model, ModelFits(model, (part("slow", 1.0), part("again", 1.0)), cheap=True), found)
    assert [finding.name for finding in one.findings] == ["late"]
    errors = held_out_errors([one], (), SPLIT)
    without = np.sqrt(1.0 + (size - 1.0) ** 2 * np.mean(waves.SHAPES["slow"] ** 2))
    assert errors.drops["late@piston"] == pytest.approx(1.0 - 1.0 / without, abs=0.03)
    assert errors.gains["late@piston"].is_shown and "late@piston" in errors.costs
    assert "late@piston" not in errors.left  # it is not gone: that says nothing of how small it may be


def test_one_row_of_many_is_not_beyond_what_healthy_laws_get_wrong() -> None:
    change = np.full(10000, 0.1)
    change[0] = 10.0
    found = _beyond(change, np.full(change.size, 3.0))
    assert found is not None and found < BEYOND_HEALTHY
    alone = np.where(change > 1.0, change, 0.0)
    assert _beyond(alone, np.full(change.size, 3.0)) == pytest.approx(10.0 / 3.0 / math.sqrt(FEWEST_CHANGED))
    change[:20] = 10.0
    assert _beyond(change, np.full(change.size, 3.0)) == pytest.approx(10.0 / 3.0, rel=0.05)
    assert _beyond(np.zeros(3), np.ones(3)) is _beyond(np.ones(3), np.zeros(3)) is None


def test_a_change_is_held_against_what_healthy_laws_get_wrong_where_it_is() -> None:
    class Rough(waves.Waves):
        def healthy_misfit(self) -> waves.Array:
            return np.full(self.size, 0.5)

    one = result(Rough(slow=3.0), waves.BASE)
    weights = waves.SHAPES["slow"] ** 2
    found = held_out_errors([one], (), SPLIT).beyond_healthy["base@piston"]
    assert found == pytest.approx(3.0 * math.sqrt(float(weights @ weights / weights.sum())) / 0.5, rel=0.05)


def test_each_of_two_findings_is_worth_what_is_lost_without_it() -> None:
    errors = held_out_errors([result(waves.Waves(slow=3.0, quicker=0.6), waves.BASE, waves.OTHER)], (), SPLIT)
    assert errors.drops["base@piston"] > 0.5 > errors.drops["other@piston"] > 0.03
    assert all(one.share > 0.6 for one in errors.gains.values())  # little of the error, but of what is missing nearly all


def test_what_changes_only_what_is_within_the_noise_is_not_tested() -> None:
    class Quiet(waves.Waves):
        def residual_of(self, plant: PlantParameters) -> waves.Array:
            return 0.3 * super().residual_of(plant)

    found = result(waves.Waves(slow=3.0), waves.BASE)
    (at,) = held_out_errors([found], (), SPLIT).gains
    quiet = held_out_errors([replace(found, model=Quiet(slow=3.0))], (), SPLIT)
    assert quiet.influence[at] > LEAST_INFLUENCE and at in quiet.gains and quiet.tested == {}


def test_what_held_out_time_does_not_show_is_looked_at_where_it_acted_before() -> None:
    class Still(waves.Waves):
        def residual_of(self, plant: PlantParameters) -> waves.Array:
            return super().residual_of(self.nominal)

    found = result(waves.Waves(slow=3.0), waves.BASE)
    seen = held_out_errors([found], (), SPLIT)
    untested = held_out_errors([replace(found, model=Still(slow=3.0))], (), SPLIT)
    assert untested.influence == {"base@piston": 0.0} and untested.gains == {}
    assert untested.where_acting["base@piston"] == pytest.approx(seen.where_acting["base@piston"], rel=0.05)


def test_how_much_nearer_to_their_data_sheets_numbers_are_with_a_finding_is_kept() -> None:
    found = held_out_errors([result(waves.Waves(slow=3.0), waves.BASE)], (), SPLIT)
    assert found.relief == {"base@piston": 0.0}  # waves have no such numbers


def test_a_later_look_takes_the_place_of_the_first_and_what_was_put_aside_goes() -> None:
    whole = result(waves.Waves(slow=3.0, quicker=0.6), waves.BASE, waves.OTHER)
    first = held_out_errors([whole], (), SPLIT)
    later = held_out_errors([without_findings(whole, {waves.OTHER.at})], (), SPLIT)
    both = first.updated(later, ["other@piston"])
    assert set(both.drops) == set(both.gains) == set(both.influence) == set(both.costs) == {"base@piston"}
    assert set(both.left) == set(both.where_acting) == {"base@piston"}
    assert both.left == later.left != first.left
    assert both.signals == later.signals and both.balances == later.balances and both.series == later.series
    assert both.signals["piston.pressure_1"].after > first.signals["piston.pressure_1"].after
    nothing = first.updated(HeldOutErrors(), [])
    assert nothing.drops == first.drops and nothing.gains == first.gains and nothing.series == first.series


def test_an_unknown_effect_that_no_curve_describes_lowers_nothing() -> None:
    one = result(waves.Waves(1.5, slow=6.0, quick=6.0), waves.candidate("nothing", "level"))
    unknown = unknown_effects([one])
    errors = held_out_errors([one], unknown, SPLIT)
    assert errors.drops == {"piston": 0.0}
    assert errors.balances[Subsystem.GAS, "piston"].log10_odds > 3.0


def test_nor_does_one_that_no_plant_can_hold_take_the_credit_of_numbers_that_were_refitted() -> None:
    class Forces(waves.Waves):
        plant_holds_curves = False

    one = result(Forces(slow=9.0), waves.BASE)
    stands = replace(one, has_unknown=True)
    errors = held_out_errors([stands], unknown_effects([stands]), SPLIT)
    signal = errors.signals["piston.pressure_1"]
    assert signal.after < 0.2 * signal.before and errors.drops["piston"] == 0.0


def test_a_curve_for_what_has_no_name_is_not_to_a_name_s_credit() -> None:
    """It fits held-out time as well as nothing does; the name is worth what it is worth without it."""

    class Curved(waves.Waves):
        def with_unknown(self, plant: PlantParameters, discrepancy: Discrepancy) -> PlantParameters:
            return replace(plant, sensors={**plant.sensors, "unknown.quick": 4.0})

    one = result(Curved(1.5, slow=9.5, quick=4.0), waves.BASE)
    final, findings = one.search.final, result(waves.Waves(slow=9.5), waves.BASE).findings
    stands = replace(one, final=final, named=final.candidates, findings=findings)
    assert stands.has_unknown
    plain = held_out_errors([stands], (), SPLIT)
    curved = held_out_errors([stands], unknown_effects([stands]), SPLIT)
    assert curved.balances[Subsystem.GAS, "piston"].error < 0.5 * plain.balances[Subsystem.GAS, "piston"].error
    assert curved.gains == plain.gains and curved.drops["base@piston"] == plain.drops["base@piston"]


def test_where_nothing_was_compared_the_ratio_is_infinite() -> None:
    assert HeldOutErrors().ratio == math.inf
    assert held_out_errors([], (), SPLIT).signals == {}


def test_a_balance_lacks_something_where_it_misses_more_than_healthy_machines_and_than_its_fit_by_times() -> None:
    """Of what could not be compared nobody knows; of what the fit misses as much as held-out time no other division tells more."""
    signals = {"piston.pressure_1": SignalFit("Pa", 2.0, 1.0, 1.0)}

    def lacks(error: float, fitted: float, bound: float) -> bool:
        return HeldOutErrors(signals, balances={(Subsystem.GAS, "piston"): BalanceError(error, fitted, bound, 1.0)}).lacks(3.0)

    assert lacks(20.0, 2.0, 5.0) and not lacks(20.0, 10.0, 5.0) and not lacks(20.0, 2.0, 25.0)
    assert HeldOutErrors().lacks(3.0) and not HeldOutErrors(signals).lacks(3.0)


def test_an_error_counts_against_the_fit_and_the_bound() -> None:
    one = BalanceError(error=6.0, fitted=2.0, bound=5.0, log10_odds=9.0)
    assert one.ratio == 3.0 and one.exceeds_bound() and not one.exceeds_bound(1.25) and one.newly_exceeds_bound()
    assert not BalanceError(6.0, 5.5, 5.0, 9.0).newly_exceeds_bound()
    assert BalanceError(0.9, 0.3, 5.0, 0.0).ratio == 0.9  # less than the noise is no better a fit
    assert BalanceError(math.nan, 1.0, 5.0, 0.0).ratio == 0.0


@pytest.mark.parametrize(
    ("gained", "missing", "share"), [(24.0, 24.0, 1.0), (16.0, 24.0, 2.0 / 3.0), (0.2, -0.2, 1.0), (-9.0, 15.0, 0.0), (math.nan, 1.0, 0.0)]
)
def test_a_share_is_of_what_is_missing_beyond_the_noise(gained: float, missing: float, share: float) -> None:
    assert HeldOutGain(gained, missing).share == pytest.approx(share)


@pytest.mark.parametrize(
    ("amplitude", "error", "against"),
    [
        (0.02, 0.1, True),  # it is not there
        (-3.5, 1.1, True),  # the contrary is
        (0.3, 0.05, True),  # a third of it: it stands in for something else
        (0.63, 0.08, False),  # most of it is there
        (0.5, 0.67, False),  # neither nil nor all of it can be told
        (0.55, 0.21, False),  # as near to all of it as to nil, though neither is compatible
        (1.0, 0.01, False),
        (0.0, 0.0, True),  # nobody looked
    ],
)
def test_a_small_share_speaks_against_what_time_kept_back_could_show_and_does_not(amplitude: float, error: float, against: bool) -> None:
    assert HeldOutGain(3.0, 100.0, True, amplitude, error).speaks_against is against
    assert not HeldOutGain(3.0, 100.0, False, amplitude, error).speaks_against  # nothing is missing but noise


@pytest.mark.parametrize("sign", [0.0, 3.0])
@pytest.mark.parametrize("there", [1.0, 0.0, 0.4])
def test_the_amplitude_of_a_change_is_what_least_squares_finds_of_it_with_an_error_that_counts_neighbours_once(
    there: float, sign: float
) -> None:
    """Also of one that has the same sign throughout, as friction of a slow stroke has, and whatever there is of it."""
    rng = np.random.default_rng(8)
    blocks = np.repeat(np.arange(24), 250)
    found, errors = [], []
    for _ in range(60):
        change = np.repeat(sign + rng.standard_normal(300), 20)  # what differs lasts for twenty rows
        slow = np.repeat(rng.standard_normal(300), 20)
        amplitude, error, _ = _amplitude(slow - (1.0 - there) * change, change, blocks)
        found.append(amplitude)
        errors.append(error)
    assert np.mean(found) == pytest.approx(there, abs=0.03)
    assert np.mean(errors) == pytest.approx(np.std(found), rel=0.3)


def test_of_a_change_that_is_no_number_nothing_is_told() -> None:
    assert _amplitude(np.ones(10), np.full(10, np.inf), np.zeros(10, dtype=np.int64)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("there", "least", "most"), [(1.0, 10.0, 300.0), (0.5, -6.0, 6.0), (0.0, -300.0, -10.0)])
def test_held_out_time_changes_the_odds_by_how_much_of_a_change_is_there(there: float, least: float, most: float) -> None:
    rng = np.random.default_rng(3)
    change, blocks = 0.5 * rng.standard_normal(4000), np.repeat(np.arange(20), 200)
    odds = _amplitude(rng.standard_normal(4000) - (1.0 - there) * change, change, blocks)[2]
    assert least < odds < most


def test_a_change_in_one_block_of_time_does_not_change_the_odds() -> None:
    """How far such a number varies from block to block nobody knows."""
    rng = np.random.default_rng(4)
    blocks = np.repeat(np.arange(20), 200)
    change = np.where(blocks == 7, 3.0, 0.0)
    assert _amplitude(rng.standard_normal(4000) - change, change, blocks)[2] == 0.0


def test_of_two_blocks_their_rows_say_how_surely_a_change_is_not_there() -> None:
    """Student's distribution of one degree of freedom took a decade and a half at most; how far both blocks differ still counts."""
    rng = np.random.default_rng(4)
    blocks = np.repeat(np.arange(20), 200)
    few = np.where((blocks == 7) | (blocks == 9), 3.0, 0.0)
    noise = rng.standard_normal(4000)
    assert _amplitude(noise - few, few, blocks)[2] < -5.0
    assert _amplitude(noise, few, blocks)[2] > 5.0
    differing = noise - np.where(blocks == 7, 1.0, 0.0) * few  # all of it in one, none of it in the other
    assert abs(_amplitude(differing, few, blocks)[2]) < 1.0


def odds_of(amplitude: float, away: np.ndarray) -> float:
    """Return the odds of so much of a change of 1 in every block, one row each, that is off by `away` there; their mean is nil."""
    change = np.ones(away.size)
    found, _, odds = _amplitude((amplitude - 1.0) * change + away, change, np.arange(away.size))
    assert found == pytest.approx(amplitude)
    return odds


ALTERNATING = 3.0 * (-1.0) ** np.arange(6)


def test_blocks_that_differ_say_how_far_the_amplitude_varies() -> None:
    spread = 3.0 / math.sqrt(5.0)  # the standard error of a mean of six values whose deviation is estimated
    expected = stats.t.logpdf(0.2 / spread, 5) - stats.t.logpdf(0.8 / spread, 5)
    assert odds_of(0.8, ALTERNATING) == pytest.approx(expected / math.log(10.0), rel=1e-6)


@pytest.mark.parametrize("far", [-0.5, -5.0, -19.0])
def test_the_contrary_of_a_change_speaks_against_it_no_less_than_nothing_of_it_and_more_than_all_of_it_for_it(far: float) -> None:
    assert odds_of(far, ALTERNATING) == pytest.approx(odds_of(0.0, ALTERNATING)) and odds_of(0.0, ALTERNATING) < 0.0
    assert odds_of(1.0 - far, ALTERNATING) == pytest.approx(odds_of(1.0, ALTERNATING)) and odds_of(1.0, ALTERNATING) > 0.0


def test_blocks_that_are_off_as_the_one_before_them_count_as_fewer() -> None:
    slow = 3.0 * np.sin(2.0 * np.pi * (np.arange(20) + 0.5) / 20.0)
    mixed = slow[np.random.default_rng(1).permutation(20)]
    assert 0.0 < odds_of(1.0, slow) < 0.4 * odds_of(1.0, mixed)
    assert 0.4 * odds_of(0.0, mixed) < odds_of(0.0, slow) < 0.0
