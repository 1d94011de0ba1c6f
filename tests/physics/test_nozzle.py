"""Nozzle flow against closed forms, and the laws that any flow must obey."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.physics import nozzle
from exo_sim.physics.declaration import declared
from exo_sim.physics.plant_records import CYLINDER

K, R = 1.4, 287.05
pressures = st.floats(2e4, 3e6)
temperatures = st.floats(200.0, 500.0)
areas = st.floats(1e-9, 1e-4)


@pytest.mark.parametrize(
    ("k", "ratio", "factor", "speed"),
    [
        (1.2, 0.5644739301, 0.5920252524, 0.64853117),
        (1.25, 0.5549289573, 0.5885910432, 0.65806479),
        (1.289, 0.5477235016, 0.5859617596, 0.66526662),
        (1.3, 0.5457277338, 0.5852277961, 0.66726235),
        (1.33, 0.5403640176, 0.5832427980, 0.67262841),
        (1.4, 0.5282817877, 125 / 216, 0.68473146),
        (5 / 3, 0.4871392896, 0.5625, 0.72618438),
    ],
)
def test_critical_constants_follow_from_k(k: float, ratio: float, factor: float, speed: float) -> None:
    assert nozzle.critical_ratio(k) == pytest.approx(ratio, abs=6e-11)
    assert nozzle.critical_flow_factor(k) == pytest.approx(factor, abs=6e-11)
    assert nozzle.critical_flow_factor(k) * math.sqrt(k) == pytest.approx(speed, abs=6e-9)
    assert nozzle.throat_mach(nozzle.critical_ratio(k), k) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("ratio", "factor", "mach"),
    [
        (0.53, 0.5786999551, 0.9972141161),
        (0.60, 0.5720978060, 0.8863930728),
        (0.70, 0.5394765256, 0.7323954885),
        (0.80, 0.4738450458, 0.5737227478),
        (0.85, 0.4240976890, 0.4874880449),
        (0.90, 0.3571460150, 0.3909007601),
        (0.95, 0.2600041849, 0.2716904611),
        (0.98, 0.1672100088, 0.1701307343),
        (0.99, 0.1188808364, 0.1199093680),
        (0.999, 0.0377761938, 0.0378086035),
    ],
)
def test_flow_factor_and_throat_mach_number(ratio: float, factor: float, mach: float) -> None:
    assert nozzle.flow_factor(ratio, K) == pytest.approx(factor, abs=6e-11)
    assert nozzle.throat_mach(ratio, K) == pytest.approx(mach, abs=6e-11)


@pytest.mark.parametrize(
    ("pressure", "temperature", "ratio", "flow"),
    [
        (17.2e5, 293.0, 0.0, 2.030514733802e-2),
        (17.2e5, 293.15, 0.0, 2.029995176950e-2),
        (1825014.323, 293.15, 0.0, 2.153936205900e-2),
        (7e5, 293.15, 0.0, 8.261608278286e-3),
        (17.2e5, 293.0, 0.6, 2.007336426086e-2),
        (17.2e5, 293.0, 0.8, 1.662594071786e-2),
        (17.2e5, 293.0, 0.9, 1.253128744437e-2),
        (17.2e5, 293.0, 0.99, 4.171206930241e-3),
    ],
)
def test_mass_flow_through_five_square_millimetres(pressure: float, temperature: float, ratio: float, flow: float) -> None:
    assert nozzle.mass_flow(5e-6, pressure, temperature, ratio * pressure, K, R) == pytest.approx(flow, rel=2e-10)


@pytest.mark.parametrize(("r", "constant"), [(287.05, 0.040414899586), (287.058, 0.040414336422), (287.0, 0.040418419894)])
def test_choked_constant_of_air(r: float, constant: float) -> None:
    assert nozzle.critical_flow_factor(K) * math.sqrt(K / r) == pytest.approx(constant, abs=6e-13)


def test_iso_conductance_and_throat_area() -> None:
    choked = 1e-8 * 1.185 * 1e5  # C rho p of ISO 6358 at the reference temperature
    assert nozzle.mass_flow(5.020208972e-6, 1e5, 293.15, 0.0, K, R) == pytest.approx(choked, rel=1e-9)


def test_flow_law_is_smooth_at_the_critical_ratio_and_finite_at_equal_pressures() -> None:
    at, h = nozzle.critical_ratio(K), 1e-6
    assert abs(nozzle.flow_factor(at + h, K) - nozzle.flow_factor(at, K)) / h < 1e-5
    assert nozzle.flow_factor(1.0, K) == 0.0
    assert nozzle.flow_factor(1.0 - 1e-9, K) == pytest.approx(1e-9 * nozzle.flow_factor(0.999, K) / 1e-3, rel=1e-6)


@given(areas, pressures, temperatures, pressures)
def test_turning_the_path_round_turns_the_flow(area: float, p_a: float, t: float, p_b: float) -> None:
    assert nozzle.flow(area, p_a, t, p_b, t, K, R) == -nozzle.flow(area, p_b, t, p_a, t, K, R)
    assert nozzle.flow(area, p_a, t, p_a, t, K, R) == 0.0


@given(areas, pressures, temperatures, pressures, st.floats(1.0, 1.5))
def test_flow_grows_with_upstream_and_never_with_downstream(area: float, p_a: float, t: float, p_b: float, more: float) -> None:
    before = nozzle.flow(area, p_a, t, p_b, t, K, R)
    assert nozzle.flow(area, p_a * more, t, p_b, t, K, R) >= before - 1e-12 * abs(before)
    assert nozzle.flow(area, p_a, t, p_b * more, t, K, R) <= before + 1e-12 * abs(before)


@given(areas, pressures, temperatures, st.floats(0.0, 1.0), st.floats(0.1, 10.0))
def test_scale_laws(area: float, p: float, t: float, ratio: float, scale: float) -> None:
    flow = nozzle.mass_flow(area, p, t, ratio * p, K, R)
    assert nozzle.mass_flow(area * scale, p, t, ratio * p, K, R) == pytest.approx(flow * scale, rel=1e-9)
    assert nozzle.mass_flow(area, p * scale, t, ratio * p * scale, K, R) == pytest.approx(flow * scale, rel=1e-6, abs=1e-15)
    assert nozzle.mass_flow(area, p, t * scale, ratio * p, K, R) == pytest.approx(flow / math.sqrt(scale), rel=1e-9)


def test_ellipse_at_the_nozzles_ratio_is_the_nozzle_within_0_152_percent() -> None:
    from exo_sim.physics.effects import critical_ratio

    assert "critical_ratio" in declared()
    record = CYLINDER["critical_ratio"]
    import numpy as np

    p = np.zeros(1, record)[0]
    choked = nozzle.mass_flow(1e-6, 7e5, 293.15, 0.0, K, R)
    p["ratio"] = nozzle.critical_ratio(K)
    worst = max(
        abs(critical_ratio.mass_flow(p, 1e-6, 7e5, 293.15, r * 7e5, K, R) - nozzle.mass_flow(1e-6, 7e5, 293.15, r * 7e5, K, R))
        for r in np.linspace(0.5, 0.999, 2000)
    )
    assert worst / choked == pytest.approx(0.00152, abs=1e-5)
    for b, share in ((0.3, (0.9035, 0.6999, 0.5151)), (0.2, (0.8660, 0.6614, 0.4841))):
        p["ratio"] = b
        for r, expected in zip((0.6, 0.8, 0.9), share):
            assert critical_ratio.mass_flow(p, 1e-6, 7e5, 293.15, r * 7e5, K, R) / choked == pytest.approx(expected, abs=6e-5)


@pytest.mark.parametrize("k", [1.2, K, 1.667])
def test_flow_is_continuous_where_it_becomes_linear(k: float) -> None:
    """For air gamma there is a number that was computed beforehand, for other gases it is computed."""
    assert nozzle.laminar_flow_factor(k) == pytest.approx(nozzle.subsonic_flow_factor(nozzle.LAMINAR_RATIO, k), rel=1e-14)
    assert nozzle.flow_factor(nozzle.LAMINAR_RATIO, k) == pytest.approx(nozzle.flow_factor(nozzle.LAMINAR_RATIO - 1e-12, k), rel=1e-8)
