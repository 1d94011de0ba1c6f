"""What a diagnosis of a real machine is worth."""

from __future__ import annotations

from typing import Any

import pytest

from exo_sim.trials.real.case import Known, Name
from exo_sim.trials.real.errors import ratio
from exo_sim.trials.real.judge import Mark, judge

KNOWN = Known(
    must=(Name(("coulomb_friction", "asymmetric_friction"), ("piston", "slide")), Name(("pressure_dependent_friction",), ("piston",))),
    may=(Name(("sensor_bias",), ("piston.pressure_1",)),),
    unknown=False,
    published={},
    source="",
)


def finding(name: str, where: str, **more: Any) -> dict[str, Any]:
    return {"name": name, "where": where, "kind": "missing_physics", **more}


def marked(*effects: dict[str, Any], after: float | None = 1.0, before: float = 10.0, honest: float = 1.0) -> Mark:
    errors = None if after is None else {"force": after}
    return judge("seal", KNOWN, {"verdict": "mismatch", "effects": list(effects)}, {"force": before}, errors, {"force": honest})


BOTH = (finding("coulomb_friction", "slide"), finding("pressure_dependent_friction", "piston/force balance"))


def test_all_names_and_a_rig_as_good_as_the_best() -> None:
    assert marked(*BOTH).mark == 1.0
    assert marked(*BOTH, finding("sensor_bias", "piston.pressure_1", kind="sensor")).mark == 1.0
    assert marked(*BOTH, finding("payload_mass", "carriage", kind="calibration")).mark == 1.0


@pytest.mark.parametrize(("after", "mark"), [(1.29, 1.0), (2.15, 0.5), (3.0, 0.0), (30.0, 0.0), (0.5, 1.0)])
def test_the_rig_is_held_against_the_best_honest_model(after: float, mark: float) -> None:
    assert marked(*BOTH, after=after).errors == pytest.approx(mark)


def test_a_rig_worse_than_the_one_handed_in_is_worth_nothing() -> None:
    assert marked(*BOTH, after=1.1, before=1.0).errors == 0.0
    assert marked(*BOTH, after=None).errors == 0.0


def test_names_missed_and_names_that_must_not_be_there() -> None:
    one = marked(BOTH[0])
    assert one.names == 0.5 and one.mark == 0.75 and len(one.missed) == 1
    wrong = marked(*BOTH, finding("sensor_delay", "piston.pressure_1", kind="sensor"))
    assert wrong.mark == 0.0 and wrong.forbidden == ("sensor_delay (piston.pressure_1)",)
    assert marked(*BOTH, finding("coulomb_friction", "piston_2")).mark == 0.0


def test_what_cannot_be_distinguished_counts_and_a_needless_unknown_costs() -> None:
    assert marked(finding("presliding", "piston", ambiguous_with=["coulomb_friction"]), BOTH[1]).names == 1.0
    assert marked(*BOTH, finding("unknown", "piston", kind="unknown")).names == pytest.approx(2 / 3)


def test_no_answer_and_a_healthy_machine() -> None:
    assert judge("seal", KNOWN, None, None, None, {}).mark == 0.0
    healthy = Known(must=(), may=(), unknown=False, published={}, source="")
    right = judge("control", healthy, {"verdict": "consistent", "effects": []}, {"p": 2.0}, {"p": 2.0}, {})
    assert right.mark == 1.0
    assert judge("control", healthy, {"verdict": "mismatch", "effects": [BOTH[0]]}, {"p": 2.0}, {"p": 2.0}, {}).mark == 0.0


def test_ratios_are_geometric_means_over_the_signals() -> None:
    assert ratio({"a": 2.0, "b": 8.0}, {"a": 1.0, "b": 1.0}) == pytest.approx(4.0)
    assert ratio(None, {"a": 1.0}) is None and ratio({"a": 1.0}, {}) is None
