"""What nobody can exclude of a balance: which numbers are free depends on what was measured and what the machine has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from diagnosis.motion_runs import POSITION, TIME, VELOCITY, balance, behind_cylinder, plant

from exo_sim.diagnosis.data.motion_run import MotionRun, Passive
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.nuisances import nuisance_parameters, with_damping

RUN = balance(np.zeros(TIME.size), 0.1)


def effects(run: MotionRun = RUN) -> set[str]:
    return {q.effect for q in nuisance_parameters([run], plant(), "slide")}


def test_mass_and_offset_are_free_where_a_force_was_measured() -> None:
    assert {"payload_mass", "offset"} <= effects()
    nothing = np.zeros(TIME.size)
    for recorded in (False, True):  # a column of zeros holds the mass no better than none
        free_swing = replace(RUN, external_recorded=recorded, external=nothing)
        assert "payload_mass" not in effects(free_swing) and "offset" in effects(free_swing)


def test_a_hinge_may_have_another_inertia_and_a_tilted_one_another_zero() -> None:
    assert "inertia" not in effects() and "inertia" in effects(replace(RUN, turning=True))
    alone = effects(replace(RUN, turning=True, inertia=replace(RUN.inertia, alone=True)))
    assert "joint_inertia" in alone and "inertia" not in alone  # beside other joints it is no number of the joint's own
    tilted = replace(RUN, inertia=replace(RUN.inertia, tilt=np.sin(TIME)))
    assert "zero" not in effects() and "zero" in effects(tilted)


def test_of_several_scales_the_column_that_is_felt_most_is_the_measure() -> None:
    strong, weak = np.full(TIME.size, 8e-4), np.full(TIME.size, 1e-4)
    run = behind_cylinder(RUN, np.zeros((TIME.size, 2)))
    signals = {"piston.pressure_1": 1e5 * (1.0 + POSITION), "piston.pressure_2": 1e5 * (1.0 + POSITION)}
    run = replace(run, drive=replace(run.drive, levers=dict(zip(signals, (strong, weak), strict=True)), signals=signals))
    gains = [q.where for q in nuisance_parameters([run], plant(), "piston") if q.effect == "sensor_gain"]
    assert gains == ["piston.pressure_2"]
    assert "drive_delay" in {q.effect for q in nuisance_parameters([run], plant(), "piston")}


def test_friction_that_the_machine_has_is_free_around_what_is_known_of_it() -> None:
    known = plant()
    known.cylinder["coulomb_friction"]["force"] = 12.0
    (force,) = (q for q in nuisance_parameters([RUN], known, "slide") if q.effect == "coulomb_friction")
    assert force.prior is not None and force.prior[0] == 12.0 and force.start == 12.0


def test_the_exponent_of_a_stribeck_dip_that_nobody_gave_is_open() -> None:
    known = plant()
    known.cylinder["stribeck_friction"]["breakaway"], known.cylinder["stribeck_friction"]["velocity"] = 20.0, 0.02

    def exponents() -> list[tuple[float, float] | None]:
        return [q.prior for q in nuisance_parameters([RUN], known, "slide") if q.parameter == "exponent"]

    assert exponents() == [(2.0, 0.75)]
    known.cylinder["stribeck_friction"]["exponent"] = 1.0
    assert exponents() == [(1.0, 0.5)]
    known.cylinder["stribeck_friction"]["breakaway"] = known.cylinder["stribeck_friction"]["velocity"] = 0.0
    known.cylinder["stribeck_friction"]["exponent"] = 0.0
    assert exponents() == []


def test_damping_is_added_only_where_there_is_some_and_only_once() -> None:
    damped = replace(RUN, passive=Passive(-8.0 * VELOCITY, -8.0 * VELOCITY))
    model, bare = (MotionModel([run], plant(), Split({})) for run in (damped, RUN))
    nuisances = nuisance_parameters([damped], plant(), "slide")
    more = with_damping(model, nuisances)
    assert [q.effect for q in more[len(nuisances) :]] == ["joint_damping"]
    assert with_damping(model, more) == () and with_damping(bare, nuisances) == ()


def test_seals_rub_in_every_cylinder_and_bearings_need_not() -> None:
    assert "coulomb_friction" not in effects()
    assert "coulomb_friction" in effects(behind_cylinder(RUN, np.full((TIME.size, 2), 1e5)))


def test_a_seal_whose_friction_of_either_direction_is_known_rubs_by_nothing_else() -> None:
    known = plant()
    known.cylinder["asymmetric_friction"]["forward"], known.cylinder["asymmetric_friction"]["backward"] = 12.0, 16.0
    run = behind_cylinder(RUN, np.full((TIME.size, 2), 1e5))
    rubbing = {q.effect for q in nuisance_parameters([run], known, "slide")}
    assert "asymmetric_friction" in rubbing and "coulomb_friction" not in rubbing
