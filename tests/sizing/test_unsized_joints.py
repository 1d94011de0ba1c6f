"""Cylinders that are not sized: what a supply leaves of them, and a search that does not take it from them."""

from dataclasses import replace

import pytest

from exo_sim.sizing.evaluation import OF_THE_MACHINE, Evaluator, Task
from exo_sim.sizing.study import space_of
from exo_sim.sizing.unsized_joints import kinds_left_alone, left_alone


@pytest.fixture(scope="module")
def knees(exo):
    """Knees to size with up to 19 bar, for which the hips were made."""
    return space_of(exo, 0.04, 19e5, ("knee_l", "knee_r"))


def test_all_that_has_cylinders_is_sized_or_left_alone(exo, space, knees):
    assert kinds_left_alone(exo, space.kinds) == ()
    (hip,) = kinds_left_alone(exo, knees.kinds)
    assert hip.name == "hip" and hip.cylinders == ("hip_l", "hip_r")


def test_less_supply_leaves_less(exo, knees, loads):
    others = kinds_left_alone(exo, knees.kinds)
    (high,), (low,) = (left_alone(exo, others, (loads,), supply) for supply in (exo.supply.pressure, 4e5))
    assert high.margin > 0.0 > low.margin and "torque margin" in high.words and "is too weak at 4.0 bar" in low.words


def test_a_design_whose_supply_is_too_low_for_them_is_not_walked_with(exo, condition, knees):
    judge, at = Evaluator(Task(exo, (condition,), knees)), OF_THE_MACHINE.index("joints not sized") - len(OF_THE_MACHINE)
    numbers = knees.owners(exo)
    enough = judge.score(numbers)
    short = judge.score({**numbers, "supply": 6e5, "knee.above": 1.0})
    assert enough.violations[at] < 0.0 and enough.simulated
    assert short.violations[at] > 0.0 and max(short.violations[:at]) <= 0.0 and not short.simulated


def test_no_design_is_blamed_where_no_supply_that_is_allowed_suffices(exo, condition, knees):
    low = replace(knees, fixed=(("supply", 6e5),))
    score = Evaluator(Task(exo, (condition,), low)).score({**low.owners(exo), "knee.above": 1.0})
    assert score.violations[OF_THE_MACHINE.index("joints not sized") - len(OF_THE_MACHINE)] == 0.0 and score.simulated
