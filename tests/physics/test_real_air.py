"""The equation of state of air against CoolProp and printed tables."""

import pytest

from exo_sim.physics.real_air import compressibility, density, pressure


@pytest.mark.parametrize(
    ("temperature", "bar", "expected"),
    [  # CoolProp 8.0.0, fluid "Air" (the same equation in another's hands)
        (200.0, 100.0, 214.1443), (250.0, 300.0, 390.8243), (293.15, 1.0, 1.1888), (293.15, 50.0, 60.1458), (293.15, 200.0, 231.6475),
        (293.15, 300.0, 322.8474), (300.0, 500.0, 441.2632), (400.0, 300.0, 229.5288), (800.0, 700.0, 237.8637),
    ],
)  # fmt: skip
def test_density_agrees_with_coolprop(temperature, bar, expected):
    assert density(bar * 1e5, temperature) == pytest.approx(expected, rel=5e-5)


@pytest.mark.parametrize(
    ("bar", "expected"),
    [(10.0, 0.9974), (40.0, 0.9917), (100.0, 0.9930), (150.0, 1.0074), (200.0, 1.0326), (300.0, 1.1089), (400.0, 1.2073), (500.0, 1.3163)],
)
def test_compressibility_agrees_with_perrys_table_at_300_kelvin(bar, expected):
    """Perry's Chemical Engineers' Handbook, compressibility factors of air."""
    assert compressibility(bar * 1e5, 300.0) == pytest.approx(expected, abs=1e-3)


def test_density_inverts_pressure_and_thin_air_is_a_perfect_gas():
    assert pressure(density(3e7, 310.0), 310.0) == pytest.approx(3e7, rel=1e-9)
    assert density(1e3, 300.0) == pytest.approx(1e3 / (287.05 * 300.0), rel=1e-5)


@pytest.mark.parametrize(("bar", "temperature"), [(800.0, 293.15), (100.0, 100.0), (0.0, 293.15), (float("nan"), 293.15)])
def test_what_the_equation_does_not_hold_for_is_refused(bar, temperature):
    with pytest.raises(ValueError, match="equation of state"):
        density(bar * 1e5, temperature)
