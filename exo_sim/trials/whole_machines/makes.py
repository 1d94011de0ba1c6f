"""Makes of machine, alike in what they are and different in law, build, excitation and instruments.

A to D, I and Q to S are for learning, E to H, J, O and P are only reported on; no make shares its set of laws with another. I, J and R
have one chamber: a spring or a weight brings their pistons back. K to N are worn by somebody who walks: K and L for learning, M and N
reported on.
O and P were drawn up by somebody who did not work on the diagnosis, with laws, sizes, drives and cards that no other make has.
Beside these there is one for each number, X0 and on: see `drawn_makes`.
"""

from __future__ import annotations

from exo_sim.errors import TrialError, nearest
from exo_sim.trials.whole_machines.drawn_makes import DRAWN, drawn_make, number_of
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
from exo_sim.trials.whole_machines.make import CONTROLLER, LABORATORY, PLANT, SIGMA_DELTA, WORKSHOP, Laws, Make

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
    """Return a make by its letter, or by X and its number where it is drawn.

    Raises:
        TrialError: there is none of this name.
    """
    if (number := number_of(name)) is not None:
        return drawn_make(number)
    if name not in MAKES:
        raise TrialError(f'no make "{name}"{nearest(name, MAKES)}')
    return MAKES[name]


def letters(words: str) -> tuple[str, ...]:
    """Return the makes of a list such as "A,B" or "X1-X20", or of a group of `GROUPS`.

    Raises:
        TrialError: there is no such make.
    """
    return GROUPS.get(words) or tuple(find(name).name for part in words.split(",") for name in _span(part.strip()))


def _span(words: str) -> tuple[str, ...]:
    """Return the names of drawn makes from one to another, such as X3-X5; what is none of these by itself.

    Raises:
        TrialError: the second comes before the first.
    """
    first, _, last = words.partition("-")
    begin, end = number_of(first), number_of(last)
    if begin is None or end is None:
        return (words,)
    if end < begin:
        raise TrialError(f'no make from "{first}" to "{last}"; did you mean "{last}-{first}"?')
    return tuple(f"{DRAWN}{number}" for number in range(begin, end + 1))
