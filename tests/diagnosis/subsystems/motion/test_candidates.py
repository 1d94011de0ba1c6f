"""Candidates of a balance of forces: by place, with starts in the size of the forces that act, and what the machine has is left out."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from diagnosis.motion_runs import TIME, VELOCITY, balance, behind_cylinder, plant

from exo_sim.diagnosis.data.motion_run import Imputed
from exo_sim.diagnosis.subsystems.motion.candidates import candidates
from exo_sim.physics.declaration import declared

RUN = balance(5.0 * np.sign(VELOCITY), 0.1)


def test_a_joint_is_asked_what_acts_at_joints_only() -> None:
    for one in candidates([RUN], plant(), "slide"):
        effect = declared()[one.effect]
        assert effect.cut == "motion" and "joint" in (effect.identification.applicability.places or effect.places)


def test_starts_are_a_tenth_of_the_forces_spread_over_the_motion() -> None:
    force, speed = float(np.std(RUN.external)), float(np.std(VELOCITY))
    starts = {one.effect: one.starts[0] for one in candidates([RUN], plant(), "slide")}
    assert starts["coulomb_friction"][0] == pytest.approx(0.1 * force)
    assert starts["viscous_friction"][0] == pytest.approx(0.1 * force / speed)


def test_what_the_machine_has_on_already_is_not_asked_again() -> None:
    on = plant()
    on.cylinder["viscous_friction"]["coefficient"] = 10.0
    assert "viscous_friction" in {one.effect for one in candidates([RUN], plant(), "slide")}
    assert "viscous_friction" not in {one.effect for one in candidates([RUN], on, "slide")}


def test_of_an_effect_whose_richer_form_the_machine_has_nothing_is_asked() -> None:
    on = plant()
    on.cylinder["asymmetric_friction"]["forward"] = on.cylinder["asymmetric_friction"]["backward"] = 10.0
    run = behind_cylinder(RUN, np.full((TIME.size, 2), 2e5))
    asked, still_asked = ({one.effect: one for one in candidates([run], machine, "piston")} for machine in (plant(), on))
    assert "coulomb_friction" in asked and "coulomb_friction" not in still_asked
    # the richer form bears what comes on top of the poorer one
    assert asked["stribeck_friction"].prerequisite == "coulomb_friction" and still_asked["stribeck_friction"].prerequisite == ""


def test_a_measured_pressure_may_be_off_by_a_bias_and_a_predicted_one_may_hide_a_leak() -> None:
    gauge = np.full((TIME.size, 2), 2e5)
    run = behind_cylinder(RUN, gauge)
    lever = {"piston.pressure_1": np.full(TIME.size, 8e-4)}
    run = replace(run, drive=replace(run.drive, levers=lever))
    measured = {one.at for one in candidates([run], plant(), "piston")}
    assert ("sensor_bias", "piston.pressure_1") in measured
    imputed = replace(run, imputed=Imputed(leaks={"area_2": np.ones(TIME.size)}))
    predicted = {one.at for one in candidates([imputed], plant(), "piston")}
    assert ("sensor_bias", "piston.pressure_1") not in predicted and ("external_leakage", "piston") in predicted


def test_a_contact_that_rests_until_it_breaks_loose_creeps_no_faster_than_its_rest() -> None:
    def creeping(below: float) -> list[float]:
        found = candidates([RUN], plant(), "slide", creeps_below=below)
        return [one.parameters[0].high for one in found if one.effect == "friction_smoothing"]

    usual = declared()["friction_smoothing"].parameter("velocity")
    assert creeping(math.inf) == [usual.high] and creeping(0.5 * usual.high) == [0.5 * usual.high] and creeping(0.5 * usual.low) == []
