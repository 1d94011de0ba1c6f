"""How a unit may be written: products and quotients from left to right, powers in every spelling, and one line for the rest."""

from __future__ import annotations

import pytest

from exo_sim.errors import UnitError
from exo_sim.unit_text import powers


@pytest.mark.parametrize(
    ("unit", "found"),
    [("J/(kg K)", {"J": 1, "kg": -1, "K": -1}), ("J/kg K", {"J": 1, "kg": -1, "K": 1}), ("m^3/(s Pa)", {"m": 3, "s": -1, "Pa": -1}),
     ("m**2", {"m": 2}), ("m²·s⁻¹", {"m": 2, "s": -1}), ("1/s", {"s": -1}), ("(N m)^2", {"N": 2, "m": 2}), ("%", {"%": 1}),
     ("m/m", {"m": 0}), ("Nm/rad", {"N": 1, "m": 1, "rad": -1}), ("N-m", {"N": 1, "m": 1}), ("m/s2", {"m": 1, "s": -2}),
     ("°C", {"degC": 1}), ("º/s", {"deg": 1, "s": -1})],
)  # fmt: skip
def test_each_name_has_its_power(unit: str, found: dict[str, int]) -> None:
    assert powers(unit) == found


@pytest.mark.parametrize("unit", ["", "m^", "m^99", "(m", "m)", "m//s", "2 m", "m +s", "((m^9)^9)"])
def test_what_is_no_unit_is_one_line(unit: str) -> None:
    with pytest.raises(UnitError) as caught:
        powers(unit)
    assert "\n" not in str(caught.value)
