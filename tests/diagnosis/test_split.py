"""What is kept for the proof, and what it may say against a name."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.fitted_set import Trial, sizeable
from exo_sim.diagnosis.fitting import Fit
from exo_sim.diagnosis.proof import doubtful
from exo_sim.diagnosis.quantity import Candidate, Quantity
from exo_sim.diagnosis.split import HELD_OUT_SHARE, split


@pytest.mark.parametrize("head", [False, True])
def test_a_lone_recording_keeps_one_of_its_ends(head: bool) -> None:
    time = np.linspace(3.0, 13.0, 1001)
    parts = split([("one", time)], head)
    kept = parts.held_out("one", time)
    assert kept.mean() == pytest.approx(HELD_OUT_SHARE, abs=0.002)
    assert kept[0 if head else -1] and not kept[-1 if head else 0]
    assert (kept != parts.training("one", time)).all()


@pytest.mark.parametrize("head", [False, True])
def test_of_several_whole_ones_are_kept(head: bool) -> None:
    names = [f"r{i}" for i in range(8)]
    parts = split([(name, np.linspace(0.0, 1.0, 50)) for name in names], head)
    assert set(parts.spans) == set(names[:2] if head else names[-2:])


@pytest.mark.parametrize(
    ("drop", "odds", "doubted"),
    [(0.5, 4.0, False), (0.03, 8.0, True), (-0.6, 24.0, True), (-0.6, 60.0, True), (0.02, 160.0, False), (0.14, 60.0, False)],
)
def test_a_name_stands_where_time_kept_back_or_great_odds_bear_it(drop: float, odds: float, doubted: bool) -> None:
    assert doubtful(drop, odds) is doubted


@pytest.mark.parametrize(
    ("lag", "delay", "healthy", "large"), [(0.002, 0.0, 0.0, False), (0.002, 0.002, 0.0, True), (0.002, 0.0, 0.002, True)]
)
def test_parts_of_one_thing_are_held_against_the_limit_together(lag: float, delay: float, healthy: float, large: bool) -> None:
    """A valve that is late by 3 ms is healthy, however that is shared between waiting and following."""

    def number(name: str, prior: tuple[float, float] | None = None) -> Quantity:
        return Quantity("valve_lag", "piston", name, "s", "cylinder", 1e-3, 0.0, 0.1, prior, least=0.0 if prior else 3e-3)

    asked = number("time_constant"), number("delay")
    believed = number("delay", (0.0, 1e-3))
    candidate = Candidate("valve_lag", "piston", "both", asked, ((1e-3, 1e-3),), adds_up=True)
    values = {asked[0]: lag, asked[1]: delay, believed: healthy}
    trial = Trial((candidate,), Fit((*asked, believed), values, np.zeros(4), np.zeros((4, 3))))
    assert sizeable(candidate, trial) is large
