"""What one improved rig is worth on held-out time."""

from __future__ import annotations

import math

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.outcome.rig_update import Part, Rank, RigUpdate
from exo_sim.diagnosis.pipeline.rig_trial import Trial, is_worse, straying_further, uncertainty
from exo_sim.diagnosis.policy.budgets import MOST_TRIALS
from exo_sim.rig import EffectEntry, EffectSetting, Rig


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("trial"))


@pytest.mark.parametrize(
    ("after", "worse"),
    [((0.5, 0.9), False), ((1.0, 1.0), False), ((2.0, 0.4), False), ((2.0, 0.6), True), ((0.1, math.nan), True), ((1.01, 1.0), True)],
)
def test_all_signals_together_may_not_be_worse(after: tuple[float, float], worse: bool) -> None:
    runs = {name: SignalFit("Pa", 1.0, value, 0.0) for name, value in zip("ab", after, strict=True)}
    assert is_worse(runs, {}) is worse


def test_what_could_not_be_run_before_either_says_nothing() -> None:
    assert not is_worse({}, {}) and not is_worse({"a": SignalFit("Pa", math.nan, math.nan, 0.0)}, {})


def test_a_signal_that_neither_run_predicts_says_nothing() -> None:
    lost = {"slide.position": SignalFit("m", 0.031, 0.034, 1e-5), "piston.pressure_1": SignalFit("Pa", 2600.0, 60.0, 100.0)}
    assert not is_worse(lost, {"slide.position": 0.012, "piston.pressure_1": 9e4})
    assert is_worse({"slide.position": lost["slide.position"]}, {"slide.position": 0.05})


def test_errors_below_the_noise_are_none() -> None:
    assert not is_worse({"a": SignalFit("Pa", 10.0, 90.0, 100.0)}, {}) and is_worse({"a": SignalFit("Pa", 10.0, 110.0, 100.0)}, {})


@pytest.mark.parametrize(("after", "uncertain", "worse"), [(0.9, 0.05, False), (0.9, 0.2, True), (0.5, 0.2, False), (1.1, 0.0, True)])
def test_over_windows_of_the_whole_machine_a_rig_is_surely_better_or_not_written(
    rig: Rig, after: float, uncertain: float, worse: bool
) -> None:
    coupled = {"piston.pressure_1": SignalFit("Pa", 1.0, after, 0.0)}
    trial = Trial(RigUpdate(rig, ()), {}, {}, {}, coupled, uncertain)
    assert trial.is_worse is worse and trial.loss == pytest.approx(math.log(after))


@pytest.mark.parametrize(("after", "free", "worse"), [(0.96, 0.02, False), (0.96, 0.6, True), (1.1, 0.02, True)])
def test_windows_need_not_be_surely_better_where_the_free_run_is_far_better(rig: Rig, after: float, free: float, worse: bool) -> None:
    run, coupled = ({"string.position": SignalFit("rad", 1.0, value, 0.0)} for value in (free, after))
    assert Trial(RigUpdate(rig, ()), {}, run, {}, coupled, 0.05).is_worse is worse


def test_how_sure_a_gain_is_shows_in_how_windows_differ() -> None:
    """Of errors that fall by half in every window the gain is certain; a factor that scatters by s is known to s / sqrt(n)."""
    rng = np.random.default_rng(4)
    steady = {n: np.array([500.0, 500.0, 125.0]) for n in range(200)}
    factors = np.exp(rng.normal(0.0, 0.1, 200))
    scattered = {n: np.array([500.0, 500.0, 500.0 * f]) for n, f in enumerate(factors)}
    assert uncertainty({"a": steady}, {}) == pytest.approx(0.0, abs=1e-12)
    assert uncertainty({"a": scattered}, {}) == pytest.approx(0.05 / math.sqrt(200), rel=0.15)
    assert uncertainty({"a": scattered, "b": steady}, {}) == pytest.approx(0.5 * uncertainty({"a": scattered}, {}))
    assert uncertainty({"a": scattered}, {"a": 10.0}) == 0.0
    assert uncertainty({"a": {0: steady[0], 1: scattered[1]}}, {}) == 0.0


def runs(*ratios: float, before: float = 1.0) -> tuple[dict[str, SignalFit], ...]:
    """Return errors of a position in runs from as many states, and of a pressure that all predict ten times better."""
    pressure = SignalFit("Pa", 1.0, 0.1, 0.0)
    return tuple({"slide.position": SignalFit("m", before, before * one, 0.0), "piston.pressure_1": pressure} for one in ratios)


@pytest.mark.parametrize(
    ("ratios", "worse"),
    [((3.1, 2.0, 2.5, 4.0), True), ((3.1, 0.2, 0.3, 0.1), False), ((1.01, 1.01, 1.01, 1.01), False), ((1.3, 0.9, 1.2, 0.8), False),
     ((1.1, 1.0, math.nan, 1.0), True), ((math.nan,) * 4, True), ((3.1, 3.0), False)],
    ids=["further from every state", "one run by chance", "a trifle", "either way", "one diverges", "all diverge", "too few to tell"],
)  # fmt: skip
def test_a_position_that_strays_surely_further_is_not_paid_for_by_pressures(rig: Rig, ratios: tuple[float, ...], worse: bool) -> None:
    first, *started = runs(*ratios)
    trial = Trial(RigUpdate(rig, ()), {}, {}, {}, {}, 0.0, (first, *started))
    assert trial.strays == (("slide.position",) if worse else ())
    if worse:
        assert trial.is_worse


@pytest.mark.parametrize("signals", [1, 6, 13])
def test_of_rigs_that_are_equally_good_few_are_said_to_stray_however_many_signals_they_have(signals: int) -> None:
    rng, strays = np.random.default_rng(0), 0
    for _ in range(1000):
        errors = rng.lognormal(0.0, 1.0, (4, signals, 2))
        begun = [{str(n): SignalFit("m", b, a, 1e-9) for n, (b, a) in enumerate(one)} for one in errors]
        strays += bool(straying_further(begun))
    assert 15 < strays < 70


def test_of_many_rigs_that_are_equally_good_hardly_one_is_surely_better_begun_anew(rig: Rig) -> None:
    rng, whole, any_of_them = np.random.default_rng(1), 0, 0
    for _ in range(1000):
        errors = np.exp(rng.normal(0.0, 1.0, (MOST_TRIALS, 4)))
        trials = [
            Trial(RigUpdate(rig, ()), {}, {}, {}, starts=tuple({"x": SignalFit("m", 1.0, a, 1e-9)} for a in one), is_first=number == 0)
            for number, one in enumerate(errors)
        ]
        better = [trial.is_surely_better_begun_anew for trial in trials]
        whole, any_of_them = whole + better[0], any_of_them + any(better)
    assert 10 < whole < 45 and any_of_them < 70


def test_the_run_from_the_beginning_covers_what_others_do_and_is_none_of_them(rig: Rig) -> None:
    first, *started = runs(30.0, 1.05, 0.9, 1.05, 0.9)
    assert Trial(RigUpdate(rig, ()), {}, first, {}, starts=tuple(started)).strays == ()


def test_a_position_that_is_lost_either_way_counts_where_it_is_surely_missed_by_more() -> None:
    """74 mm against 24 mm of a piston that sways by 19 mm."""
    assert straying_further(runs(3.1, 2.9, 3.3, before=0.024)) == ("slide.position",)


def test_runs_from_several_states_decide_with_the_one_from_the_beginning(rig: Rig) -> None:
    position = [{"slide.position": SignalFit("m", 1.0, ratio, 0.0)} for ratio in (0.9, 1.6, 0.9, 1.6)]
    assert not Trial(RigUpdate(rig, ()), {}, position[0], {}).is_worse
    assert Trial(RigUpdate(rig, ()), {}, position[0], {}, starts=tuple(position[1:])).is_worse


@pytest.mark.parametrize(
    ("first", "anew", "worse"),
    [(1.9, (0.1, 0.3, 0.05, 0.2), False), (1.9, (0.9, 1.05, 0.95, 0.97), True), (1.9, (0.1, 0.3), True),
     (1.0, (0.9, 1.1, 0.9, 1.05), False), (math.nan, (0.1, 0.3, 0.05, 0.2), True)],
    ids=["surely better begun anew", "not surely", "too few to tell", "as before", "it diverges"],
)  # fmt: skip
def test_one_free_run_that_is_worse_is_by_chance_where_runs_begun_anew_are_surely_better(
    rig: Rig, first: float, anew: tuple[float, ...], worse: bool
) -> None:
    begun = [{"slide.position": SignalFit("m", 1.0, ratio, 0.0)} for ratio in (first, *anew)]
    assert Trial(RigUpdate(rig, ()), {}, begun[0], {}, starts=tuple(begun[1:])).is_worse is worse


def test_what_one_run_misses_by_chance_is_told_from_what_all_miss(rig: Rig) -> None:
    first, *started = runs(1.7, 0.2, 0.3, 0.2)
    said = Trial(RigUpdate(rig, ()), {}, first, {}, starts=tuple(started)).by_chance()
    assert said == {"slide.position": (pytest.approx((0.2 * 0.3 * 0.2) ** (1.0 / 3.0)), 3)}
    elsewhere = ({"piston.pressure_1": SignalFit("Pa", 1.0, 0.1, 0.0)}, *started)
    assert Trial(RigUpdate(rig, ()), {}, first, {}, starts=elsewhere).by_chance()["slide.position"][1] == 3
    assert Trial(RigUpdate(rig, ()), {}, first, {}, starts=tuple(started[:2])).by_chance() == {}
    for ratios in ((1.2, 1.3, 1.2), (0.9, 1.05, 0.9)):  # by more in all, and by less in the mean that may be chance itself
        first, *started = runs(1.7, *ratios)
        assert Trial(RigUpdate(rig, ()), {}, first, {}, starts=tuple(started)).by_chance() == {}


@pytest.mark.parametrize(
    ("rank", "position", "worse"),
    [(Rank.REFITTED, (1.3, 1.2, 1.1), True), (Rank.REFITTED, (1.3, 0.8, 0.9), False), (Rank.FOUND, (1.3, 1.2, 1.1), False)],
)
def test_where_nothing_was_found_no_signal_pays_for_another(rig: Rig, rank: Rank, position: tuple[float, ...], worse: bool) -> None:
    """A bench as its rig: pressures with refitted delays and volumes are predicted four times better, its position is not."""
    entry = EffectEntry(EffectSetting("sensor_delay", "piston.pressure_1", {"seconds": 1e-3}))
    update = RigUpdate(rig, (Part("gas of piston", rank, (entry,)),))
    first, *started = (
        {"piston.pressure_1": SignalFit("Pa", 1.0, 0.25, 1e-9), "slide.position": SignalFit("m", 1.0, ratio, 1e-9)} for ratio in position
    )
    assert Trial(update, {}, first, {}, starts=tuple(started)).is_worse is worse
