"""Questions that stay open name the part, the recording, the effects they are about, and why."""

from __future__ import annotations

from exo_sim.diagnosis.data import open_questions
from exo_sim.diagnosis.data.open_questions import Unjudged
from exo_sim.physics.declaration import declared


def test_each_names_its_part_its_recording_and_its_reason() -> None:
    gas = open_questions.of_gas("piston", "first", Unjudged("no pressure of it was recorded"))
    assert gas.question == "the gas of piston in first" and gas.why == "no pressure of it was recorded"
    forces = open_questions.of_balance("knee", "second", Unjudged("the joint was led"))
    assert "knee" in forces.question and "second" in forces.question and forces.why == "the joint was led"
    assert set(gas.effects).isdisjoint(forces.effects)
    assert "knee" in open_questions.of_remainder("knee").question


def test_what_they_are_about_are_names_of_effects_and_words_beside_them() -> None:
    unjudged = Unjudged("no pressure of it was recorded")
    gas, forces = open_questions.of_gas("piston", "first", unjudged), open_questions.of_balance("knee", "second", unjudged)
    one = open_questions.of_undecided("asymmetric_friction", "asymmetric friction", "piston", "move it")
    for question in (gas, forces, one, open_questions.of_free_swing("knee", 0.1, 1.0), open_questions.of_remainder("knee")):
        assert question.effects and set(question.effects) <= set(declared())
    assert "valve_lag" in gas.effects and "coulomb_friction" in forces.effects and one.effects == ("asymmetric_friction",)
    assert gas.as_dict()["called"] == "gas and valve effects" and "called" not in one.as_dict()
    assert one.question == "whether there is asymmetric friction at piston"
