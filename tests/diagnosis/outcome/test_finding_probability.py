"""How probable a name is by what it explains of held-out time."""

from __future__ import annotations

from dataclasses import replace

import pytest

from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.outcome.finding_probability import by_share, confidence
from exo_sim.diagnosis.policy.probability import LEAST_PROBABILITY, MAY_BE_NIL, UNTESTED
from exo_sim.diagnosis.policy.verdicts import CONFIDENT_BESIDE_UNKNOWN, MOST_CONFIDENT


def named(log10_odds: float, weighed: float | None = None) -> Finding:
    return Finding("quadratic_drag", "piston", Kind.MISSING_PHYSICS, "", {}, log10_odds, 0.0, probability=weighed)


def test_great_odds_do_not_make_a_name_probable_that_explains_little_of_time_kept_back() -> None:
    shares = (0.0, 0.05, 0.14, 0.3, 0.6, 1.0)
    found = [confidence(named(2000.0), share) for share in shares]
    assert found == sorted(found) and found[0] < 0.01 and found[-1] > 0.94
    assert found == pytest.approx([by_share(share) for share in shares])


def test_nothing_is_more_probable_than_it_was_weighed() -> None:
    assert confidence(named(300.0, weighed=0.8), 1.0) == 0.8
    assert confidence(named(0.0), 1.0) == 0.5


def test_a_name_of_forces_whose_pressures_nobody_understands_is_not_certain() -> None:
    assert confidence(named(300.0), 1.0, of_doubtful_pressures=True) == CONFIDENT_BESIDE_UNKNOWN < confidence(named(300.0), 1.0)
    assert confidence(named(300.0, weighed=0.6), 1.0, of_doubtful_pressures=True) == 0.6


def test_a_name_without_which_more_was_missed_is_no_less_probable_than_what_is_kept() -> None:
    assert confidence(named(300.0), 0.0, is_upheld=True) == LEAST_PROBABILITY > confidence(named(300.0), 0.0)
    assert confidence(named(300.0), 1.0, is_upheld=True) == confidence(named(300.0), 1.0)
    assert confidence(named(300.0, weighed=0.3), 0.0, is_upheld=True) == 0.3


@pytest.mark.parametrize(("weighed", "said"), [(None, UNTESTED), (0.6, 0.6), (0.99, UNTESTED)])
def test_what_was_not_tested_is_not_certain(weighed: float | None, said: float) -> None:
    assert confidence(named(300.0, weighed), None) == said
    assert said < MOST_CONFIDENT


@pytest.mark.parametrize(
    ("low", "weighed", "said"),
    [(0.0, 1.0, MAY_BE_NIL), (0.0, 0.55, 0.55), (2.0, 0.9, 0.9), (0.0, None, MAY_BE_NIL), (2.0, None, 0.95)],
)
def test_a_name_whose_number_may_be_nil_is_not_certain(low: float, weighed: float | None, said: float) -> None:
    finding = replace(named(300.0, weighed), parameters={"coefficient": Estimate(50.0, "N s^2/m^2", low, 97.0)})
    assert confidence(finding, 1.0) == pytest.approx(float(said), abs=2e-3)


@pytest.mark.parametrize(("backward", "said"), [((18.0, 14.0, 22.0), MAY_BE_NIL), ((24.0, 22.0, 26.0), 0.9)])
def test_friction_of_two_directions_may_be_that_of_one(backward: tuple[float, float, float], said: float) -> None:
    """Both numbers are far from nil: what may be nil is what they tell apart."""
    parts = {"forward": Estimate(16.0, "N", 13.0, 19.0), "backward": Estimate(backward[0], "N", *backward[1:])}
    assert confidence(replace(named(300.0, 0.9), name="asymmetric_friction", parameters=parts), 1.0) == pytest.approx(float(said), abs=2e-3)
