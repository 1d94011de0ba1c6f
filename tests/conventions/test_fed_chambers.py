"""What closed chambers cannot do, and what a recording without a valve command says of its machine then."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.conventions.fed_chambers import fed_cylinders, is_fed
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

K = 1.4
TIME = np.arange(0.0, 12.0, 0.005)


def without_commands(recording: Recording) -> Recording:
    return replace(recording, columns={key: one for key, one in recording.columns.items() if "valve_command" not in key})


def fed(recording: Recording, rig: Rig) -> frozenset[str]:
    return fed_cylinders(without_commands(recording), rig, load(rig))


def test_a_machine_that_a_valve_drives_is_fed(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    recording = benches.recorded(rig, 6.0)
    assert fed(recording, rig) == {"piston"}
    assert fed_cylinders(recording, rig, load(rig)) == frozenset()  # its command is known: nothing else feeds it


def test_closed_chambers_that_are_led_are_not_fed(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    assert fed(benches.led(rig, 6.0), rig) == frozenset()


def test_without_all_pressures_or_the_position_nothing_is_said(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    recording = benches.recorded(rig, 6.0)
    for missing in ("piston.pressure_2", "slide.position"):
        less = replace(recording, columns={key: one for key, one in recording.columns.items() if key != missing})
        assert fed(less, rig) == frozenset()


@given(
    exponent=st.floats(1.0, K), ratio=st.floats(1.05, 8.0), period=st.floats(0.3, 3.0),
    leak=st.floats(0.0, 0.5), start=st.floats(1.5e5, 8e5), noise=st.floats(0.0, 0.01), seed=st.integers(0, 10),
)  # fmt: skip
def test_no_closed_chamber_is_fed_whatever_it_gives_to_its_walls_or_leaks(
    exponent: float, ratio: float, period: float, leak: float, start: float, noise: float, seed: int
) -> None:
    """p V^n is constant, n from isothermal to isentropic, and gas may be lost."""
    swing = 0.5 + 0.5 * np.sin(2.0 * np.pi * TIME / period)
    volume = np.array([1e-4 * ratio**swing, 1e-4 * ratio ** (1.0 - swing)])
    scatter = 1.0 + noise * np.random.default_rng(seed).standard_normal((2, len(TIME)))
    pressure = start * (volume[:, :1] / volume) ** exponent * np.exp(-leak * TIME) * scatter
    assert not is_fed(TIME, pressure, volume, K)


@pytest.mark.parametrize("low_first", [True, False])
def test_a_leak_past_the_piston_fills_no_cylinder(low_first: bool) -> None:
    volume = np.full((2, len(TIME)), 1e-4)
    gap = 3e5 * np.exp(-5.0 * np.mod(TIME, 2.0))  # as if one side were emptied every other second, and filled from the other
    pressure = np.array([4e5 - gap, 4e5 + gap])
    pressure = pressure if low_first else pressure[::-1]
    pressure[:, np.mod(TIME, 2.0) < 0.01] = np.nan
    assert not is_fed(TIME, pressure, volume, K)


def test_regulators_that_raise_and_lower_both_pressures_feed() -> None:
    volume = np.full((2, len(TIME)), 1e-4)
    pressure = np.array([4e5 + 2e5 * np.sin(3.0 * TIME), 4e5 - 2e5 * np.sin(3.0 * TIME)])
    assert is_fed(TIME, pressure, volume, K)


@pytest.mark.parametrize(("ratio", "walls", "period"), [(1.4, 0.065, 3.5), (1.3, 0.5, 1.24), (3.0, 0.2, 0.8), (8.0, 2.0, 5.0)])
def test_walls_feed_nothing(ratio: float, walls: float, period: float) -> None:
    """Between the two changes lies a gas whose walls take its heat: T relaxes to the room's within `walls` seconds."""
    swing = 0.5 + 0.5 * np.sin(2.0 * np.pi * TIME / period)
    volume = np.array([1e-4 * ratio**swing, 1e-4 * ratio ** (1.0 - swing)])
    warmth, pressure = np.ones(2), np.empty_like(volume)
    for i in range(len(TIME)):
        worked = (volume[:, i] / volume[:, max(i - 1, 0)]) ** -(K - 1.0)
        warmth = 1.0 + (warmth * worked - 1.0) * np.exp(-0.005 / walls)
        pressure[:, i] = 3e5 * volume[:, 0] / volume[:, i] * warmth
    assert not is_fed(TIME, pressure, volume, K)


def test_gas_that_was_expanded_warms_up_and_is_not_fed() -> None:
    """The coldest that it can be: expanded at once to four times its volume, warm again at rest."""
    volume = np.full((2, len(TIME)), 1e-4)
    volume[0, np.mod(TIME, 4.0) > 2.0] = 4e-4
    cold = np.where(np.mod(TIME, 4.0) > 2.0, 4.0 ** -(K - 1.0), 1.0)
    warm = 1.0 - (1.0 - cold) * np.exp(-3.0 * np.mod(TIME, 2.0))
    pressure = np.array([4e5 * warm * volume[0, 0] / volume[0], np.full(len(TIME), 1e5)])
    assert not is_fed(TIME, pressure, volume, K)


def test_a_vessel_that_is_filled_once_and_left_alone_is_not_fed() -> None:
    volume, noise = np.full((2, len(TIME)), 1e-4), 200.0 * np.random.default_rng(1).standard_normal(len(TIME))
    pressure = np.array([1e5 + 5e5 * (1.0 - np.exp(-3.0 * TIME)) * np.exp(-0.05 * TIME) + noise, np.full(len(TIME), 1e5)])
    assert not is_fed(TIME, pressure, volume, K)


def test_noise_feeds_nothing() -> None:
    volume, rng = np.full((2, len(TIME)), 1e-4), np.random.default_rng(2)
    assert not is_fed(TIME, np.array([6e5, 3e5])[:, None] + 500.0 * rng.standard_normal((2, len(TIME))), volume, K)
