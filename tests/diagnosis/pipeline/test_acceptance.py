"""An update of the rig is written as far as it wins."""

from __future__ import annotations

import math

import pytest

from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.pipeline.acceptance import is_worse


@pytest.mark.parametrize(
    ("after", "worse"),
    [((0.5, 0.9), False), ((1.0, 1.0), False), ((2.0, 0.4), False), ((2.0, 0.6), True), ((0.1, math.nan), True), ((1.01, 1.0), True)],
)
def test_all_signals_together_may_not_be_worse(after: tuple[float, float], worse: bool) -> None:
    runs = {name: SignalFit("Pa", 1.0, value, 0.0) for name, value in zip("ab", after, strict=True)}
    assert is_worse(runs, {}) is worse


def test_what_could_not_be_run_before_either_says_nothing() -> None:
    assert not is_worse({}, {}) and not is_worse({"a": SignalFit("Pa", math.nan, math.nan, 0.0)}, {})


def test_a_signal_that_neither_run_predicts_says_nothing() -> None:
    lost = {"slide.position": SignalFit("m", 0.031, 0.034, 1e-5), "piston.pressure_1": SignalFit("Pa", 2600.0, 60.0, 100.0)}
    assert not is_worse(lost, {"slide.position": 0.012, "piston.pressure_1": 9e4})
    assert is_worse({"slide.position": lost["slide.position"]}, {"slide.position": 0.05})
