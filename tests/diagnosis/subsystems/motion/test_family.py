"""The family of what resists a motion: each law is named with its numbers, over decades of size, beside the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import ACCELERATION, MASS, POSITION, TIME, VELOCITY

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.policy.priors import BREAKAWAY
from exo_sim.diagnosis.selection.family_search import FamilySearch
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.linear_evidence import Spreads
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.subsystems.motion.candidates import candidates
from exo_sim.diagnosis.subsystems.motion.family import motion_family
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.nuisances import nuisance_parameters
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_alike

SIGN = np.sign(VELOCITY)


def searched(model: MotionModel) -> SearchResult:
    nuisances = nuisance_parameters(model.runs, model.nominal, model.where)
    family = motion_family(model, nuisances, candidates(model.runs, model.nominal, model.where))
    return FamilySearch(ModelFits(model, nuisances, cheap=True), family, model.discrepancy_basis()).run()


def lost(**sizes: float) -> np.ndarray:
    """Return the force that is lost to friction and springs of these sizes."""
    laws = {
        "viscous": VELOCITY, "coulomb": smoothed_alike(TIME, SIGN), "quadratic": VELOCITY * np.abs(VELOCITY), "spring": POSITION - 0.01,
        "stribeck": smoothed_alike(TIME, SIGN * np.exp(-((VELOCITY / 0.06) ** 2))),
    }  # fmt: skip
    return sum((size * laws[name] for name, size in sizes.items()), np.zeros(TIME.size))


def named(found: SearchResult) -> dict[str, float]:
    """Return the effects of the final model with their first parameter."""
    return {c.effect: found.final.fit.values[c.parameters[0]] for c in found.final.candidates if not c.is_law}


@pytest.mark.parametrize(
    ("effect", "sizes", "value"),
    [
        ("viscous_friction", {"viscous": 30.0}, 30.0),
        ("coulomb_friction", {"coulomb": 6.0}, 6.0),
        ("quadratic_drag", {"quadratic": 120.0}, 120.0),
        ("return_spring", {"spring": 90.0}, 90.0),
    ],
)
def test_one_law_is_named_with_its_number(effect: str, sizes: dict[str, float], value: float) -> None:
    found = named(searched(MotionModel([motion_runs.balance(lost(**sizes), 0.3)], motion_runs.plant(), Split({}))))
    assert set(found) == {effect} and found[effect] == pytest.approx(value, rel=0.05)


@pytest.mark.parametrize("times", [0.2, 1.0, 20.0])
def test_dry_friction_with_a_dip_and_viscous_friction_are_found_together_over_two_decades(times: float) -> None:
    sizes = {"coulomb": 12.0 * times, "stribeck": 9.0 * times, "viscous": 60.0 * times}
    found = searched(MotionModel([motion_runs.balance(lost(**sizes), 0.1 * times)], motion_runs.plant(), Split({})))
    assert set(named(found)) == {"coulomb_friction", "stribeck_friction", "viscous_friction"}
    for candidate in found.final.candidates:
        size, true = candidate.parameters[0], {"coulomb_friction": 12.0, "viscous_friction": 60.0, "stribeck_friction": 21.0}
        value, error = found.final.fit.values[size], HALF_WIDTH * found.errors[size]
        assert abs(value - true[candidate.effect] * times) < error < value, candidate.effect


def test_a_level_that_the_rig_has_and_that_differs_by_direction_is_found_beside_it() -> None:
    """Less of what the rig has one way, and more of it the other way."""
    plant = motion_runs.plant()
    plant.cylinder["coulomb_friction"]["force"] = 12.0
    ways = smoothed_alike(TIME, np.where(VELOCITY > 0.0, 15.0, 7.0) * SIGN)
    run = motion_runs.behind_cylinder(motion_runs.balance(ways + 60.0 * VELOCITY, 0.1), np.zeros((TIME.size, 2)))
    found = searched(MotionModel([run], plant, Split({})))
    assert set(named(found)) == {"asymmetric_friction", "viscous_friction"}
    values = {q.parameter: value for q, value in found.final.fit.values.items() if q.effect == "asymmetric_friction"}
    assert values["forward"] == pytest.approx(15.0, rel=0.05) and values["backward"] == pytest.approx(7.0, rel=0.1)
    assert [value for _, value in found.final.fixed] == [0.0], "the whole friction of each direction, in the place of what the rig has"


def test_no_dip_is_many_times_the_level_that_slides() -> None:
    model = MotionModel([motion_runs.balance(lost(coulomb=12.0, stribeck=9.0), 0.1)], motion_runs.plant(), Split({}))
    asked = candidates(model.runs, model.nominal, model.where)
    terms = motion_family(model, (), asked, soft=False).linearisations[0].terms
    dips = [term for term in terms if term.candidate.effect == "stribeck_friction"]
    assert dips and max(float(term.spread[0]) for term in dips) <= BREAKAWAY * 20.0


def test_a_frictionless_balance_bears_no_name() -> None:
    found = searched(MotionModel([motion_runs.balance(np.zeros(TIME.size), 0.3)], motion_runs.plant(), Split({})))
    assert named(found) == {}


@pytest.mark.parametrize("beyond", [-2.5, -0.8, 0.0, 3.0])
def test_a_spring_that_is_preloaded_is_known_with_its_preload(beyond: float) -> None:
    """What it pulls with in the middle of the travel is no bias of the pressure that drives it."""
    rest = float(np.mean(POSITION)) + beyond * float(np.ptp(POSITION))
    run = motion_runs.behind_cylinder(motion_runs.balance(lost(coulomb=6.0) + 90.0 * (POSITION - rest), 0.3), np.zeros((TIME.size, 2)))
    found = searched(MotionModel([run], motion_runs.plant(), Split({})))
    assert named(found) == pytest.approx({"return_spring": 90.0, "coulomb_friction": 6.0}, rel=0.05)
    values = {q.key[::2]: value for q, value in found.final.fit.values.items()}
    assert values["return_spring", "rest"] == pytest.approx(rest, abs=0.1 * float(np.ptp(POSITION)))


def test_a_constant_force_is_no_spring_that_is_slack_far_away() -> None:
    run = motion_runs.balance(40.0 + lost(coulomb=12.0), 0.3)
    run = replace(run, drive=replace(run.drive, levers={"slide.external_force": np.ones(TIME.size)}))
    found = named(searched(MotionModel([run], motion_runs.plant(), Split({}))))
    assert "return_spring" not in found and found["coulomb_friction"] == pytest.approx(12.0, rel=0.05)


def test_a_trace_of_a_spring_in_a_joint_without_a_cylinder_is_no_finding() -> None:
    """The balance between a load cell and the load: 1 % of the forces that act over the whole travel."""
    acting = MASS * float(np.percentile(np.abs(ACCELERATION), 99.0))
    trace = 0.01 * acting / float(np.ptp(POSITION))
    assert named(searched(MotionModel([motion_runs.balance(lost(spring=trace), 1e-3)], motion_runs.plant(), Split({})))) == {}


def test_scale_and_delay_of_what_measures_the_force_are_no_friction() -> None:
    """Pressures drive; the force from outside reads 2 % too much and both come 1 ms late."""
    driving = MASS * ACCELERATION + lost(viscous=30.0) + 40.0 * np.sin(1.7 * TIME)
    outside = -40.0 * np.sin(1.7 * TIME)
    late = [np.interp(TIME - 1e-3, TIME, values) for values in (driving, 1.02 * outside)]
    run = motion_runs.balance(np.zeros(TIME.size), 0.3)
    ones = np.ones(TIME.size)
    drive = replace(
        run.drive, force=late[0], levers={"piston.force": ones, "slide.external_force": ones},
        signals={"piston.force": late[0], "slide.external_force": late[1]},
    )  # fmt: skip
    noise = 0.1 * np.random.default_rng(2).standard_normal(TIME.size)
    found = searched(MotionModel([replace(run, drive=drive, external=late[1] + noise)], motion_runs.plant(), Split({})))
    assert named(found) == pytest.approx({"viscous_friction": 30.0}, rel=0.05)
    values = {q.parameter: value for q, value in found.final.fit.values.items()}
    assert values["drive.delay"] == pytest.approx(1e-3, abs=2e-4)


def test_friction_that_builds_up_with_speed_is_a_law_and_no_finding() -> None:
    creeping = smoothed_alike(TIME, 8.0 * np.tanh(VELOCITY / 0.02))
    found = searched(MotionModel([motion_runs.balance(creeping, 0.05)], motion_runs.plant(), Split({})))
    assert named(found) == pytest.approx({"coulomb_friction": 8.0}, rel=0.05)
    (law,) = (c for c in found.final.candidates if c.is_law)
    assert found.final.fit.values[law.parameters[0]] == pytest.approx(0.02, rel=0.3)


@pytest.mark.parametrize(
    ("variable", "varies"),
    [("position", 0.5 * np.cos(2.0 * np.pi * POSITION / 0.1)), ("time", 1.5 * np.exp(-TIME / 3.0))],
)
def test_friction_that_depends_on_place_or_time_stands_without_a_name_beside_the_names(variable: str, varies: np.ndarray) -> None:
    """Neither takes a name away nor adds one: the level is still the mean one, and what is viscous is right."""
    dry = smoothed_alike(TIME, 10.0 * (1.0 + varies) * SIGN)
    found = searched(MotionModel([motion_runs.balance(dry + 60.0 * VELOCITY, 0.1)], motion_runs.plant(), Split({})))
    assert set(named(found)) == {"coulomb_friction", "viscous_friction"}
    assert named(found)["viscous_friction"] == pytest.approx(60.0, rel=0.1)
    assert [one.variable for one in found.unnamed] == [variable] and found.unnamed[0].share > 0.1


def test_friction_that_is_the_same_everywhere_has_nothing_unnamed_beside_it() -> None:
    uneven = 10.0 * (1.0 + 0.04 * np.cos(2.0 * np.pi * POSITION / 0.1))
    found = searched(MotionModel([motion_runs.balance(smoothed_alike(TIME, uneven * SIGN), 0.1)], motion_runs.plant(), Split({})))
    assert set(named(found)) == {"coulomb_friction"} and found.unnamed == ()


def test_what_no_noise_leaves_open_of_a_law_is_in_the_interval_of_the_level() -> None:
    """A dip that falls slowly with speed leaves less to the level at which a contact slides: no law is known to a thousandth."""
    run = motion_runs.balance(lost(coulomb=12.0, stribeck=9.0, viscous=60.0), 0.02)
    found = searched(MotionModel([run], motion_runs.plant(), Split({})))
    (level,) = next(c for c in found.final.candidates if c.effect == "coulomb_friction").parameters
    assert abs(found.final.fit.values[level] - 12.0) < 2.0 * found.errors[level]
    assert 0.06 < found.errors[level] < 1.5  # a film that thins leaves less to it


def test_a_rig_that_knows_its_friction_lacks_no_more_than_any_model_of_it() -> None:
    """What it lacks is all place, but a twentieth of its friction."""
    knowing = motion_runs.plant()
    knowing.cylinder["coulomb_friction"]["force"] = 10.0
    uneven = smoothed_alike(TIME, 10.0 * (1.0 + 0.05 * np.cos(2.0 * np.pi * POSITION / 0.1)) * SIGN)
    found = searched(MotionModel([motion_runs.balance(uneven, 0.05)], knowing, Split({})))
    assert named(found) == {} and found.unnamed == ()


def test_where_friction_is_known_to_build_up_with_speed_no_other_contact_is_weighed() -> None:
    model = MotionModel([motion_runs.balance(lost(coulomb=6.0), 0.1)], motion_runs.plant(), Split({}))
    asked = candidates(model.runs, model.nominal, model.where)
    (creep,) = next(one.parameters for one in asked if one.effect == "friction_smoothing")
    nuisances = nuisance_parameters(model.runs, model.nominal, model.where)
    family = motion_family(model, nuisances, asked, contacts=[{creep: 2e-3}, {creep: 1e-3}])
    assert [tuple(linear.values.values()) for linear in family.linearisations] == [(2e-3,), (1e-3,)]
    assert {linear.candidate.effect for linear in family.linearisations if linear.candidate} == {"friction_smoothing"}


@pytest.mark.parametrize(("beside", "asked"), [(2.4, True), (0.3, False)])
def test_a_constant_force_beyond_what_zeros_make_leaves_friction_that_differs_by_direction_open(beside: float, asked: bool) -> None:
    """Zeros of 0.96 N, one standard deviation, are not what 2.4 N are made of, and do not exclude them."""
    plant = motion_runs.plant()
    plant.cylinder["coulomb_friction"]["force"] = 12.0
    run = motion_runs.behind_cylinder(motion_runs.balance(lost(coulomb=12.0) + beside, 0.1), np.zeros((TIME.size, 2)))
    run = replace(run, drive=replace(run.drive, levers={"piston.pressure_1": np.full(TIME.size, 8e-4)}))
    found = searched(MotionModel([run], plant, Split({})))
    assert named(found) == {}
    assert [c.effect for c in found.undecided] == ["asymmetric_friction"] * asked


@pytest.mark.parametrize(("with_it", "stands"), [(0.4, True), (0.595, False)])
def test_names_stand_by_what_they_leave_of_a_machine_that_is_quieter_than_its_noise_is_taken_for(with_it: float, stands: bool) -> None:
    model = MotionModel([motion_runs.balance(lost(coulomb=6.0), 0.1)], motion_runs.plant(), Split({}))
    nuisances = nuisance_parameters(model.runs, model.nominal, model.where)
    asked = candidates(model.runs, model.nominal, model.where)
    basis = model.discrepancy_basis()
    search = FamilySearch(ModelFits(model, nuisances, cheap=True), motion_family(model, nuisances, asked, soft=False), basis)
    left = np.random.default_rng(3).standard_normal(model.size)
    friction = next(one for one in asked if one.effect == "coulomb_friction")
    plain, named = (
        FittedModel(names, Fit((), {}, level * left, np.zeros((model.size, 0)))) for names, level in (((), 0.6), ((friction,), with_it))
    )
    spreads = Spreads(0.6, tuple(float(scale) for scale in basis.healthy))
    assert search.finalist_fits.evidence.is_decisive(named, plain, spreads) is stands


def test_a_dip_that_is_seen_at_no_speed_is_as_high_as_seals_are() -> None:
    """Fitted without its prior, a dip that falls below all speeds that occurred has any height."""
    asked = candidates((motion_runs.balance(lost(coulomb=12.0), 0.1),), motion_runs.plant(), "slide")
    model = MotionModel([motion_runs.balance(lost(coulomb=12.0), 0.1)], motion_runs.plant(), Split({}))
    dips = [t for t in motion_family(model, (), asked, soft=False).linearisations[0].terms if t.candidate.effect == "stribeck_friction"]
    (prior,) = {q.prior for t in dips for q in t.candidate.parameters if q.parameter == "breakaway"}
    assert prior is not None and prior[1] == pytest.approx(BREAKAWAY * prior[0])


def test_a_dip_with_a_tail_is_fitted_and_not_weighed_over_a_grid() -> None:
    """Its breakaway is believed as that of the dip without one: else the two would not be forms of one law."""
    asked = candidates((motion_runs.balance(lost(coulomb=12.0), 0.1),), motion_runs.plant(), "slide")
    model = MotionModel([motion_runs.balance(lost(coulomb=12.0), 0.1)], motion_runs.plant(), Split({}))
    family = motion_family(model, (), asked, soft=False)
    dips = {t.candidate for t in family.linearisations[0].terms if t.candidate.effect == "stribeck_friction"}
    ((plain,), (tailed,)) = dips, family.fitted_forms
    (tail,) = set(tailed.parameters) - set(plain.parameters)
    assert set(plain.parameters) < set(tailed.parameters) and tail.parameter == "tail" and tail.start == 0.0


def test_a_tail_is_found_from_the_dip_without_one() -> None:
    """A Lorentzian of 21 N at rest and 12 N at speed, beside 60 N s/m."""
    law = 12.0 + 9.0 / (1.0 + (VELOCITY / 0.02) ** 2)
    run = motion_runs.balance(smoothed_alike(TIME, SIGN * law) + 60.0 * VELOCITY, 0.1)
    found = searched(MotionModel([run], motion_runs.plant(), Split({})))
    assert set(named(found)) == {"coulomb_friction", "stribeck_friction", "viscous_friction"}
    values = {q.parameter: value for q, value in found.final.fit.values.items() if q.effect == "stribeck_friction"}
    assert values["breakaway"] == pytest.approx(21.0, rel=0.03) and values["tail"] == pytest.approx(1.0, abs=0.1)
