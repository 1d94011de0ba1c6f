"""Which of several demands a causal controller gets."""

import math
from pathlib import Path
from typing import Any, cast

import pytest

from exo_sim import rig as rigs
from exo_sim.control.causal import Calibration
from exo_sim.control.least_load import LeastLoad
from exo_sim.simulation import demand_choice
from exo_sim.simulation.demand_choice import DEARER, DISTURBANCES, FINALISTS, FINER, LATER, Choice, finalists
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation


class Named:
    """A plan that is known by its name and how much later it is played."""

    def __init__(self, name: str, late: float = 0.0) -> None:
        self.name, self.late = name, late

    def later(self, strides: float) -> "Named":
        return Named(self.name, strides)


def test_the_plan_of_the_best_worst_case_is_taken_and_then_how_much_later_it_is_played(monkeypatch: pytest.MonkeyPatch) -> None:
    walked: list[tuple[str, float]] = []
    price = {"first": 1.2, "middle": 0.9, "last": 2.0}

    def worst(it: Choice, calibration: Any, least: float = math.inf) -> float:
        walked.append((calibration.name, calibration.late))
        return price[calibration.name] + abs(calibration.late - LATER[1] - FINER)

    monkeypatch.setattr(Choice, "worst", worst)
    plans = cast(list[LeastLoad], [Named(name) for name in price])
    best = cast(Any, Choice(cast(Simulation, None)).of(plans, lambda plan: cast(Calibration, plan)))
    assert (best.name, best.late) == ("middle", LATER[1] + FINER)
    assert walked[:3] == [(name, LATER[0]) for name in ("last", "middle", "first")]
    assert walked[3:] == [("middle", late) for late in (*LATER[1:], LATER[1] - FINER, LATER[1] + FINER)]


def test_finalists_are_the_last_that_cost_little_more_than_the_best() -> None:
    costs = [300.0, 101.0 * DEARER, *(100.0 + FINALISTS - k for k in range(FINALISTS + 1)), 100.0]
    plans = [Named(f"{cost:g}") for cost in costs]
    found = finalists(list(zip(costs, cast(list[LeastLoad], plans))))
    assert [one for one in found] == plans[-FINALISTS:]
    assert finalists([(300.0, cast(LeastLoad, plans[0])), (100.0, cast(LeastLoad, plans[-1]))]) == [plans[-1]]


def test_disturbed_walks_leave_the_simulation_as_it_was_and_the_first_too_dear_one_is_the_last(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    it = Simulation(rigs.read(repository / "assets" / "exo.toml"), Request("level_walk", cycles=4, law="causal", rehearsals=3))
    assert it.calibration is not None
    straps, cycles, stiffness = it.straps, it.cycles, []
    once = Simulation.run

    def watched(simulation: Simulation, quiet: bool = True) -> Any:
        stiffness.append(float(simulation.straps.stiffness[0, 0] / straps.stiffness[0, 0]))
        return once(simulation, quiet)

    monkeypatch.setattr(Simulation, "run", watched)
    monkeypatch.setattr(demand_choice, "STRIDES", 4)
    whole = Choice(it).worst(it.calibration)
    assert 0.5 < whole < 3.0 and stiffness == [one.stiffness for one in DISTURBANCES]
    assert it.straps is straps and it.cycles == cycles and it._asked is None
    stiffness.clear()
    assert Choice(it).worst(it.calibration, least=0.1) > 0.1 and len(stiffness) == 1
