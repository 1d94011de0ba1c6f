"""An update of the rig is written as far as it wins."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import benches
import pytest

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.outcome.rig_update import Part, Rank, RigUpdate
from exo_sim.diagnosis.pipeline import rig_acceptance, rig_errors
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.pipeline.rig_acceptance import Judge, accepted, as_far_as_it_wins, closed_gas, likelier
from exo_sim.diagnosis.pipeline.rig_trial import Trial
from exo_sim.diagnosis.policy.validation import STARTS
from exo_sim.diagnosis.validation import recorded_run
from exo_sim.rig import EffectEntry, EffectSetting, Rig
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions


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


@pytest.mark.parametrize(("anew", "left"), [((0.6, 0.6, 0.58, 0.62), {"motion_FOUND"}), ((0.5, 0.8, 0.6, 0.7), set())])
def test_what_is_tried_after_all_that_was_found_must_be_surer_to_be_better(rig: Rig, anew: tuple[float, ...], left: set[str]) -> None:
    """Runs begun anew that would do for the one rig with all that was found do not for the best of many rigs."""
    parts = part("gas", Rank.FOUND), part("motion", Rank.FOUND)

    def tried(update: RigUpdate) -> Trial:
        free = {"x": SignalFit("m", 1.0, 1.2 if update.parts else 1.0, 0.0)}
        begun = anew if {one.source for one in update.parts} == {"motion"} else (1.0, 1.3, 1.2, 1.3)
        starts = tuple({"x": SignalFit("m", 1.0, one if update.parts else 1.0, 0.0)} for one in begun)
        return Trial(update, {}, free, {}, starts=starts)

    kept = as_far_as_it_wins(RigUpdate(rig, parts), tried)
    assert {entry.setting.name for entry in kept.update.entries} == left
    begun = tuple({"x": SignalFit("m", 1.0, one, 0.0)} for one in anew)
    assert Trial(RigUpdate(rig, parts), {}, {}, {}, starts=begun).is_surely_better_begun_anew


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
    write_case(make_case("a", ("piston_leakage",), 11, 0.5, Conditions(duration=10.0, known=())), folder, "parquet")
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


def test_what_no_rig_file_can_hold_is_said(leaking: MachineData) -> None:
    found = leak(leaking, 3.6e-8)
    entry = EffectEntry(EffectSetting("viscous_friction", "slide", {"coefficient": 5.0}))
    _, said = accepted(leaking, replace(found, unsayable=(entry,)), Split({leaking.recordings[0].name: ((7.0, 9.0),)}))
    assert ["viscous friction" in words and "rename" in words for words in said].count(True) == 1


def test_runs_from_the_midst_say_nothing_of_a_gas_that_no_valve_feeds(leaking: MachineData) -> None:
    """What it was warmed to by then, nobody measured."""
    closed = {name: tuple(replace(run, commanded=False) for run in runs) for name, runs in leaking.cylinders.items()}
    assert closed_gas(leaking) == set() and closed_gas(replace(leaking, cylinders=closed)) == {"piston.pressure_1", "piston.pressure_2"}
    split = Split({leaking.recordings[0].name: ((5.0, 10.0),)})
    for data, told in ((leaking, True), (replace(leaking, cylinders=closed), False)):
        starts = Judge(data, split).trial(leak(leaking, 1.35e-8)).starts
        assert any("piston.pressure_1" in run for run in starts) is told and any("slide.position" in run for run in starts)


class TimeDependent:
    """A judge for whom friction wins on validation time, and is worse on a time that holds more."""

    def __init__(self, data: MachineData, split: Split) -> None:
        self._data, self.refusals = data, list[str]()
        self._more = sum(len(spans) for spans in split.test.values()) > 1

    def over(self, split: Split) -> TimeDependent:
        return TimeDependent(self._data, split)

    def trial(self, update: RigUpdate) -> Trial:
        has_friction = any("friction" in entry.setting.name for entry in update.entries)
        after = (3.0 if self._more else 0.2) if has_friction else 0.5 if update.parts else 1.0
        return Trial(update, {}, {"slide.position": SignalFit("m", 1.0, after, 0.0)}, {})

    def reported(self, trial: Trial, split: Split) -> Trial:
        return trial


def test_what_wins_on_validation_and_is_worse_on_all_that_was_kept_back_is_left_out_and_said(
    leaking: MachineData, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rig_acceptance, "Judge", TimeDependent)
    rubs = Part("motion of slide", Rank.FOUND, (EffectEntry(EffectSetting("coulomb_friction", "piston", {"force": 9.0})),))
    update = RigUpdate(leaking.rig, (*leak(leaking, 3.6e-8).parts, rubs))
    name = leaking.recordings[0].name
    kept, said = accepted(leaking, update, Split({name: ((9.0, 10.0),)}, {name: ((7.0, 9.0),)}))
    assert [part.source for part in kept.update.parts] == ["gas of piston"]
    assert any("motion of slide" in words for words in said) and any("no test" in words for words in said)


def test_a_judge_by_another_time_says_what_a_new_one_says(leaking: MachineData) -> None:
    """What was run over all of the recordings counts again, judged on that time."""
    name, update = leaking.recordings[0].name, leak(leaking, 2.0e-8)
    one, other = Split({name: ((7.0, 9.0),)}), Split({name: ((7.0, 9.0), (9.0, 10.0))})
    judge = Judge(leaking, one)
    first = judge.trial(update)
    assert judge.over(other).trial(update) == Judge(leaking, other).trial(update) != first == judge.trial(update)


def test_a_judge_by_another_time_makes_nothing_that_it_has_from_the_first(leaking: MachineData, monkeypatch: pytest.MonkeyPatch) -> None:
    name, made = leaking.recordings[0].name, list[str]()

    def noted(function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any) -> Any:
            made.append(function.__name__)
            return function(*args)

        return call

    judge = Judge(leaking, Split({name: ((7.0, 9.0),)}))
    monkeypatch.setattr(recorded_run, "load", noted(recorded_run.load))
    monkeypatch.setattr(rig_errors, "judged_part", noted(rig_errors.judged_part))
    judge.over(Split({name: ((7.0, 10.0),)}))
    assert made == ["load"] * (1 + STARTS)  # of what is run over that time alone: in windows, and from its states


@pytest.mark.parametrize(("size", "wins"), [(1.35e-8, True), (3.6e-8, False)], ids=["as it is", "nearly three times"])
def test_a_leak_is_written_as_it_is_and_not_larger(leaking: MachineData, size: float, wins: bool) -> None:
    """The larger one strays further than no leak at all, from wherever the run begins."""
    name, update = leaking.recordings[0].name, leak(leaking, size)
    whole = Split({name: ((9.0, 10.0),)}, {name: ((7.0, 9.0),)})
    assert bool(Judge(leaking, whole.kept_back()).trial(update).strays) is not wins
    kept, said = accepted(leaking, update, whole)
    assert (kept.update is update) is wins and bool(said) is not wins


@pytest.mark.parametrize(("together", "wins"), [(0.6, True), (1.2, False)])
def test_numbers_that_were_fitted_together_are_written_where_the_whole_machine_is_predicted_better(
    rig: Rig, monkeypatch: pytest.MonkeyPatch, together: float, wins: bool
) -> None:
    """They are worse for each balance by itself, which decides nothing between the two."""
    plain = RigUpdate(rig, (part("gas", Rank.FOUND),))
    fitted = replace(plain, is_fitted_together=True)

    def trial(update: RigUpdate) -> Trial:
        by = together if update.is_fitted_together else 1.0
        balance = {"gas": SignalFit("Pa", 1.0, 0.2 / by, 0.0)}
        return Trial(update, balance, {"gas": SignalFit("Pa", 1.0, 0.5 * by, 0.0)}, {}, {"gas": SignalFit("Pa", 1.0, 0.5 * by, 0.0)})

    monkeypatch.setattr(rig_acceptance, "Judge", lambda *_: SimpleNamespace(trial=trial, refusals=[]))
    kept, _ = accepted(cast(MachineData, None), plain, Split({"a": ((0.0, 1.0),)}), fitted=fitted)
    assert kept.update.is_fitted_together is wins


def test_where_parts_of_it_lose_the_rest_is_tried_with_the_numbers_of_its_balances(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = RigUpdate(rig, (part("gas", Rank.FOUND), part("motion", Rank.REFITTED)))
    fitted = replace(plain, is_fitted_together=True)

    def trial(update: RigUpdate) -> Trial:
        """The refitted numbers hurt; without them, those that made up for them do."""
        sources = [one.source for one in update.parts]
        of_whole, of_gas, of_rest = (1.5, 0.7, 1.9) if update.is_fitted_together else (1.8, 0.4, 1.9)
        after = of_whole if len(sources) == 2 else of_gas if sources == ["gas"] else of_rest
        fits = {"gas": SignalFit("Pa", 1.0, after, 0.0)}
        return Trial(update, {"gas": SignalFit("Pa", 1.0, 0.9, 0.0)}, fits, {}, fits)

    monkeypatch.setattr(rig_acceptance, "Judge", lambda *_: SimpleNamespace(trial=trial, refusals=[]))
    kept, _ = accepted(cast(MachineData, None), plain, Split({"a": ((0.0, 1.0),)}), fitted=fitted)
    assert not kept.update.is_fitted_together and [one.source for one in kept.update.parts] == ["gas"]


@pytest.mark.parametrize(("size", "first"), [(1.35e-8, False), (3.6e-8, True)], ids=["better", "worse"])
def test_of_two_ways_to_say_the_same_that_stays_which_predicts_the_whole_machine_better(
    leaking: MachineData, size: float, first: bool
) -> None:
    """A leak as it is, or nearly three times as large, against one of a fifth."""
    less, other = leak(leaking, 3e-9), leak(leaking, size)
    split = Split({leaking.recordings[0].name: ((8.0, 10.0),)})
    assert likelier(leaking, less, other, split) is (less if first else other)
    assert likelier(leaking, less, other, split, lambda: True) is less and likelier(leaking, less, less, split) is less
