"""Under what a case is recorded: what its owner knows, how it is driven, for how long, and by which sensors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

#: What an owner may have in the rig already.
ALL_KNOWN = ("wall_heat_transfer", "coulomb_friction", "viscous_friction")


@dataclass(frozen=True, kw_only=True)
class Sensors:
    """The sensors of a bench as they were bought, before any effect is planted in one.

    Attributes:
        pressure_noise, position_noise: White noise [Pa], [m].
        correlated: Correlated noise as a share of the white noise.
        bits: Converter bits.
        skew: Seconds by which the position's card lags the pressures'.
        lag: Anti-alias filter on pressures and position [s].
        drift: Of the pressure sensors over a recording [Pa].
    """

    pressure_noise: float = 250.0
    position_noise: float = 2e-5
    correlated: float = 0.0
    bits: int = 16
    skew: float = 0.0
    lag: float = 0.0
    drift: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """Under what a bench is recorded.

    Attributes:
        known: Effects that the owner has in the rig already (of `ALL_KNOWN`); None draws none or all. Those without which a hidden effect
            makes no sense are always added.
        errors: Factor on the calibration errors of a careful laboratory.
        program: One of `excitation.PROGRAMS`.
        recordings: How many recordings of the machine.
        duration, rate, jitter: Length [s], samples a second [Hz], standard deviation of the sample period [s].
        sensors: What measures.
        supply_recorded, exhaust_recorded: Whether these columns exist.
        missing: Columns left out, without unit, e.g. "piston.pressure_2".
        oddities: What healthy benches have: a trace of every effect of `cases.HEALTHY`, a spool of second order, heat transfer that grows
            with pressure, correlated noise.
    """

    known: Sequence[str] | None = None
    errors: float = 1.0
    program: str = "mixed"
    recordings: int = 1
    duration: float = 24.0
    rate: float = 1000.0
    jitter: float = 0.0
    sensors: Sensors = field(default_factory=Sensors)
    supply_recorded: bool = True
    exhaust_recorded: bool = False
    missing: Sequence[str] = ()
    oddities: bool = False


@dataclass(frozen=True, kw_only=True)
class LegConditions:
    """Under what a walking leg is recorded.

    Attributes:
        known, errors, duration, rate, supply_recorded: As in `Conditions`.
        pressure_noise, angle_noise, force_noise: White noise [Pa], [rad], [N].
        load_cell: Whether rod forces are recorded; None: where a hidden effect needs them, else by chance.
    """

    known: Sequence[str] | None = None
    errors: float = 1.0
    duration: float = 24.0
    rate: float = 1000.0
    pressure_noise: float = 500.0
    angle_noise: float = 2e-4
    force_noise: float = 0.5
    load_cell: bool | None = None
    supply_recorded: bool = True
