"""Questions that stay open name the part, the recording, the effects they are about, and why."""

from __future__ import annotations

from exo_sim.diagnosis.data import open_questions
from exo_sim.diagnosis.data.open_questions import Unjudged


def test_each_names_its_part_its_recording_and_its_reason() -> None:
    gas = open_questions.of_gas("piston", "first", Unjudged("no pressure of it was recorded"))
    assert gas.question == "the gas of piston in first" and gas.why == "no pressure of it was recorded"
    forces = open_questions.of_balance("knee", "second", Unjudged("the joint was led"))
    assert "knee" in forces.question and "second" in forces.question and forces.why == "the joint was led"
    assert set(gas.effects).isdisjoint(forces.effects)
    assert "knee" in open_questions.of_remainder("knee").question
