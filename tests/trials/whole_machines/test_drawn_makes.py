"""Makes that chance draws: the same for the same number, all different, and machines that are sold."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.errors import TrialError
from exo_sim.trials.whole_machines.case import make_case
from exo_sim.trials.whole_machines.draw import build
from exo_sim.trials.whole_machines.drawn_makes import FIRST_REPORTED, drawn_make, number_of
from exo_sim.trials.whole_machines.excitation import PROGRAMS
from exo_sim.trials.whole_machines.hidden_effects import BLOCKS
from exo_sim.trials.whole_machines.make import CONTROLLER, PLANT
from exo_sim.trials.whole_machines.makes import find, letters
from exo_sim.trials.whole_machines.published_cylinders import SERIES


def test_a_number_names_one_make() -> None:
    assert drawn_make(7) == drawn_make(7) == find("X7")
    assert len({repr(drawn_make(number).laws) for number in range(40)}) == 40


@pytest.mark.parametrize(("name", "number"), [("X12", 12), ("X0", 0), ("X", None), ("A", None), ("X-1", None), ("XY", None)])
def test_a_drawn_make_is_called_by_its_number(name: str, number: int | None) -> None:
    assert number_of(name) == number


def test_a_span_of_numbers_is_a_list_of_makes() -> None:
    assert letters("A,X3-X5") == ("A", "X3", "X4", "X5")
    for wrong in ("X3-B", "X5-X3"):
        with pytest.raises(TrialError):
            letters(wrong)


def test_only_high_numbers_are_reported_on() -> None:
    assert not drawn_make(FIRST_REPORTED - 1).reported and drawn_make(FIRST_REPORTED).reported


def test_drawn_makes_have_cylinders_that_are_sold_and_effects_that_there_are() -> None:
    for number in range(60):
        make = drawn_make(number)
        assert set(make.bores) <= set(SERIES[make.series]) and set(make.optional) <= set(BLOCKS)
        assert len(make.programs) == 4 and set(make.programs) | set(make.fresh) <= set(PROGRAMS)
        assert not (make.single and make.build == "lever")
        assert make.rate <= 500.0 or make.grade not in (PLANT, CONTROLLER)
        machine = build(make, "whole", np.random.default_rng(number)).machine
        assert machine["area_1"] > machine["area_2"] > 0.0 and machine.moved_mass > 0.0


def test_a_drawn_machine_is_recorded() -> None:
    case = make_case("x", "X1", seed=1, duration=4.0, weigh=False)
    assert case.built.make == drawn_make(1) and len(case.built.hidden) >= 5
