"""Effects of a supply or exhaust that cylinders share act there, all others in the cylinder."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.estimation.parameters import Target
from exo_sim.diagnosis.subsystems.gas.place import measured_places, place_of
from exo_sim.physics.declaration import declared

LEVEL = np.full(20, 3e5)


@pytest.mark.parametrize(
    ("effect", "place"),
    [("supply_droop", ("supply", Target.WORLD)), ("exhaust_back_pressure", ("exhaust", Target.WORLD)),
     ("piston_leakage", ("piston", Target.CYLINDER))],
)  # fmt: skip
def test_where_a_cylinders_gas_feels_it(effect: str, place: tuple[str, Target]) -> None:
    assert place_of(declared()[effect], "piston") == place


def test_a_shared_pressure_counts_as_measured_only_where_every_run_has_it() -> None:
    both, one = run_of(LEVEL, LEVEL, supply=LEVEL, exhaust=LEVEL), run_of(LEVEL, LEVEL, supply=LEVEL)
    assert measured_places([both]) == {"supply", "exhaust"}
    assert measured_places([both, one]) == {"supply"} and measured_places([run_of(LEVEL)]) == set()
