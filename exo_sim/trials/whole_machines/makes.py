"""Makes of machine, alike in what they are and different in law, build, excitation and instruments.

A to D, I and Q to S are for learning, E to H, J, O and P are only reported on; no make shares its set of laws with another. I, J and R
have one chamber: a spring or a weight brings their pistons back. K to N are worn by somebody who walks: K and L for learning, M and N
reported on.
O and P were drawn up by somebody who did not work on the diagnosis, with laws, sizes, drives and cards that no other make has.
"""

from __future__ import annotations

from dataclasses import dataclass

from exo_sim.errors import TrialError, nearest
from exo_sim.trials.whole_machines.friction_laws import (
    DIFFERENCE,
    ELASTOPLASTIC,
    EXPONENTIAL,
    LARGER,
    LIPS,
    LORENTZIAN,
    LUGRE,
    SECANT,
    SUM,
    TANH,
)
from exo_sim.trials.whole_machines.gas_laws import (
    CLEARANCE,
    CONSTANT,
    EICHELBERG,
    ELLIPSE,
    GAP,
    NOZZLE,
    ORIFICE,
    POROUS,
    SHARP,
    STIRRED,
    WETTED,
)

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
        name, reported: Letter, and whether it may only be reported on.
        bores: Of the series of `catalogue.SERIES` [mm].
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
        series: Of cylinders, of `catalogue.SERIES`.
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


_TABLE = (
    Make(
        "A", False, (16.0, 20.0, 25.0), "slide", 1000.0,
        Laws(TANH, EXPONENTIAL, (1.8, 2.0), SUM, ELLIPSE, "first", CONSTANT, ORIFICE, "node"),
        False, LABORATORY, ("multisine", "triangles", "holds", "places"), ("tracking", "steps", "places"),
        "piston", "slide", ("pressure", "asymmetry", "shift", "silencer", "tank", "null"),
    ),
    Make(
        "B", False, (32.0, 40.0, 50.0), "upright", 500.0,
        Laws(LUGRE, EXPONENTIAL, (0.9, 1.2), SUM, NOZZLE, "second", WETTED, GAP, "node", unequal=True),
        True, WORKSHOP, ("tracking", "steps", "triangles", "holds"), ("chirp", "places", "tracking"),
        "lift", "carriage", ("pressure", "asymmetry", "play", "regulator", "silencer", "spring"),
    ),
    Make(
        "C", False, (40.0, 63.0, 80.0), "slide", 200.0,
        Laws(ELASTOPLASTIC, LORENTZIAN, (1.5, 2.0), DIFFERENCE, ELLIPSE, "delayed", CONSTANT, ORIFICE, "line", flow_m=(0.53, 0.58)),
        False, PLANT, ("switched", "pulses", "holds", "switched"), ("switched", "pulses"),
        "ram", "table", ("pressure", "silencer", "regulator", "cushion", "wall"),
    ),
    Make(
        "D", False, (25.0, 32.0, 40.0), "lever", 1000.0,
        Laws(LUGRE, EXPONENTIAL, (0.5, 0.8), SUM, ELLIPSE, "first", EICHELBERG, GAP, "node", (0.9, 1.0), (0.5, 0.55), unequal=True),
        True, WORKSHOP, ("forces", "multisine", "triangles", "holds"), ("chirp", "tracking", "forces"),
        "muscle", "elbow", ("pressure", "asymmetry", "shift", "null", "tank", "mount"),
    ),
    Make(
        "E", True, (10.0, 12.0, 20.0), "upright", 2000.0,
        Laws(ELASTOPLASTIC, EXPONENTIAL, (0.6, 0.9), LARGER, NOZZLE, "second", CONSTANT, POROUS, "line"),
        False, LABORATORY, ("chirp", "triangles", "holds", "tracking"), ("multisine", "places", "steps"),
        "jack", "platform", ("pressure", "asymmetry", "shift", "null", "silencer"),
    ),
    Make(
        "F", True, (32.0, 40.0, 50.0), "lever", 400.0,
        Laws(LUGRE, LORENTZIAN, (0.9, 1.3), DIFFERENCE, ELLIPSE, "first", WETTED, POROUS, "node", flow_m=(0.55, 0.62), crack=(1e3, 4e3),
             unequal=True),
        False, WORKSHOP, ("tracking", "forces", "triangles", "pulses"), ("multisine", "places", "tracking"),
        "actuator", "arm", ("pressure", "play", "asymmetry", "tank", "silencer"),
    ),
    Make(
        "G", True, (50.0, 63.0, 80.0), "slide", 250.0,
        Laws(TANH, EXPONENTIAL, (1.3, 1.6), SUM, ELLIPSE, "delayed", EICHELBERG, GAP, "node", flow_m=(0.48, 0.52)),
        True, PLANT, ("switched", "places", "pulses", "holds"), ("switched", "places"),
        "cylinder", "gate", ("pressure", "regulator", "silencer", "cushion", "rate"),
    ),
    Make(
        "H", True, (20.0, 25.0, 32.0), "slide", 1000.0,
        Laws(LUGRE, EXPONENTIAL, (1.4, 1.8), LARGER, NOZZLE, "second", EICHELBERG, ORIFICE, "line", (0.8, 0.9)),
        True, LABORATORY, ("tracking", "places", "triangles", "tracking"), ("steps", "tracking", "places"),
        "drive", "axis", ("pressure", "asymmetry", "play", "tank", "wall", "mount"),
    ),
    Make(
        "I", False, (16.0, 25.0, 32.0), "slide", 1000.0,
        Laws(LUGRE, LORENTZIAN, (1.0, 1.4), SUM, NOZZLE, "delayed", WETTED, GAP, "node"),
        False, WORKSHOP, ("tracking", "triangles", "holds", "multisine"), ("chirp", "places", "tracking"),
        "ejector", "pin", ("pressure", "asymmetry", "shift", "null", "silencer"), single=True,
    ),
    Make(
        "J", True, (20.0, 40.0, 63.0), "upright", 500.0,
        Laws(ELASTOPLASTIC, EXPONENTIAL, (1.0, 1.4), DIFFERENCE, ELLIPSE, "second", EICHELBERG, POROUS, "node", flow_m=(0.5, 0.56)),
        True, WORKSHOP, ("triangles", "places", "holds", "tracking"), ("tracking", "places"),
        "hoist", "plate", ("pressure", "play", "tank", "silencer"), single=True,
    ),
    Make(
        "K", False, (32.0, 40.0), "legs", 1000.0,
        Laws(TANH, LORENTZIAN, (1.0, 2.0), SUM, NOZZLE, "first", CONSTANT, GAP, "node"),
        False, LABORATORY, ("stand", "walk", "stand", "fast"), ("walk", "slow"), "", "", ("pressure", "shift", "null"),
    ),
    Make(
        "L", False, (25.0, 32.0), "legs", 500.0,
        Laws(LUGRE, EXPONENTIAL, (0.7, 1.1), LARGER, ELLIPSE, "second", WETTED, ORIFICE, "node", flow_m=(0.5, 0.56), unequal=True),
        True, WORKSHOP, ("walk", "stand", "slow", "fast"), ("fast", "walk"), "", "", ("pressure", "asymmetry", "play"),
    ),
    Make(
        "M", True, (32.0, 50.0), "legs", 1000.0,
        Laws(ELASTOPLASTIC, LORENTZIAN, (0.8, 1.4), SUM, ELLIPSE, "delayed", EICHELBERG, POROUS, "line", flow_m=(0.52, 0.6)),
        False, LABORATORY, ("squats", "walk", "stand", "slow"), ("fast", "squats"), "", "", ("pressure", "shift", "wall"),
    ),
    Make(
        "N", True, (25.0, 40.0), "legs", 200.0,
        Laws(TANH, EXPONENTIAL, (0.8, 1.6), DIFFERENCE, NOZZLE, "delayed", EICHELBERG, ORIFICE, "node"),
        True, PLANT, ("walk", "fast", "stand", "squats"), ("slow", "walk"), "", "", ("pressure", "asymmetry", "null"),
    ),
    Make(
        "O", True, (38.1, 50.8, 63.5), "lever", 800.0,
        Laws(LUGRE, SECANT, (1.1, 1.6), LIPS, SHARP, "uneven", STIRRED, ORIFICE, "node", (0.7, 0.85)),
        False, SIGMA_DELTA, ("strokes", "binary", "holds", "hand"), ("hand", "strokes", "forces"),
        "pusher", "beam", ("pressure", "asymmetry", "play", "null", "tank"), series="inch", load_cell=0.8,
    ),
    Make(
        "P", True, (25.0, 40.0, 63.0), "upright", 250.0,
        Laws(ELASTOPLASTIC, EXPONENTIAL, (2.2, 3.0), DIFFERENCE, ELLIPSE, "piloted", WETTED, CLEARANCE, "line", laminar=(0.94, 0.985),
             unequal=True),
        True, CONTROLLER, ("hand", "strokes", "triangles", "binary"), ("strokes", "tracking"),
        "press", "ram_plate", ("pressure", "shift", "silencer", "regulator", "spring"), series="compact", load_cell=0.0,
    ),
    Make(
        "Q", False, (12.0, 16.0, 20.0), "upright", 2000.0,
        Laws(ELASTOPLASTIC, EXPONENTIAL, (1.0, 1.3), LARGER, ELLIPSE, "first", WETTED, GAP, "line", (0.85, 1.0), flow_m=(0.5, 0.55)),
        False, LABORATORY, ("steps", "tracking", "triangles", "chirp"), ("places", "multisine", "tracking"),
        "plunger", "stage", ("pressure", "asymmetry", "tank", "silencer"),
    ),
    Make(
        "R", False, (25.0, 32.0, 50.0), "upright", 400.0,
        Laws(TANH, LORENTZIAN, (1.2, 1.8), DIFFERENCE, NOZZLE, "second", CONSTANT, POROUS, "node"),
        True, PLANT, ("places", "forces", "holds", "steps"), ("triangles", "places", "tracking"),
        "stamp", "head", ("pressure", "shift", "regulator", "silencer"), single=True, load_cell=0.6,
    ),
    Make(
        "S", False, (32.0, 40.0, 63.0), "lever", 250.0,
        Laws(LUGRE, LORENTZIAN, (0.7, 1.0), LARGER, NOZZLE, "delayed", EICHELBERG, GAP, "line", unequal=True),
        False, WORKSHOP, ("places", "forces", "pulses", "tracking"), ("steps", "triangles", "places"),
        "swinger", "flap", ("pressure", "asymmetry", "play", "null", "mount"), load_cell=0.5,
    ),
)  # fmt: skip
MAKES = {make.name: make for make in _TABLE}
GROUPS = {
    "all": tuple(MAKES),
    "learn": tuple(name for name, make in MAKES.items() if not make.reported),
    "report": tuple(name for name, make in MAKES.items() if make.reported),
}


def find(name: str) -> Make:
    """Return a make by its letter.

    Raises:
        TrialError: there is none of this name.
    """
    if name not in MAKES:
        raise TrialError(f'no make "{name}"{nearest(name, MAKES)}')
    return MAKES[name]


def letters(words: str) -> tuple[str, ...]:
    """Return the makes of a list such as "A,B", or of a group of `GROUPS`.

    Raises:
        TrialError: there is no such make.
    """
    return GROUPS.get(words) or tuple(find(name.strip()).name for name in words.split(","))
