"""The curve of what has no name, in the record that a cylinder is simulated with."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.unknown_curve import with_curve
from exo_sim.physics.effects.unknown import ACTS, DEPENDS_ON, KNOTS
from exo_sim.physics.plant_records import CYLINDER, WORLD

AT, VALUES = np.array([0.0, 0.1, 0.2]), np.array([0.0, 2e-4, -1e-4])
PLANT = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))


def missing(*curves: Curve) -> Discrepancy:
    return Discrepancy("flow_2", "kg/s", "energy balance of chamber 2", curves, 1.0)


def test_its_knots_stand_in_the_record_and_the_last_value_is_held() -> None:
    record = with_curve(PLANT, missing(Curve("position", AT, VALUES, 0.1 * AT, 0.9))).cylinder["unknown"][0]
    assert (ACTS[int(record["acts"])], DEPENDS_ON[int(record["depends_on"])]) == ("flow_2", "position")
    np.testing.assert_array_equal(record["at"][:3], AT)
    np.testing.assert_array_equal(record["values"], [*VALUES, *[VALUES[-1]] * (KNOTS - 3)])
    assert (np.diff(record["at"]) > 0.0).all() and record["at"][-1] == pytest.approx(0.2, abs=1e-4)
    assert not PLANT.cylinder["unknown"]["at"].any()  # what was handed in is as it was


def test_what_no_effect_can_follow_is_left_out() -> None:
    assert with_curve(PLANT, missing()) is PLANT
    assert with_curve(PLANT, missing(Curve("time", AT, VALUES, 0.1 * AT, 0.9))) is PLANT
