"""Numbers that every fit moves: effects may be mistaken for them, and policy says from where on they are off."""

from __future__ import annotations

from exo_sim.diagnosis import nominal_numbers
from exo_sim.diagnosis.policy.off_nominal import BEYOND_SHEET, WORTH
from exo_sim.physics.declaration import CALIBRATED, declared

NAMES = {value for key, value in vars(nominal_numbers).items() if key.isupper()}


def test_those_that_effects_may_be_mistaken_for_are_among_them() -> None:
    assert set(CALIBRATED) <= NAMES


def test_policy_speaks_of_no_others() -> None:
    assert {*WORTH, *BEYOND_SHEET} <= NAMES


def test_none_has_the_name_of_an_effect() -> None:
    assert not NAMES & set(declared())
