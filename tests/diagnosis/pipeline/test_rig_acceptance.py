"""An update of the rig is written as far as it wins."""

from __future__ import annotations

import math
from dataclasses import replace

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.outcome.rig_update import Part, Rank, RigUpdate
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.pipeline.rig_acceptance import Trial, accepted, as_far_as_it_wins, is_worse, uncertainty
from exo_sim.rig import EffectEntry, EffectSetting, Rig
from exo_sim.trials.cases import make_case, write_case


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


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("acceptance"))


def part(source: str, rank: Rank) -> Part:
    return Part(source, rank, (EffectEntry(EffectSetting(f"{source}_{rank.name}", "piston", {})),))


def weighed(worth: dict[str, tuple[float, float]], update: RigUpdate) -> Trial:
    """Return a trial in which every entry multiplies the window and free-run error of its signal (that of its source)."""
    inside, free = {"gas": 1.0, "motion": 1.0}, {"gas": 1.0, "motion": 1.0}
    for entry in update.entries:
        signal = entry.setting.name.split("_")[0]
        factors = worth.get(entry.setting.name, (1.0, 1.0))
        inside[signal] *= factors[0]
        free[signal] *= factors[1]
    windows, run = ({name: SignalFit("Pa", 1.0, value, 0.0) for name, value in one.items()} for one in (inside, free))
    return Trial(update, windows, run, {})


@pytest.mark.parametrize(
    ("worth", "left"),
    [
        ({"gas_FOUND": (0.3, 0.3), "motion_FOUND": (0.5, 0.5)}, {"gas_FOUND", "gas_CURVE", "motion_FOUND", "motion_REFITTED"}),
        ({"gas_FOUND": (0.3, 0.3), "gas_CURVE": (0.5, math.nan)}, {"gas_FOUND", "motion_FOUND", "motion_REFITTED"}),
        ({"gas_FOUND": (0.3, 0.3), "motion_REFITTED": (0.9, 1.5)}, {"gas_FOUND", "gas_CURVE", "motion_FOUND"}),
        (
            {"gas_FOUND": (0.4, 0.4), "motion_FOUND": (0.5, 0.8), "motion_REFITTED": (0.5, 1.5)},
            {"gas_FOUND", "gas_CURVE", "motion_FOUND", "motion_REFITTED"},
        ),
        ({"gas_FOUND": (3.0, 3.0)}, {"motion_FOUND", "motion_REFITTED"}),
        ({"gas_FOUND": (0.01, 3.0), "motion_FOUND": (3.0, 0.5)}, set()),
    ],
    ids=[
        "all wins", "a curve diverges", "a refit hurts", "a refit that wins more than it hurts", "what was found is worse",
        "each loses by one measure",
    ],
)
def test_what_hurts_is_left_out_and_what_wins_stays(rig: Rig, worth: dict[str, tuple[float, float]], left: set[str]) -> None:
    parts = part("gas", Rank.FOUND), part("gas", Rank.CURVE), part("motion", Rank.FOUND), part("motion", Rank.REFITTED)
    kept = as_far_as_it_wins(RigUpdate(rig, parts), lambda update: weighed(worth, update))
    assert {entry.setting.name for entry in kept.update.entries} == left
    assert not kept.is_worse


def test_what_was_found_stays_where_more_must_go_than_can_be_tried(rig: Rig) -> None:
    """What was refitted at five places is worse by far, what was found at one of them better: leaving out one after the other takes
    more trials than there are.
    """
    places = [f"gas of {letter}" for letter in "abcde"]
    parts = tuple(part(place, rank) for place in places for rank in (Rank.FOUND, Rank.REFITTED, Rank.SENSORS))
    trials = []

    def tried(update: RigUpdate) -> Trial:
        trials.append(update)
        worth = {f"{places[0]}_FOUND": 0.1, **{f"{place}_{rank.name}": 3.0 for place in places for rank in (Rank.REFITTED, Rank.SENSORS)}}
        after = math.prod(worth.get(entry.setting.name, 1.0) for entry in update.entries)
        return Trial(update, {}, {"gas": SignalFit("Pa", 1.0, after, 0.0)}, {})

    kept = as_far_as_it_wins(RigUpdate(rig, parts), tried)
    assert f"{places[0]}_FOUND" in {entry.setting.name for entry in kept.update.entries}
    assert not any(one.rank is Rank.REFITTED for one in kept.update.parts) and not kept.is_worse
    assert len(trials) < 30


def test_where_nothing_wins_the_rig_stays_as_it_was(rig: Rig) -> None:
    parts = tuple(part(source, rank) for source in ("gas", "motion") for rank in Rank)
    worth = {f"{source}_{rank.name}": (1.2, 1.2) for source in ("gas", "motion") for rank in Rank}
    assert as_far_as_it_wins(RigUpdate(rig, parts), lambda update: weighed(worth, update)).update.parts == ()


def test_a_rig_that_is_refused_is_written_without_what_makes_it_so(rig: Rig) -> None:
    """What cannot be read has no errors, and is not taken for one that has none."""
    parts = part("gas", Rank.FOUND), part("gas", Rank.REFITTED), part("motion", Rank.FOUND)

    def tried(update: RigUpdate) -> Trial:
        names = {entry.setting.name for entry in update.entries}
        return Trial(update, {}, {}, {}, is_refused=True) if "motion_FOUND" in names else weighed({"gas_FOUND": (0.5, 0.5)}, update)

    kept = as_far_as_it_wins(RigUpdate(rig, parts), tried)
    assert {entry.setting.name for entry in kept.update.entries} == {"gas_FOUND", "gas_REFITTED"}


@pytest.fixture(scope="module")
def leaking(tmp_path_factory: pytest.TempPathFactory) -> MachineData:
    folder = tmp_path_factory.mktemp("leak")
    write_case(make_case("a", ("piston_leakage",), 11, 0.5, duration=10.0, known="none"), folder, "parquet")
    return gather([folder / "recording.parquet"], folder / "rig.toml")


def leak(data: MachineData, area: float) -> RigUpdate:
    entry = EffectEntry(EffectSetting("piston_leakage", "piston", {"area": area}))
    return RigUpdate(data.rig, (Part("gas of piston", Rank.FOUND, (entry,)),))


def test_a_text_that_is_no_rig_is_refused_aloud(leaking: MachineData) -> None:
    kept, said = accepted(leaking, leak(leaking, 1.0), Split({leaking.recordings[0].name: ((7.0, 9.0),)}))
    assert kept.update.parts == () and len(said) == 1 and "piston_leakage" in said[0]


def test_where_nothing_can_be_tried_it_is_said(leaking: MachineData) -> None:
    """Without a command the gas, without a position the forces."""
    table = leaking.as_read[0]
    gone = ("piston.valve_command", "slide.position")
    less = replace(table, columns={key: values for key, values in table.columns.items() if key not in gone})
    nothing = replace(leaking, as_read=(less,), recordings=(less,), cylinders={}, joints={})
    kept, said = accepted(nothing, leak(leaking, 3.6e-8), Split({less.name: ((7.0, 9.0),)}))
    assert kept.update.parts and len(said) == 1 and "not put to the test" in said[0]


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
