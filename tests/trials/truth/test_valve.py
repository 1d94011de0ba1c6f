"""The valve of the truth: what it opens, how its spool follows, and what its regulator holds."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from exo_sim.trials.truth import valve
from exo_sim.trials.truth.state import REGULATED, SPOOL

AREA = 5e-6


def machine(**more: float) -> Any:
    plain = {
        "offset": 0.0, "deadband": 0.0, "curve_exponent": 1.0, "valve_area": AREA, "null_leak": 0.0, "exhaust_ratio": 1.0,
        "spool_frequency": 0.0, "spool_damping": 0.7, "lag": 0.0, "rate_limit": 0.0, "hysteresis": 0.0, "supply_pressure": 7e5,
        "regulator_droop": 0.0, "regulator_hysteresis": 0.0, "regulator_time": 0.0,
    }  # fmt: skip
    return SimpleNamespace(**{**plain, **more})


def plain(kernel: Any) -> Any:
    """Return a kernel as Python runs it."""
    return getattr(kernel, "py_func", kernel)


@pytest.mark.parametrize(
    ("u", "more", "areas"),
    [
        (0.5, {}, (0.5, 0.0, 0.0, 0.5)),
        (-1.5, {}, (0.0, 1.0, 1.0, 0.0)),
        (0.1, {"deadband": 0.1}, (0.0, 0.0, 0.0, 0.0)),
        (0.55, {"deadband": 0.1}, (0.5, 0.0, 0.0, 0.5)),
        (0.4, {"offset": 0.1, "exhaust_ratio": 0.8}, (0.5, 0.0, 0.0, 0.4)),
        (0.5, {"curve_exponent": 2.0, "null_leak": 0.01 * AREA}, (0.26, 0.01, 0.01, 0.26)),
    ],
)
def test_each_edge_opens_by_what_the_spool_is_off_its_overlap(u: float, more: dict[str, float], areas: tuple[float, ...]) -> None:
    assert plain(valve.valve_areas)(u, machine(**more)) == pytest.approx([AREA * share for share in areas])


def followed(more: dict[str, float], wanted: list[float], dt: float = 1e-3) -> float:
    y, bristle = np.zeros(22), np.zeros(4)
    left = 0.0
    for each in wanted:
        left = plain(valve.follow)(y, bristle, each, dt, machine(**more))
    return float(left)


@pytest.mark.parametrize(
    ("more", "found"),
    [({}, 1.0), ({"lag": 0.02}, 1.0 - math.exp(-0.5)), ({"rate_limit": 30.0}, 0.3), ({"hysteresis": 0.1}, 0.95)],
)
def test_after_ten_milliseconds_of_a_step(more: dict[str, float], found: float) -> None:
    assert followed(more, [1.0] * 10) == pytest.approx(found)


def test_play_is_seen_where_the_command_turns_back() -> None:
    assert followed({"hysteresis": 0.1}, [1.0, 0.92]) == pytest.approx(0.95)
    assert followed({"hysteresis": 0.1}, [1.0, 0.0]) == pytest.approx(0.05)


def test_a_second_order_spool_settles_on_its_command() -> None:
    assert followed({"spool_frequency": 50.0}, [1.0] * 2000, 1e-4) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(("flow", "more", "drop"), [(0.01, {"regulator_droop": 5e6}, 5e4), (0.0, {"regulator_hysteresis": 2e4}, 0.0)])
def test_a_regulator_droops_with_what_is_drawn(flow: float, more: dict[str, float], drop: float) -> None:
    y = np.zeros(22)
    y[REGULATED] = 7e5
    plain(valve.regulate)(y, np.zeros(4), flow, 1e-3, machine(**more))
    assert y[REGULATED] == pytest.approx(7e5 - drop) and y[SPOOL] == 0.0
