"""A place where effects add up: totals, what comes in turn, and bounds that an effect declares or that are estimated."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numba
import numpy as np

from exo_sim.physics.terms import Term

RECORD = np.zeros(1, [("one", [("size", float)]), ("two", [("size", float)])])
RECORD["one"]["size"], RECORD["two"]["size"] = 3.0, 4.0


def effect(name: str, *places: str) -> SimpleNamespace:
    return SimpleNamespace(name=name, places=places)


def term() -> Term:
    made = Term("place", of_gas=True)
    made.of(effect("two", "cylinder", "joint"))(lambda p, x: p.size * x)  # type: ignore[arg-type]
    made.of(effect("one", "cylinder"))(lambda p, x: p.size + x)  # type: ignore[arg-type]
    return made


def test_all_effects_of_a_place_add_up_and_nothing_is_zero() -> None:
    made = term()
    assert made.effects() == {"one", "two"}
    assert made.total("cylinder")(RECORD[0], 2.0) == 3.0 + 2.0 + 4.0 * 2.0
    assert made.total("joint")(RECORD[0], 2.0) == 8.0
    assert made.total("supply")(RECORD[0], 2.0) == 0.0


def test_in_turn_each_sees_what_it_has_become() -> None:
    made = Term("place", of_gas=False)
    made.of(effect("one", "cylinder"))(lambda p, level, x: p.size * level)  # type: ignore[arg-type]
    made.of(effect("two", "cylinder"))(lambda p, level, x: level + x)  # type: ignore[arg-type]
    raised = made.in_turn("cylinder")
    assert raised(RECORD[0], 10.0, 1.0) == (10.0 + 30.0) + (40.0 + 1.0)
    assert made.in_turn("joint")(RECORD[0], 10.0, 1.0) == 10.0


def test_a_declared_bound_goes_before_an_estimated_one() -> None:
    made = term()
    made.settling(effect("one", "cylinder"))(lambda p, x: 100.0)  # type: ignore[arg-type]

    def estimate(function: Any) -> Any:
        return numba.njit(lambda p, x: 7.0)

    assert made.fastest("cylinder", estimate)(RECORD[0], 2.0) == 107.0
