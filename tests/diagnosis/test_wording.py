"""Sentences for people: every declared effect has one, and what a candidate explains decides which reason is given."""

from __future__ import annotations

import pytest
from diagnosis.waves import BASE, OTHER, candidate

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.policy.verdicts import FAR_WORSE, NOTHING_EXPLAINED
from exo_sim.physics.declaration import declared


def test_a_declared_effect_speaks_for_itself_and_another_by_its_name() -> None:
    for name, effect in declared().items():
        assert wording.says(name) == effect.says
    assert wording.says("made_up") == "Made up."


@pytest.mark.parametrize(("name", "parameter", "factor", "says"), [
    ("flow_capacity", "valve_area", 1.073, "The valve area is 7.3 % larger than nominal."),
    ("dead_volume", "dead_volume_2", 0.88, "The dead volume of chamber 2 is 12.0 % smaller than nominal."),
    ("payload_mass", "payload_mass", 1.2, "The moved mass is 20.0 % larger than nominal."),
    ("piston_leakage", "area", 1.5, "The area of the piston leakage that the rig has is 50 % larger than nominal."),
])  # fmt: skip
def test_a_number_that_is_off_is_named(name: str, parameter: str, factor: float, says: str) -> None:
    assert wording.calibration(name, parameter, factor) == says


def test_the_reason_follows_from_the_share() -> None:
    assert wording.no_gain(OTHER, NOTHING_EXPLAINED) == "it explains nothing of what is left"
    assert "only 30 %" in wording.no_gain(OTHER, 0.3)
    assert "as small as a healthy machine's" in wording.no_gain(OTHER, 0.5)


def test_a_force_and_a_friction_are_told_apart_in_a_sentence() -> None:
    force, friction = (wording.varies(acts, ["position"], 0.5, True) for acts in ("force", "friction"))
    assert force.endswith("by 50 % of all that acts. It does not turn with the direction of motion, as friction would.")
    assert friction.endswith("It turns with the direction of motion, as no force would.")
    assert "do not tell" in wording.varies("force", ["position"], 0.5, False)


def test_another_form_is_no_other_effect() -> None:
    assert wording.rejected(candidate("base", "quick"), BASE, 4.0) == "in the form quick it fits worse"
    assert wording.rejected(OTHER, BASE, 4.25) == "in place of base it fits worse"


@pytest.mark.parametrize("worse", [FAR_WORSE + 0.1, 17153.1, float("inf")])
def test_how_much_worse_a_rival_is_is_said_in_words(worse: float) -> None:
    assert wording.rejected(OTHER, BASE, worse) == "in place of base it fits far worse"


def test_the_experiment_is_that_of_the_effect_mistaken_for_fewer() -> None:
    names = sorted(declared())
    for first, second in zip(names, names[1:], strict=False):
        one, two = declared()[first], declared()[second]
        fewest = one if len(one.mistaken_for) <= len(two.mistaken_for) else two
        assert wording.experiment(first, second) == fewest.experiment
    assert "calibrated" in wording.experiment("made_up", "another")


def test_what_is_left_is_written_without_powers_of_ten() -> None:
    assert "252000 Pa, 3200 times" in wording.rest(1.0, 252_000.0, 78.0, "Pa")


def test_a_curve_that_may_be_a_force_or_a_friction_is_said_to_be_left_out() -> None:
    assert wording.curve("slide.position", 0.27, True, False).endswith("improved.toml does without, for it may be either.")
