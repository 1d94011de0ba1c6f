"""Parameters of a plant: where a value is written, and how a fit counts it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target, card_delays
from exo_sim.physics.declaration import declared
from exo_sim.physics.plant_records import CYLINDER, WORLD


def plant() -> PlantParameters:
    cylinder = np.zeros(1, CYLINDER)
    cylinder["valve_area"] = 2e-6
    return PlantParameters(np.zeros(1, WORLD), cylinder, {"pressure_1.bias": 5.0})


def parameter(effect: str, name: str, target: Target, **more: float) -> FreeParameter:
    return FreeParameter(effect, "piston", name, "1", target, 1.0, -1e9, 1e9, **more)  # type: ignore[arg-type]


def test_each_target_is_written_where_it_belongs_and_nowhere_else() -> None:
    before = plant()
    after = before.with_values(
        [
            (parameter("supply_droop", "volume", Target.WORLD), 1e-3),
            (parameter("coulomb_friction", "force", Target.CYLINDER), 7.0),
            (parameter("flow_capacity", "valve_area", Target.FACTOR), 1.5),
            (parameter("sensor_bias", "pressure_2.bias", Target.SENSOR), 300.0),
        ]
    )
    assert after.world["supply_droop"]["volume"][0] == 1e-3
    assert after.cylinder["coulomb_friction"]["force"][0] == 7.0
    assert after.cylinder["valve_area"][0] == pytest.approx(3e-6)
    assert after.sensors == {"pressure_1.bias": 5.0, "pressure_2.bias": 300.0}
    assert before.cylinder["valve_area"][0] == 2e-6 and before.sensors == {"pressure_1.bias": 5.0}


def test_an_effect_is_on_where_a_number_of_it_is_not_zero() -> None:
    friction = declared()["coulomb_friction"]
    one = plant()
    assert not one.is_on(friction)
    assert one.with_values([(parameter("coulomb_friction", "force", Target.CYLINDER), 1.0)]).is_on(friction)


def test_two_parameters_of_one_number_share_a_slot() -> None:
    zero = parameter("sensor_zero", "pressure_1.bias", Target.SENSOR)
    bias = parameter("sensor_bias", "pressure_1.bias", Target.SENSOR)
    assert zero.slot == bias.slot and zero.key != bias.key
    assert parameter("a", "force", Target.CYLINDER).slot != parameter("b", "force", Target.CYLINDER).slot


@given(value=st.floats(1e-5, 1e5), logarithmic=st.booleans(), scale=st.floats(1e-3, 1e3))
def test_a_value_comes_back_from_its_coordinate(value: float, logarithmic: bool, scale: float) -> None:
    one = FreeParameter("effect", "piston", "p", "1", Target.SENSOR, scale, 0.0, 1e9, logarithmic=logarithmic)
    assert one.value(one.coordinate(value)) == pytest.approx(value, rel=1e-9)
    at = one.coordinate(value)
    step = 1e-5 if logarithmic else 1e-3 * at
    assert (one.value(at + step) - one.value(at - step)) / (2.0 * step) == pytest.approx(one.slope(value), rel=1e-4)


def test_a_fit_starts_at_the_prior_or_neutral() -> None:
    assert parameter("a", "p", Target.SENSOR, neutral=0.528).start == 0.528
    assert FreeParameter("a", "piston", "p", "1", Target.FACTOR, 1.0, 0.0, 2.0, (1.0, 0.1)).start == 1.0


@pytest.mark.parametrize(
    ("position", "card", "expected"), [(2e-3, 0.0, (2e-3, 0.0)), (-3e-3, 0.0, (0.0, 3e-3)), (-1e-3, 5e-3, (0.0, 6e-3))]
)
def test_a_position_that_seems_early_has_late_pressures_beside_it(
    position: float, card: float, expected: tuple[float, float]
) -> None:
    assert card_delays({"position.delay": position, "pressures.delay": card}) == pytest.approx(expected)
