"""Rounds: what validation may refute, what revises the plan of the next round, and what the test time alone shows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import Imputed
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.estimation.threads import SERIAL
from exo_sim.diagnosis.findings import Estimate, Finding, Kind, SignalFit, Subsystem
from exo_sim.diagnosis.pipeline import rounds
from exo_sim.diagnosis.pipeline.plan import Examination, Plan, Results
from exo_sim.diagnosis.policy.validation import LACKING_RATIO
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.held_out_gain import HeldOutGain
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.diagnosis.validation.held_out_errors import BalanceError, HeldOutErrors
from exo_sim.diagnosis.validation.long_run import Straying
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording
from exo_sim.rig import Rig, assembly

LEAK, SPRING = ("piston_leakage", "piston"), ("return_spring", "piston")
GAS, MOTION = (Subsystem.GAS, "piston"), (Subsystem.MOTION, "slide")
At = tuple[str, str]


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("rounds"))


@pytest.fixture(scope="module")
def data(rig: Rig) -> MachineData:
    """A second of a piston that is led to and fro."""
    table: Recording = benches.led(rig, 1.0)
    model = load(rig)
    links = linkages(rig, model)
    cylinders = {"piston": tuple(cylinder_runs(table, rig, model, links))}
    joints = {"slide": tuple(motion_runs(table, rig, model, links)[0])}
    return MachineData(rig, model, links, (table,), (table,), cylinders, joints)


def plant_of(rig: Rig) -> PlantParameters:
    return PlantParameters(assembly.world(rig), assembly.cylinders(rig))


def gas_of(data: MachineData, *names: At, **more: Any) -> SubsystemResult[GasModel]:
    """Return a result of the gas with these findings."""
    model = GasModel(data.cylinders["piston"], plant_of(data.rig), Split({}))
    final = FittedModel((), Fit((), {}, np.zeros(model.size), np.zeros((model.size, 0))))
    findings = tuple(Finding(name, where, Kind.MISSING_PHYSICS, "", {}, 12.0, 0.0) for name, where in names)
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final, findings=findings, **more)


def errors(drops: dict[At, float] | None = None, influence: float = 1.0, **more: Any) -> HeldOutErrors:
    keys = {f"{name}@{where}": drop for (name, where), drop in (drops or {}).items()}
    return HeldOutErrors({"piston.pressure_1": SignalFit("Pa", 2.0, 1.0, 1.0)}, keys, dict.fromkeys(keys, influence), **more)


def examination(
    data: MachineData, plan: Plan, gas: SubsystemResult[GasModel], validation: HeldOutErrors | None, test: HeldOutErrors | None = None
) -> Examination:
    return Examination(data, plan, Results((gas,)), (), test or errors(), validation)


def stable(
    monkeypatch: pytest.MonkeyPatch, data: MachineData, answers: Sequence[tuple[At, ...]], validation: HeldOutErrors | None, **more: Any
) -> tuple[Examination, list[Plan]]:
    """Return the examination that stands in the end when the rounds answer so, and the plan of every round."""
    plans: list[Plan] = []

    def examine(data: MachineData, plan: Plan, *rest: Any) -> Examination:
        plans.append(plan)
        return examination(data, plan, gas_of(data, *answers[min(len(plans), len(answers)) - 1], **more), validation)

    monkeypatch.setattr(rounds, "examine", examine)
    monkeypatch.setattr(rounds, "validated", lambda found: found)
    return rounds.examine_until_stable(data, SERIAL, print), plans


def names(found: Examination) -> list[str]:
    return [finding.name for one in found.results.all for finding in one.findings]


def test_a_finding_that_validation_supports_stands(monkeypatch: pytest.MonkeyPatch, data: MachineData) -> None:
    end, plans = stable(monkeypatch, data, [(LEAK,)], errors({LEAK: 0.6}))
    assert names(end) == ["piston_leakage"] and [plan.refuted for plan in plans] == [{}]


def test_a_refuted_effect_is_not_sought_again(monkeypatch: pytest.MonkeyPatch, data: MachineData) -> None:
    end, plans = stable(monkeypatch, data, [(LEAK, SPRING), (LEAK,)], errors({LEAK: 0.6, SPRING: 0.01}))
    assert [set(plan.refuted) for plan in plans] == [set(), {SPRING}]
    assert names(end) == ["piston_leakage"]
    assert "no more than 1 %" in end.plan.refuted[SPRING]
    parameter = FreeParameter(*SPRING, "stiffness", "N/m", Target.CYLINDER, 1.0, 0.0, 1.0)
    candidates = [Candidate(*at, "form", (parameter,), ((1.0,),)) for at in (LEAK, SPRING)]
    assert [candidate.at for candidate in end.plan.without_refuted(candidates)] == [LEAK]


def test_an_effect_that_explains_most_of_what_is_missing_is_not_refuted(monkeypatch: pytest.MonkeyPatch, data: MachineData) -> None:
    worth = {"piston_leakage@piston": HeldOutGain(80.0, 100.0), "return_spring@piston": HeldOutGain(4.0, 100.0)}
    end, plans = stable(monkeypatch, data, [(LEAK, SPRING), (LEAK,)], errors({LEAK: 0.14, SPRING: 0.02}, gains=worth))
    assert [set(plan.refuted) for plan in plans] == [set(), {SPRING}]
    assert names(end) == ["piston_leakage"]
    # all of what is missing, and that is what noise does
    chance = {"piston_leakage@piston": HeldOutGain(2.0, 2.0, is_plain=False, log10_odds=-300.0)}
    end, _ = stable(monkeypatch, data, [(LEAK,), ()], errors({LEAK: 0.02}, gains=chance))
    assert names(end) == []


@pytest.mark.parametrize(
    ("fitted", "error", "back"),
    [
        (4.2, 2.0, True),  # what came in its place leaves more of both times
        (4.2, 1.3, False),  # no more of the held-out time
        (0.7, 2.0, False),  # no more of the time that was fitted
    ],
)
def test_a_refutation_is_taken_back_where_more_is_missed_without_what_it_refuted(
    monkeypatch: pytest.MonkeyPatch, data: MachineData, fitted: float, error: float, back: bool
) -> None:
    plans: list[Plan] = []

    def examine(data: MachineData, plan: Plan, *rest: Any) -> Examination:
        plans.append(plan)
        without = SPRING in plan.refuted
        balance = BalanceError(error, fitted, 6.0, 0.0) if without else BalanceError(1.3, 0.7, 6.0, 0.0)
        found = (("quadratic_drag", "slide"),) if without else (LEAK, SPRING)
        drops = {at: -0.2 if at == SPRING else 0.6 for at in found}
        return examination(data, plan, gas_of(data, *found), errors(drops, balances={GAS: balance}))

    monkeypatch.setattr(rounds, "examine", examine)
    monkeypatch.setattr(rounds, "validated", lambda found: found)
    end = rounds.examine_until_stable(data, SERIAL, print)
    assert [set(plan.refuted) for plan in plans] == [set(), {SPRING}]
    assert names(end) == (["piston_leakage", "return_spring"] if back else ["quadratic_drag"])
    assert end.plan.upheld == ({SPRING} if back else set())


def test_in_the_last_round_refuted_effects_are_taken_back(monkeypatch: pytest.MonkeyPatch, data: MachineData) -> None:
    found = [((f"effect_{i}", "piston"),) for i in range(rounds.MOST_REFUTATIONS)]
    end, plans = stable(monkeypatch, data, found, errors({at: -0.3 for (at,) in found}))
    assert len(plans) == rounds.MOST_REFUTATIONS and names(end) == []
    assert len(end.plan.refuted) == rounds.MOST_REFUTATIONS


def test_in_the_last_round_all_that_is_still_refuted_is_taken_back(monkeypatch: pytest.MonkeyPatch, data: MachineData) -> None:
    """Feeble names that come out one a round do not shelter the one that spoils most."""
    feeble = [(f"effect_{i}", "piston") for i in range(rounds.MOST_REFUTATIONS + 2)]

    def examine(data: MachineData, plan: Plan, *rest: Any) -> Examination:
        found = gas_of(data, *(at for at in (*feeble, SPRING, LEAK) if at not in plan.refuted))
        certain = tuple(replace(one, log10_odds=24.0) if one.at == SPRING else one for one in found.findings)
        drops = {**dict.fromkeys(feeble, 0.01), SPRING: -0.9, LEAK: 0.6}
        return examination(data, plan, replace(found, findings=certain), errors(drops))

    monkeypatch.setattr(rounds, "examine", examine)
    monkeypatch.setattr(rounds, "validated", lambda found: found)
    end = rounds.examine_until_stable(data, SERIAL, print)
    assert names(end) == ["piston_leakage"] and set(end.plan.refuted) == {*feeble, SPRING}
    assert "does not fall" in end.plan.refuted[SPRING]


def test_the_least_certain_is_refuted_first_whatever_it_spoils(data: MachineData) -> None:
    found = gas_of(data, LEAK, SPRING)
    odd = replace(found, findings=tuple(replace(f, log10_odds=20.0 if f.at == LEAK else 5.0) for f in found.findings))
    assert set(rounds.newly_refuted(examination(data, Plan(Split({})), odd, errors({LEAK: -0.9, SPRING: 0.0})))) == {SPRING}


@pytest.mark.parametrize(("error", "refuted"), [(1.5, False), (0.1, True)], ids=["nothing is told", "it is surely not there"])
def test_an_error_that_rises_refutes_great_odds_only_where_the_change_is_surely_not_there(
    data: MachineData, error: float, refuted: bool
) -> None:
    found = gas_of(data, SPRING)
    great = replace(found, findings=tuple(replace(f, log10_odds=50.0) for f in found.findings))
    gains = {"return_spring@piston": HeldOutGain(-20.0, 100.0, amplitude=-0.6, error=error)}
    assert bool(rounds.newly_refuted(examination(data, Plan(Split({})), great, errors({SPRING: -0.5}, gains=gains)))) is refuted


def test_what_was_upheld_is_not_put_aside_as_doubtful(data: MachineData) -> None:
    worth = errors(gains={"return_spring@piston": HeldOutGain(3.0, 100.0)})
    for upheld, expected in ((frozenset({SPRING}), ["return_spring"]), (frozenset[At](), [])):
        one = examination(data, Plan(Split({}), upheld=upheld), gas_of(data, SPRING), worth)
        assert names(rounds.without_doubtful(one)) == expected


@pytest.mark.parametrize(
    "validation", [None, errors({}), errors({SPRING: 0.0}, influence=0.1)], ids=["no validation", "not compared", "no influence"]
)
def test_what_was_not_tested_is_not_refuted(
    monkeypatch: pytest.MonkeyPatch, data: MachineData, validation: HeldOutErrors | None
) -> None:
    end, plans = stable(monkeypatch, data, [(SPRING,)], validation)
    assert names(end) == ["return_spring"] and len(plans) == 1


def test_the_beginning_is_held_out_once_where_validation_shows_something_new(
    monkeypatch: pytest.MonkeyPatch, data: MachineData
) -> None:
    worse = errors(balances={GAS: BalanceError(2.0 * LACKING_RATIO, 1.0, 5.0, 1.0)})
    end, plans = stable(monkeypatch, data, [(LEAK,)], worse)
    (tail,), (head,) = (plan.split.test["bench"] for plan in plans)
    assert tail[1] == pytest.approx(0.999) and head[0] == 0.0
    assert end.plan is plans[0]  # no better, so the first counts


def test_of_two_divisions_the_one_counts_whose_fit_lacks_nothing(monkeypatch: pytest.MonkeyPatch, data: MachineData) -> None:
    """The other one misses held-out time by less of what its fit leaves, and by more than any healthy machine."""
    lacking = BalanceError(2.0 * LACKING_RATIO, 1.0, 5.0, 1.0)
    healthy = BalanceError(3.0 * LACKING_RATIO, 1.0, 4.0 * LACKING_RATIO, 1.0)
    plans: list[Plan] = []

    def examine(data: MachineData, plan: Plan, *rest: Any) -> Examination:
        plans.append(plan)
        return examination(data, plan, gas_of(data), errors(balances={GAS: healthy if len(plans) > 1 else lacking}))

    monkeypatch.setattr(rounds, "examine", examine)
    monkeypatch.setattr(rounds, "validated", lambda found: found)
    end = rounds.examine_until_stable(data, SERIAL, print)
    assert len(plans) == 2 and end.plan is plans[1] and end.validation_ratio == 3.0 * LACKING_RATIO


def test_what_a_healthy_machine_is_missed_by_as_well_shows_nothing_new(monkeypatch: pytest.MonkeyPatch, data: MachineData) -> None:
    within = errors(balances={GAS: BalanceError(2.0 * LACKING_RATIO, 1.0, 9.0, 1.0)})
    _, plans = stable(monkeypatch, data, [(LEAK,)], within)
    assert len(plans) == 1


def test_gas_is_examined_once_more_with_the_friction_of_its_piston(monkeypatch: pytest.MonkeyPatch, data: MachineData) -> None:
    friction = {"piston": [(FreeParameter("coulomb_friction", "piston", "force", "N", Target.CYLINDER, 1.0, 0.0, 9.0), 5.0)]}
    monkeypatch.setattr(rounds, "friction_to_add", lambda found: friction)
    _, plans = stable(monkeypatch, data, [(LEAK,)], errors({LEAK: 0.6}))
    assert [plan.friction for plan in plans] == [None, friction]
    _, plans = stable(monkeypatch, data, [(SPRING,), (SPRING,), ()], errors({SPRING: 0.0}))
    assert [(len(plan.refuted), plan.friction) for plan in plans] == [(0, None), (0, friction), (1, None), (1, friction)]


def test_validation_in_which_nothing_could_be_compared_never_wins(data: MachineData) -> None:
    assert examination(data, Plan(Split({})), gas_of(data), HeldOutErrors()).validation_ratio == math.inf
    assert examination(data, Plan(Split({})), gas_of(data), None).validation_ratio == 0.0


@pytest.mark.parametrize(
    ("ratio", "beyond", "unknown", "count"),
    [(2.0, True, False, 0), (6.0, False, False, 0), (6.0, True, False, 1), (12.0, False, False, 1), (12.0, True, True, 0)],
)
def test_what_only_the_test_time_shows_is_said(data: MachineData, ratio: float, beyond: bool, unknown: bool, count: int) -> None:
    test = errors(balances={GAS: BalanceError(ratio, 1.0, ratio / (2.0 if beyond else 0.5), 40.0)})
    _, found = rounds.with_test_findings(examination(data, Plan(Split({})), gas_of(data, has_unknown=unknown), None, test))
    assert len(found) == count
    assert all(one.kind is Kind.UNKNOWN and f"{ratio:.0f} times" in one.says and one.log10_odds == 40.0 for one in found)


@pytest.mark.parametrize(("validation", "test", "count"), [(True, True, 1), (False, True, 0), (True, False, 0)])
def test_a_good_fit_is_rejected_where_validation_and_test_exceed_the_bound(
    data: MachineData, validation: bool, test: bool, count: int
) -> None:
    def missed(beyond: bool, excess: float = 1.3) -> HeldOutErrors:
        return errors(balances={GAS: BalanceError(5.0 * (excess if beyond else 0.9), 4.5, 5.0, 13.0)})

    def found(validation: HeldOutErrors | None, test: HeldOutErrors) -> list[Finding]:
        return rounds.with_test_findings(examination(data, Plan(Split({})), gas_of(data), validation, test))[1]

    unknown = found(missed(validation), missed(test))
    assert [finding.kind for finding in unknown] == [Kind.UNKNOWN] * count
    assert all("by more than any healthy machine" in finding.says for finding in unknown)
    assert found(None, missed(True)) == []
    assert found(missed(True), missed(True, 1.05)) == []


def test_what_an_unmeasured_chamber_may_do_is_an_open_question(data: MachineData) -> None:
    runs = [replace(run, imputed=Imputed()) for run in data.joints["slide"]]
    model = MotionModel(runs, plant_of(data.rig), Split({}))
    final = FittedModel((), Fit((), {}, np.zeros(model.size), np.zeros((model.size, 0))))
    one = SubsystemResult("slide", model, ModelFits(model, ()), SearchResult(final, final), final)
    test = errors(balances={MOTION: BalanceError(12.0, 1.0, 6.0, 40.0)})
    before = Examination(data, Plan(Split({})), Results(motion=(one,)), (), test)
    after, found = rounds.with_test_findings(before)
    assert found == [] and after.results.motion[0].is_unresolved and len(after.data.open_questions) == 1
    assert not before.results.motion[0].is_unresolved and before.data.open_questions == ()


def test_names_that_explain_little_of_the_validation_time_are_put_aside_and_it_is_said_why(data: MachineData) -> None:
    worth = {"piston_leakage@piston": HeldOutGain(60.0, 100.0), "return_spring@piston": HeldOutGain(3.0, 100.0)}
    found = rounds.without_doubtful(examination(data, Plan(Split({})), gas_of(data, LEAK, SPRING), errors(gains=worth)))
    assert [finding.name for finding in found.results.gas[0].findings] == ["piston_leakage"]
    assert list(found.plan.refuted) == [SPRING] and "explains 3 %" in found.plan.refuted[SPRING]
    undecided = {key: replace(one, amplitude=0.5, error=0.7) for key, one in worth.items()}
    kept = rounds.without_doubtful(examination(data, Plan(Split({})), gas_of(data, LEAK, SPRING), errors(gains=undecided)))
    assert [finding.name for finding in kept.results.gas[0].findings] == ["piston_leakage", "return_spring"]
    assert set(kept.shares) == {"piston_leakage@piston"}
    untested = examination(data, Plan(Split({})), gas_of(data, SPRING), errors(), errors())
    assert rounds.without_doubtful(untested) is untested


def test_beside_something_unknown_what_may_be_nil_is_put_aside(data: MachineData) -> None:
    worth = {"piston_leakage@piston": HeldOutGain(60.0, 100.0), "return_spring@piston": HeldOutGain(60.0, 100.0)}

    def left(unknown: bool) -> list[str]:
        gas = gas_of(data, LEAK, SPRING, has_unknown=unknown)
        maybe = {"stiffness": Estimate(30.0, "N/m", 0.0, 90.0)}
        findings = tuple(replace(one, parameters=maybe) if one.at == SPRING else one for one in gas.findings)
        one = examination(data, Plan(Split({})), replace(gas, findings=findings), errors(gains=worth))
        return [finding.name for finding in rounds.without_doubtful(one).results.gas[0].findings]

    assert left(False) == ["piston_leakage", "return_spring"] and left(True) == ["piston_leakage"]


def test_a_name_is_judged_by_validation_time_and_never_by_the_test(data: MachineData) -> None:
    """The errors that are reported would say less than they seem to if anything were chosen by them."""
    poor, rich = ({"piston_leakage@piston": HeldOutGain(gained, 100.0)} for gained in (10.0, 60.0))
    for validation, test, share in ((rich, poor, 0.6), (poor, rich, 0.1)):
        one = examination(data, Plan(Split({})), gas_of(data, LEAK), errors(gains=validation), errors(gains=test))
        assert one.shares == {"piston_leakage@piston": pytest.approx(share)}
        assert bool(names(rounds.without_doubtful(one))) is (share > 0.14)
    assert examination(data, Plan(Split({})), gas_of(data, LEAK), None, errors(gains=rich)).shares == {}


def test_what_is_too_small_to_matter_is_held_beside_the_findings(data: MachineData) -> None:
    left = {"piston_leakage@piston": 0.0, "return_spring@piston": 1e3}
    before = examination(data, Plan(Split({})), gas_of(data, LEAK, SPRING), errors({LEAK: 0.0, SPRING: 0.0}, left=left))
    after = rounds.without_small(before)
    assert names(after) == ["return_spring"] and [finding.name for finding in after.small] == ["piston_leakage"]


@pytest.mark.parametrize(("size", "found"), [(30.0, 1), (4.0, 0)])
def test_a_gas_that_strays_in_one_run_has_something_unknown_in_it(
    monkeypatch: pytest.MonkeyPatch, data: MachineData, size: float, found: int
) -> None:
    monkeypatch.setattr(rounds, "straying", lambda one, split: Straying(size, 2.0, 1.0) if one.model.kind is Subsystem.GAS else None)
    stable = examination(data, Plan(Split({})), gas_of(data), None, errors(balances={GAS: BalanceError(1.0, 1.0, 5.0, 0.0)}))
    _, unknown = rounds.with_test_findings(stable)
    assert [(one.kind, one.where) for one in unknown] == [(Kind.UNKNOWN, "piston")] * found
    assert all("strays" in one.says and "30 times the noise" in one.says and one.log10_odds > 100.0 for one in unknown)


@pytest.mark.parametrize(("at_the_end", "at_the_beginning", "first"), [(2, 2, False), (1, 2, True), (1, 1, False), (0, 0, False)])
def test_the_end_is_kept_where_only_it_moves(
    monkeypatch: pytest.MonkeyPatch, data: MachineData, at_the_end: int, at_the_beginning: int, first: bool
) -> None:
    """A balance of forces that has rows without the beginning only is judged on the end; then the other division comes second."""
    time = data.recordings[0].time
    ends = rounds.split([(data.recordings[0].name, time)])
    monkeypatch.setattr(rounds, "judged_balances", lambda data, parts: at_the_end if parts == ends else at_the_beginning)
    off = errors(balances={GAS: BalanceError(9.0 * LACKING_RATIO, 1.0, 5.0, 9.0)})
    more = replace(data, joints={**data.joints, "other": data.joints["slide"]})
    _, plans = stable(monkeypatch, more, [()], off)
    assert [plan.split == ends for plan in plans] == [not first, first]
