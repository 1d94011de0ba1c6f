"""Makes that chance draws, one for each number: laws, build, drive and instruments in any mixture.

A diagnosis that was built on a dozen makes may know just these. Of the drawn ones there are as many as anybody has time for, and each is
met once. Those below `FIRST_REPORTED` are for learning, the others are only reported on.
"""

from __future__ import annotations

import re

import numpy as np

from exo_sim.trials.whole_machines import friction_laws as friction
from exo_sim.trials.whole_machines import gas_laws as gas
from exo_sim.trials.whole_machines.excitation import PROGRAMS
from exo_sim.trials.whole_machines.make import CONTROLLER, LABORATORY, PLANT, SIGMA_DELTA, WORKSHOP, Laws, Make, Range
from exo_sim.trials.whole_machines.published_cylinders import SERIES

#: Before the number of a drawn make.
DRAWN = "X"
FIRST_REPORTED = 500

#: What a make's machines may have besides what all do: any make's, and those with two chambers.
_OPTIONAL = ("pressure", "shift", "null", "silencer", "tank", "regulator", "play", "mount")
_OF_TWO_CHAMBERS = ("asymmetry", "cushion", "wall", "rate")


def number_of(name: str) -> int | None:
    """Return the number of a drawn make of this name; None where it is no such name."""
    match = re.fullmatch(rf"{DRAWN}(\d{{1,6}})", name)
    return int(match[1]) if match else None


def drawn_make(number: int) -> Make:
    """Return a make, always the same for the same number.

    Args:
        number: From 0.
    """
    rng = np.random.default_rng([number, 20261125])
    series = str(rng.choice(sorted(SERIES), p=[0.2, 0.2, 0.6]))
    sizes = sorted(SERIES[series])
    first = int(rng.integers(0, max(len(sizes) - 1, 1)))
    single = bool(rng.random() < 0.2)
    build = str(rng.choice(["slide", "upright", "lever"]))
    if single and build == "lever":  # what brings a piston back is a spring or a weight
        build = "upright"
    rate = float(rng.choice([200.0, 250.0, 400.0, 500.0, 800.0, 1000.0, 2000.0]))
    grades = (LABORATORY, WORKSHOP, SIGMA_DELTA) if rate >= 800.0 else (WORKSHOP, PLANT, CONTROLLER)
    names = [str(name) for name in rng.permutation(sorted(PROGRAMS))]
    optional = _OPTIONAL if single else _OPTIONAL + _OF_TWO_CHAMBERS
    return Make(
        f"{DRAWN}{number}", number >= FIRST_REPORTED, tuple(sizes[first : first + 3]), build, rate, _laws(rng), bool(rng.random() < 0.5),
        grades[int(rng.integers(len(grades)))], tuple(names[:4]), tuple(names[3:6]), "cylinder", "load",
        tuple(str(key) for key in rng.permutation(optional)[:5]), single, series, float(rng.choice([0.0, 0.3, 0.6])),
    )  # fmt: skip


def _laws(rng: np.random.Generator) -> Laws:
    def of(*laws: int) -> int:
        return int(rng.choice(laws))

    def between(low: float, high: float, wide: float) -> Range:
        begin = float(rng.uniform(low, high - wide))
        return begin, begin + wide

    return Laws(
        contact=of(friction.TANH, friction.LUGRE, friction.ELASTOPLASTIC),
        stribeck=of(friction.EXPONENTIAL, friction.LORENTZIAN, friction.SECANT),
        exponent=between(0.5, 2.5, 0.4),
        pressure=of(friction.SUM, friction.DIFFERENCE, friction.LARGER, friction.LIPS),
        flow=of(gas.ELLIPSE, gas.NOZZLE, gas.SHARP),
        spool=str(rng.choice(["first", "second", "delayed", "piloted", "uneven"])),
        heat=of(gas.CONSTANT, gas.WETTED, gas.EICHELBERG, gas.STIRRED),
        leak=of(gas.ORIFICE, gas.GAP, gas.POROUS, gas.CLEARANCE),
        hose=str(rng.choice(["node", "line"])),
        viscous_index=(1.0, 1.0) if rng.random() < 0.5 else between(0.75, 1.0, 0.15),
        flow_m=(0.5, 0.5) if rng.random() < 0.5 else between(0.48, 0.62, 0.06),
        crack=(1e3, 4e3) if rng.random() < 0.15 else (0.0, 0.0),
        unequal=bool(rng.random() < 0.4),
        laminar=(0.94, 0.985) if rng.random() < 0.15 else None,
    )  # fmt: skip
