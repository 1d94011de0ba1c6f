"""What would change a recommendation, on a search of three designs."""

from dataclasses import replace

import pytest

from exo_sim.sizing.evaluation import ENOUGH_MARGIN, OF_THE_MACHINE
from exo_sim.sizing.screening import CONSTRAINTS
from exo_sim.sizing.search import Found, Outcome
from exo_sim.sizing.sensitivity import cheaper, fails_in_words, sensitivity


@pytest.fixture(scope="module")
def found(exo, task, judge):
    numbers = task.space.owners(exo)
    score = judge.score(numbers)
    score = replace(score, violations=tuple(min(value, -0.1) for value in score.violations), margin=0.4)  # as if it could be had
    chosen = Found(task.space.design(numbers, score.bores, 0, score.springs), score, numbers)
    weak = replace(chosen, design=replace(chosen.design, number=1), score=replace(score, margin=0.1, gas=0.5 * score.gas))
    worse = replace(chosen, design=replace(chosen.design, number=2), score=replace(score, margin=0.05, error=1e3, gas=0.1 * score.gas))
    return chosen, sensitivity(task, Outcome((chosen, weak, worse), (chosen,), 3), chosen, judge.loads)


def test_requirements_come_by_what_is_left(found):
    chosen, what = found
    left = [one.left for one in what.requirements]
    assert left == sorted(left)
    torque = next(one for one in what.requirements if one.name == "torque margin")
    assert torque.left == pytest.approx(chosen.score.margin / ENOUGH_MARGIN - 1.0)
    assert {"hip: buckling, five-fold", "knee: room between the pivots", "chamber pressure"} <= {one.name for one in what.requirements}


def test_only_what_fails_one_requirement_alone_and_is_cheaper_counts(found):
    _, what = found
    assert [(one.requirement, one.found.design.number) for one in what.relaxed] == [("torque margin", 1)]
    assert what.relaxed[0].needs.startswith("10 % in place of 25 %")


def test_neighbours_differ_in_one_number_and_say_what_they_fail(found, task, judge):
    chosen, what = found
    names = [one.what for one in what.neighbours]
    assert len(names) == len(set(names)) and any("bore" in name for name in names) and any("supply" in name for name in names)
    smaller = next((one for one in what.neighbours if one.what.startswith("knee: bore")), None)
    assert smaller is not None and smaller.score.mass != chosen.score.mass
    for one in what.neighbours:
        assert bool(one.fails) == (max(one.score.violations) > 0.0 or one.score.margin < ENOUGH_MARGIN or "error" in one.fails)
        if cheaper(one, chosen.score):
            assert one.score.gas < chosen.score.gas or one.score.mass < chosen.score.mass


def test_what_a_design_fails_is_said_in_words():
    assert fails_in_words("knee: torque", 0.12) == "knee: torque short by 12 % of its peak"
    # ten times the peak is no lack of strength: air does not get in and out as fast as the piston moves
    assert fails_in_words("knee: torque", 9.34) == "knee: valve too small for the joint's speed: the gas brakes instead of driving"
    assert fails_in_words("chamber pressure", 0.03) == "chambers 3 % beyond their largest pressure"


@pytest.mark.parametrize("constraint", [*(f"hip: {name}" for name in CONSTRAINTS), *OF_THE_MACHINE])
def test_every_constraint_has_words(constraint):
    assert fails_in_words(constraint, 0.5).startswith("hip: ") == constraint.startswith("hip: ")
