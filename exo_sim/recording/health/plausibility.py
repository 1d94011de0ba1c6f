"""Readings that cannot be what their column says: gauge for absolute, a wrong unit, beyond what the machine can do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.health.facts import Facts
from exo_sim.recording.noise import Noise
from exo_sim.recording.table import Recording
from exo_sim.signals import VALVE_COMMANDS

#: Absolute pressures below this share of the atmosphere do not occur in a machine that vents into it.
NEAR_VACUUM = 0.25


def check(recording: Recording, key: str, noise: Noise, facts: Facts) -> list[Finding]:
    """Look whether one column can be what it says."""
    values = recording[key]
    values = values[np.isfinite(values)]
    if not len(values):
        return []
    part, signal = key.rsplit(".", 1)
    unit = recording.units.get(key, "")
    if unit == "Pa":
        return _pressure(key, values, noise, facts)
    if unit == "K":
        return _temperature(key, values)
    if signal in VALVE_COMMANDS:
        return _command(key, values, noise)
    if signal == "position":
        strides = any(other.endswith(".ground_force_z") for other in recording.columns)
        return _position(key, values, unit, facts.joint_range.get(part), strides)
    return []


def _fault(key: str, kind: str, says: str) -> list[Finding]:
    return [Finding(key, kind, says, severity="fault", use="set aside")]


def _pressure(key: str, values: NDArray[np.float64], noise: Noise, facts: Facts) -> list[Finding]:
    low, high = float(np.quantile(values, 0.01)), float(values.max())
    if np.ptp(values) == 0.0 and high == 0.0:
        return []  # reported as a dead sensor
    if 0.2 < high < 5e3 and low > -1e3:
        unit = "bar" if high < 30.0 else "kPa or psi"
        return _fault(key, "unit", f'"{key}" is {high:.4g} Pa at most: next to a vacuum; is the column in {unit}?')
    if low > 2e7:
        return _fault(key, "unit", f'"{key}" is never below {low:.4g} Pa: no pneumatic pressure; is the unit right?')
    slack = 5.0 * noise.std + 0.005 * (high - low)
    if low < -slack:
        says = (
            f'"{key}" falls to {low:.5g} Pa, which an absolute pressure cannot; '
            f"is it a gauge sensor (add {facts.atmosphere:.6g} Pa)?"
        )
        return _fault(key, "gauge", says)
    resting = float(np.mean(np.abs(values) < max(slack, 0.03 * facts.atmosphere)))
    if low < NEAR_VACUUM * facts.atmosphere and (resting > 0.02 or low < 0.05 * facts.atmosphere):
        says = (
            f'"{key}" rests near {low:.5g} Pa, a vacuum, where a vented chamber shows the atmosphere; '
            f"is it a gauge sensor (add {facts.atmosphere:.6g} Pa)?"
        )
        return _fault(key, "gauge", says)
    high = float(np.quantile(values, 0.995))
    if facts.supply_pressure and high > 2.5 * facts.supply_pressure and not key.startswith(("supply.", "exhaust.")):
        says = (
            f'"{key}" reaches {high:.5g} Pa, {high / facts.supply_pressure:.2g} times the supply; is its scale right?'
        )
        return [Finding(key, "range", says, severity="warning")]
    return []


def _temperature(key: str, values: NDArray[np.float64]) -> list[Finding]:
    low, high = float(values.min()), float(values.max())
    if low > -60.0 and high < 130.0:
        return _fault(key, "unit", f'"{key}" lies between {low:.4g} and {high:.4g} K; is the column in degC?')
    if low < 60.0 or high > 1500.0:
        says = f'"{key}" lies between {low:.4g} and {high:.4g} K, which no air here can; is the sensor connected?'
        return _fault(key, "range", says)
    return []


def _command(key: str, values: NDArray[np.float64], noise: Noise) -> list[Finding]:
    most = float(np.abs(values).max())
    if most <= 1.0 + max(1e-6, 6.0 * noise.std):
        return []
    outside = float(np.mean(np.abs(values) > 1.0 + 1e-6))
    if most <= 1.2:
        says = (
            f'"{key}" leaves -1..1 in {100 * outside:.2g} % of the rows, up to {most:.4g}; taken as full command there'
        )
        return [Finding(key, "range", says, severity="warning")]
    guess = "volts" if most <= 12.0 else "percent" if most <= 100.5 else "counts"
    return _fault(key, "unit", f'"{key}" reaches {most:.4g}, where a command lies between -1 and 1; is it in {guess}?')


def _position(
    key: str, values: NDArray[np.float64], unit: str, limits: tuple[float, float] | None, strides: bool
) -> list[Finding]:
    low, high = float(values.min()), float(values.max())
    if limits is not None and limits[1] > limits[0]:
        reach = limits[1] - limits[0]
        if high - low > 5.0 * reach:
            guess = "mm" if unit == "m" else "degrees"
            says = f'"{key}" moves over {high - low:.4g} {unit}, the joint over {reach:.4g}; is the column in {guess}?'
            return _fault(key, "unit", says)
        beyond = max(low - limits[1], limits[0] - high)
        if beyond > 0.0 and unit == "m":
            reach_of_joint = f"the joint's {limits[0]:.4g} to {limits[1]:.4g}"
            says = f'"{key}" lies between {low:.4g} and {high:.4g} m, outside {reach_of_joint}; where is its zero?'
            return [Finding(key, "range", says, severity="warning")]
        return []
    walked = strides and abs(values[-1] - values[0]) > 0.9 * (high - low)  # over the ground, one way
    if unit == "m" and high - low > 10.0 and not walked:
        return _fault(key, "unit", f'"{key}" moves over {high - low:.4g} m; is the column in mm?')
    if unit == "rad" and high - low > 30.0:
        return _fault(key, "unit", f'"{key}" turns over {high - low:.4g} rad; is the column in degrees?')
    return []
