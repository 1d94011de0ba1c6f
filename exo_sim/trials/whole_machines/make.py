"""What a make of machine is: the laws that its machines follow, their build, how they are driven, and their instruments."""

from __future__ import annotations

from dataclasses import dataclass

Range = tuple[float, float]


@dataclass(frozen=True)
class Grade:
    """The instruments of a rig. One card holds the pressures, another the position and the load cell.

    Attributes:
        bits: Of the converters.
        pressure_noise: Range of white noise [Pa].
        pressure_range: Full scale [Pa].
        filter_hz: Range of the cut-off of each card's anti-alias filter [Hz].
        filter_order: Its order.
        card_delay: Range of the delay of the pressures' card against the clock [s].
        encoder: Steps of an encoder [m] to draw from; empty where the position is analogue.
        position_noise: Range of white noise of an analogue position [m].
        jitter: Standard deviation of the sample period, as a share of it.
        gauge: Whether pressures were measured against the room and made absolute with 1013.25 hPa.
        offset: Standard deviation of each pressure's own offset [Pa].
        force_scale: Standard deviation of the load cell's scale.
        filter_shape: Of the anti-alias filters, "bessel" or "butterworth".
        lost: Share of the samples that never reach the file.
    """

    bits: int
    pressure_noise: Range
    pressure_range: float
    filter_hz: Range
    filter_order: int
    card_delay: Range
    encoder: tuple[float, ...]
    position_noise: Range
    jitter: float
    gauge: bool
    offset: float
    force_scale: float
    filter_shape: str = "bessel"
    lost: float = 0.0


LABORATORY = Grade(16, (60.0, 180.0), 1.25e6, (250.0, 400.0), 2, (0.0, 1e-4), (1e-6, 5e-6), (3e-6, 1e-5), 0.0, False, 150.0, 0.005)
WORKSHOP = Grade(14, (150.0, 400.0), 1.25e6, (120.0, 300.0), 2, (0.0, 6e-4), (1e-5,), (1e-5, 4e-5), 0.01, False, 500.0, 0.01)
PLANT = Grade(12, (250.0, 700.0), 1.6e6, (60.0, 150.0), 1, (0.0, 2e-3), (), (3e-5, 8e-5), 0.04, True, 1500.0, 0.03)

#: Converters of 24 bits behind a steep filter, a magnetic encoder of 12 to 13 bits; a microcontroller of 10 bits, its line losing some.
SIGMA_DELTA = Grade(
    24, (30.0, 100.0), 1e6, (150.0, 300.0), 4, (0.0, 3e-4), (2e-5, 5e-5), (1e-5, 4e-5), 2e-3, False, 300.0, 4e-3, "butterworth"
)  # fmt: skip
CONTROLLER = Grade(10, (300.0, 900.0), 1e6, (40.0, 90.0), 1, (0.0, 1.5e-3), (), (5e-5, 1.2e-4), 0.08, True, 2500.0, 0.02, lost=0.003)


@dataclass(frozen=True)
class Laws:
    """The laws that a make's machines follow.

    Attributes:
        contact, stribeck, pressure: Of friction; see `friction_laws`.
        exponent: Range of the Stribeck exponent.
        viscous_index: Range of the exponent of speed in viscous friction.
        flow: Of the valve's paths; see `gas_laws`.
        flow_m: Range of the ellipse's subsonic index.
        crack: Range of the least difference of pressures at which anything flows [Pa].
        spool: "first" or "second" order, "delayed" and first order, "piloted": delayed and second order, or "uneven": first order, slower
            to close than to open.
        heat, leak: See `gas_laws`.
        hose: "node" or "line".
        unequal: Whether the valve's four edges were ground one by one.
        laminar: Range of the ratio of pressures above which the valve's flow is laminar; None where that is all but equal pressures.
    """

    contact: int
    stribeck: int
    exponent: Range
    pressure: int
    flow: int
    spool: str
    heat: int
    leak: int
    hose: str
    viscous_index: Range = (1.0, 1.0)
    flow_m: Range = (0.5, 0.5)
    crack: Range = (0.0, 0.0)
    unequal: bool = False
    laminar: Range | None = None


@dataclass(frozen=True)
class Make:
    """One make.

    Attributes:
        name, reported: A letter, or that of a drawn make (`drawn_makes`), and whether it may only be reported on.
        bores: Of the series of `published_cylinders.SERIES` [mm].
        build: "slide", "upright", "lever", or "legs": cylinders across hips and knees that their wearer leads.
        rate: Samples a second [Hz].
        laws: What its machines obey.
        dead_with_hose: Whether owners count their hoses among the dead volumes.
        grade: Instruments.
        programs: Of `excitation.PROGRAMS`, of `walk.gait.PACES` for legs, the recording's; `fresh` are those of the recording that nobody
            has seen.
        cylinder, joint: What owners call them; of legs the joints' names without the side.
        optional: Of `hidden_effects.BLOCKS`, what its machines may have besides what all do.
        single: Chamber 2 is open to the room.
        series: Of cylinders, of `published_cylinders.SERIES`.
        load_cell: How often the rod's force is recorded; legs draw theirs in `walk.worn`.
    """

    name: str
    reported: bool
    bores: tuple[float, ...]
    build: str
    rate: float
    laws: Laws
    dead_with_hose: bool
    grade: Grade
    programs: tuple[str, ...]
    fresh: tuple[str, ...]
    cylinder: str
    joint: str
    optional: tuple[str, ...]
    single: bool = False
    series: str = "iso"
    load_cell: float = 0.25
