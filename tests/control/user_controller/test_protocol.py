"""How often a controller is asked."""

from typing import Any

import numpy as np
import pytest

from exo_sim.control import user_controller
from exo_sim.errors import ScenarioError


class Unshowable:
    def __repr__(self) -> str:
        raise ValueError


def test_the_time_between_calls_is_whole_steps():
    class Slow:
        period: Any = 0.01

    assert user_controller.period_of(Slow(), 0.001, "Slow") == 10
    assert user_controller.period_of(object(), 0.001, "it") == 2
    for wrong in (0.0001, "10 ms", True, float("nan")):
        setattr(Slow, "period", wrong)  # noqa: B010
        with pytest.raises(ScenarioError, match="seconds between two calls"):
            user_controller.period_of(Slow(), 0.001, "Slow")


@pytest.mark.parametrize("period", [0, -1.0, float("nan"), "1 ms", None, True, 2.0, 10**400, np.float32("nan"), 1j, Unshowable()])
def test_a_period_that_is_none_is_said(period):
    with pytest.raises(ScenarioError, match="write seconds between two calls"):
        user_controller.period_of(type("Mine", (), {"period": period}), 0.001, "mine")


def test_a_period_may_be_any_number_and_may_not_fail():
    assert user_controller.period_of(type("Mine", (), {"period": np.float32(0.01)}), 0.001, "mine") == 10
    assert user_controller.period_of(type("Mine", (), {}), 0.001, "mine") == 2
    with pytest.raises(ScenarioError, match=r'ZeroDivisionError.*when it was asked for "period"'):
        user_controller.period_of(type("Mine", (), {"period": property(lambda self: 1 / 0)})(), 0.001, "mine")
