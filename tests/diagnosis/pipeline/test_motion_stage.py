"""The stage of the forces: friction that was put into a balance is named, and what the rig knows of a joint is in the plant."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import TIME, VELOCITY

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import Imputed, Kinematics, MotionRun
from exo_sim.diagnosis.data.split import Split, split
from exo_sim.diagnosis.estimation.threads import SERIAL
from exo_sim.diagnosis.pipeline.motion_stage import (
    JudgedBalances,
    asked_of,
    balances_left_open,
    examine_motion,
    judged_balances,
    nominal_balance,
    undecided,
)
from exo_sim.diagnosis.pipeline.plan import Plan, Refuted
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.motion.candidates import candidates
from exo_sim.diagnosis.subsystems.motion.family import motion_family
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.nuisances import nuisance_parameters
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_alike
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.physics.declaration import declared
from exo_sim.trials.whole_machines.case import make_case, write_case


def examined(folder: Path, lost: np.ndarray, more: str = "", plan: Plan | None = None) -> SubsystemResult[MotionModel]:
    rig = benches.bench(folder, more, cylinder=False)
    model = load(rig)
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (motion_runs.balance(lost, 0.3),)})
    (found,) = examine_motion(data, plan or Plan(Split({})), SERIAL, lambda words: None)
    return found


def of_whole_machine(folder: Path, make: str, seed: int) -> tuple[SubsystemResult[MotionModel], ...]:
    write_case(make_case("machine", make, "whole", seed, weigh=False), folder)
    data = gather([folder / "recording.csv"], folder / "rig.toml")
    parts = split([(table.name, table.time) for table in data.recordings])
    return examine_motion(data, Plan(parts), SERIAL, lambda words: None)


def names(found: SubsystemResult[MotionModel]) -> list[str]:
    return [finding.name for finding in found.findings]


def test_viscous_friction_that_was_put_in_is_found_with_its_size(tmp_path: Path) -> None:
    found = examined(tmp_path, 30.0 * VELOCITY)
    assert names(found) == ["viscous_friction"] and not found.has_unknown
    estimate = found.findings[0].parameters["coefficient"]
    assert estimate.value == pytest.approx(30.0, rel=0.05) and estimate.low < 30.0 < estimate.high


def test_a_balance_is_judged_once_more_only_where_something_of_it_was_asked_anew(tmp_path: Path) -> None:
    rig, run, judged = benches.bench(tmp_path, cylinder=False), motion_runs.balance(30.0 * VELOCITY, 0.3), JudgedBalances()
    model = load(rig)

    def result(run: MotionRun, refuted: Refuted) -> SubsystemResult[MotionModel]:
        data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
        return examine_motion(data, Plan(Split({}), refuted), SERIAL, lambda words: None, judged)[0]

    first = result(run, {})
    assert names(first) == ["viscous_friction"]
    assert result(run, {("wall_heat_transfer", "piston"): "it fell in the gas"}) is first
    assert names(result(motion_runs.balance(np.zeros_like(VELOCITY), 0.3), {})) == []  # the gas said otherwise of its pressures
    assert "viscous_friction" not in names(result(run, {("viscous_friction", "slide"): "it fell here"}))


def test_a_balance_is_judged_once_more_where_a_leak_was_refuted_that_a_filled_in_pressure_leaves_open(tmp_path: Path) -> None:
    rig, still, judged = benches.bench(tmp_path), np.full((TIME.size, 2), 2e5), JudgedBalances()
    model, leaks = load(rig), Imputed(leaks={"area_2": np.sin(0.9 * TIME) / 1e-7})
    measured = motion_runs.behind_cylinder(motion_runs.balance(30.0 * VELOCITY, 0.3), still)

    def results(run: MotionRun) -> list[SubsystemResult[MotionModel]]:
        data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
        refuted: list[Refuted] = [{}, {("external_leakage", "piston"): "it fell in the gas"}]
        return [examine_motion(data, Plan(Split({}), one), SERIAL, lambda words: None, judged)[0] for one in refuted]

    asking, not_asking = results(replace(measured, imputed=leaks))
    assert not_asking is not asking
    first, again = results(measured)
    assert again is first


@pytest.mark.parametrize("known", [False, True], ids=["hidden", "known"])
def test_a_dip_of_a_seal_that_differs_by_direction_is_found_beside_it(tmp_path: Path, known: bool) -> None:
    level = np.where(VELOCITY > 0.0, 12.0, 22.0)
    lost = np.tanh(VELOCITY / 1e-3) * (level + (35.0 - level) * np.exp(-np.abs(VELOCITY) / 0.02)) + 60.0 * VELOCITY
    rig = benches.bench(tmp_path, '[effects.asymmetric_friction.piston]\nforward = "12 N"\nbackward = "22 N"\n' if known else "")
    model = load(rig)
    run = motion_runs.behind_cylinder(motion_runs.balance(lost, 0.3), np.full((TIME.size, 2), 2e5))
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
    (found,) = examine_motion(data, Plan(Split({})), SERIAL, lambda words: None)
    wanted = {"stribeck_friction", "viscous_friction"} | (set() if known else {"asymmetric_friction"})
    assert set(names(found)) == wanted and not found.has_unknown
    dip = next(finding for finding in found.findings if finding.name == "stribeck_friction")
    assert dip.parameters["breakaway"].value == pytest.approx(35.0, rel=0.1)


@pytest.mark.parametrize("apart", [1.0, 8.5])
def test_a_dip_is_found_though_a_spring_stands_in_for_what_two_directions_differ_by(tmp_path: Path, apart: float) -> None:
    """Where a spring is slack nobody knows: two levels of friction are then one level and a shifted spring."""
    dip = 19.4 * np.exp(-((np.abs(VELOCITY) / 0.017) ** 0.9))
    level = np.where(VELOCITY > 0.0, 40.0 + apart, 40.0 - apart)
    lost = np.tanh(VELOCITY / 1e-3) * (level + dip) + 138.0 * VELOCITY + 656.0 * (motion_runs.POSITION - 0.02)
    found = examined(tmp_path, smoothed_alike(TIME, lost))
    said = {name for finding in found.findings for name in (finding.name, *finding.ambiguous_with)}
    assert {"stribeck_friction", "viscous_friction", "return_spring", "coulomb_friction"} <= said and not found.has_unknown
    numbers = {finding.name: finding.parameters for finding in found.findings}
    assert numbers["viscous_friction"]["coefficient"].value == pytest.approx(138.0, rel=0.1)
    assert numbers["stribeck_friction"]["breakaway"].value == pytest.approx(59.4, rel=0.15)


@pytest.mark.slow
def test_a_dip_outlives_that_two_levels_become_one(tmp_path: Path) -> None:
    """A whole machine whose fit ends with two like levels: begun anew at a typical one, the dip was below it and answered to nothing."""
    found = next(one for one in of_whole_machine(tmp_path, "B", 1402) if one.name.startswith("rod of "))
    numbers = {finding.name: finding.parameters for finding in found.findings}
    assert numbers["stribeck_friction"]["breakaway"].value == pytest.approx(59.6, rel=0.1)
    assert numbers["viscous_friction"]["coefficient"].value == pytest.approx(138.0, rel=0.05)
    assert numbers["return_spring"]["stiffness"].value == pytest.approx(656.0, rel=0.05)


@pytest.mark.slow
def test_names_that_no_two_subsets_share_are_found_where_the_rest_leaves_too_much(tmp_path: Path) -> None:
    """Drag in the one, a dip and viscous friction in the other: what both share left 21 times the noise, and was called unknown."""
    (found,) = of_whole_machine(tmp_path, "D", 1411)
    assert {"coulomb_friction", "stribeck_friction", "viscous_friction"} <= set(names(found)) and not found.has_unknown
    dip = next(finding for finding in found.findings if finding.name == "stribeck_friction")
    assert dip.parameters["breakaway"].low < 39.5 < dip.parameters["breakaway"].high


@pytest.mark.parametrize(("out", "back"), [(16.0, 24.0), (20.0, 20.0)])
def test_friction_that_differs_by_direction_is_no_scale_of_a_pressure(tmp_path: Path, out: float, back: float) -> None:
    """A pressure that reads 1.2 % too much pushes like 4 N beside 20 N of friction that the rig has, and leaves little beside the noise."""
    gauge = 4e5 * np.stack([1.0 + 0.1 * np.sin(0.8 * TIME), 1.0 + 0.1 * np.cos(1.3 * TIME)], axis=1)
    lost = smoothed_alike(TIME, np.where(VELOCITY > 0.0, out, -back)) + 60.0 * VELOCITY
    known = '[effects.coulomb_friction.piston]\nforce = "20 N"\n[effects.viscous_friction.piston]\ncoefficient = "60 N s/m"\n'
    rig = benches.bench(tmp_path, known)
    model = load(rig)
    run = motion_runs.behind_cylinder(motion_runs.balance(lost, 0.3), gauge)
    columns = {"piston.pressure_1": 8e-4, "piston.pressure_2": -7e-4}
    levers = {name: np.full(TIME.size, area) for name, area in columns.items()}
    signals = {name: gauge[:, k] for k, name in enumerate(columns)}
    run = replace(run, drive=replace(run.drive, levers=levers, signals=signals))
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
    (found,) = examine_motion(data, Plan(Split({})), SERIAL, lambda words: None)
    assert names(found) == ["asymmetric_friction"] * (out != back) and not found.has_unknown
    for finding in found.findings:
        levels = finding.parameters
        assert levels["forward"].low < out < levels["forward"].high and levels["backward"].low < back < levels["backward"].high
        assert levels["forward"].value == pytest.approx(out, rel=0.15) and levels["backward"].value == pytest.approx(back, rel=0.15)


@pytest.mark.parametrize("most", [None, 4e3], ids=["not known", "known"])
def test_zeros_of_pressures_are_weighed_as_far_off_as_the_gas_lets_them_be(tmp_path: Path, most: float | None) -> None:
    """One zero that is 26 kPa off pushes as friction of two directions does, which no gas sees."""
    rig = benches.bench(tmp_path)
    model = load(rig)
    lost = smoothed_alike(TIME, np.where(VELOCITY > 0.0, 8.0, -50.0))
    run = motion_runs.behind_cylinder(motion_runs.balance(lost, 0.3), np.full((TIME.size, 2), 2e5))
    columns = {"piston.pressure_1": 8e-4, "piston.pressure_2": -7e-4}
    run = replace(run, drive=replace(run.drive, levers={name: np.full(TIME.size, area) for name, area in columns.items()}))
    zeros = {} if most is None else dict.fromkeys(columns, most)
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)}, zeros_within=zeros)
    balance = MotionModel([run], nominal_balance(data, "slide", [run]), Split({}))
    asked = asked_of(balance, data, Plan(Split({})))
    bounds = {c.where: c.parameters[0].high for c in asked if c.effect == "sensor_bias"}
    assert bounds == {column: most or 1e7 for column in columns}
    family = motion_family(balance, nuisance_parameters([run], balance.nominal, "piston"), asked, soft=False)
    offsets = [term for term in family.linearisations[0].terms if term.candidate.effect == "sensor_bias"]
    needed = 0.5 * (50.0 - 8.0) / 8e-4
    assert [bool(term.spread[0] > 0.5 * needed) for term in offsets] == [most is None] * 2


def test_a_dip_is_found_beside_friction_of_pressure_that_the_rig_has(tmp_path: Path) -> None:
    gauge = 2e5 * np.stack([1.0 + 0.8 * np.sin(2.0 * TIME), 1.0 + 0.8 * np.cos(1.3 * TIME)], axis=1)
    level = 10.0 + 4e-5 * gauge.sum(axis=1)
    lost = np.tanh(VELOCITY / 1e-3) * (level + np.maximum(60.0 - level, 0.0) * np.exp(-np.abs(VELOCITY) / 0.02)) + 60.0 * VELOCITY
    rig = benches.bench(tmp_path, '[effects.pressure_dependent_friction.piston]\ncoefficient = "4e-5 m^2"\n')
    model = load(rig)
    run = motion_runs.behind_cylinder(motion_runs.balance(lost, 0.3), gauge)
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
    (found,) = examine_motion(data, Plan(Split({})), SERIAL, lambda words: None)
    assert {"stribeck_friction", "viscous_friction"} <= set(names(found)) and not found.has_unknown


def test_nothing_that_was_lost_is_nothing_that_is_found(tmp_path: Path) -> None:
    found = examined(tmp_path, np.zeros(TIME.size))
    assert names(found) == [] and not found.has_unknown


def test_what_the_rig_has_already_is_not_missing(tmp_path: Path) -> None:
    known = '[effects.viscous_friction.slide]\ncoefficient = "30 N s/m"\n'
    found = examined(tmp_path, 30.0 * VELOCITY, known)
    assert names(found) == [] and found.model.nominal.cylinder["viscous_friction"]["coefficient"][0] == pytest.approx(30.0)


def test_of_laws_at_a_joint_and_at_its_piston_sizes_add_up_and_shapes_do_not(tmp_path: Path) -> None:
    """Of springs the rest of both together is the mean of theirs, weighted by stiffness."""
    rig = benches.bench(
        tmp_path,
        "".join(
            f'[effects.stribeck_friction.{at}]\nbreakaway = "{force} N"\nvelocity = "{speed} m/s"\nexponent = 2\n'
            f'[effects.return_spring.{at}]\nstiffness = "{force} N/m"\nrest = "{rest} m"\n'
            for at, force, speed, rest in (("piston", 30.0, 0.02, 0.1), ("slide", 10.0, 0.06, -0.1))
        ),
    )
    model, still = load(rig), np.full((TIME.size, 2), 2e5)
    run = motion_runs.behind_cylinder(motion_runs.balance(np.zeros(TIME.size), 0.3), still)
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
    both = nominal_balance(data, "slide", data.joints["slide"]).cylinder
    dip, spring = both["stribeck_friction"][0], both["return_spring"][0]
    assert (dip["breakaway"], dip["velocity"], dip["exponent"]) == pytest.approx((40.0, 0.03, 2.0))
    assert (spring["stiffness"], spring["rest"]) == pytest.approx((40.0, 0.05))


@pytest.mark.parametrize("cell", [False, True], ids=["pressures", "load cell"])
def test_what_the_rig_says_of_a_cylinder_with_the_name_of_its_joint_is_the_cylinders_alone(tmp_path: Path, cell: bool) -> None:
    """As on legs, whose cylinders are called as the joints that they drive."""
    rig = benches.renamed(benches.bench(tmp_path, '[effects.coulomb_friction.piston]\nforce = "20 N"\n'), "piston", "slide")
    model = load(rig)
    run = motion_runs.balance(np.zeros(TIME.size), 0.3)
    if not cell:
        run = motion_runs.behind_cylinder(run, np.full((TIME.size, 2), 2e5))
        run = replace(run, drive=replace(run.drive, cylinder="slide"))
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
    assert nominal_balance(data, "slide", [run]).cylinder["coulomb_friction"]["force"][0] == pytest.approx(0.0 if cell else 20.0)


def test_what_was_refuted_is_not_named_again(tmp_path: Path) -> None:
    plan = Plan(Split({}), {("viscous_friction", "slide"): "not borne out"})
    assert "viscous_friction" not in names(examined(tmp_path, 30.0 * VELOCITY, plan=plan))


def test_too_few_samples_are_no_balance(tmp_path: Path) -> None:
    everything = Plan(Split({"recording": ((0.0, 7.99),)}))
    assert names(examined(tmp_path, 30.0 * VELOCITY, plan=everything)) == []


@pytest.mark.parametrize(("cycles", "says"), [(25.0, "one way"), (0.5, "")], ids=["quick", "slow"])
def test_a_balance_of_a_joint_that_turns_round_too_soon_is_left_open_and_it_is_said_why(
    tmp_path: Path, cycles: float, says: str
) -> None:
    turn = 2.0 * np.pi * cycles
    moved = Kinematics(1e-3 * np.sin(turn * TIME), 1e-3 * turn * np.cos(turn * TIME), 1e-5)
    run = replace(motion_runs.balance(np.zeros(TIME.size), 0.3), kinematics=moved)
    rig = benches.bench(tmp_path, cylinder=False)
    model = load(rig)
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
    questions = balances_left_open(examine_motion(data, Plan(Split({})), SERIAL, lambda words: None))
    assert len(questions) == bool(says)
    assert all(says in one.why and "slowly" in one.do for one in questions)


def test_a_joint_that_hardly_moves_is_to_be_moved(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path, cylinder=False)
    model, still = load(rig), np.zeros(TIME.size)
    run = replace(motion_runs.balance(still, 0.3), kinematics=Kinematics(still, still, 1e-3))
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
    (question,) = balances_left_open(examine_motion(data, Plan(Split({})), SERIAL, lambda words: None))
    assert "for 0 times" in question.why and "30 are needed" in question.why and "motion" in question.do


def test_a_probable_effect_that_zeros_and_scales_stand_in_for_is_an_open_question_with_its_experiment(tmp_path: Path) -> None:
    found = examined(tmp_path, np.zeros(TIME.size))
    candidate = next(one for one in candidates(found.model.runs, found.model.nominal, "slide") if one.effect == "coulomb_friction")
    doubted = replace(found, search=replace(found.search, undecided=(candidate,)))
    (question,) = undecided([doubted])
    assert question.question == "whether there is Coulomb friction at slide"
    assert question.do == declared()["coulomb_friction"].experiment
    assert undecided([found]) == ()
    named = examined(tmp_path, 30.0 * VELOCITY)
    drag = named.named[0]
    assert drag.effect == "viscous_friction"
    assert undecided([replace(named, search=replace(named.search, undecided=(drag,)))]) == ()


def test_a_balance_counts_as_judged_where_rows_enough_are_left_to_fit(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path, cylinder=False)
    model = load(rig)
    run = motion_runs.balance(30.0 * VELOCITY, 0.3)
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {"slide": (run,)})
    last = float(TIME[-1])
    assert judged_balances(data, Split({})) == 1
    assert judged_balances(data, Split({run.recording: ((0.0, 0.999 * last),)})) == 0
