"""Cases whose truth is Cantera's: one slide with its cylinder, steered by an analogue controller, and files as of whole machines."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.trials.cantera.network import Cylinder
from exo_sim.trials.whole_machines.case import WholeCase, instrumented
from exo_sim.trials.whole_machines.draw import Built, build, cells_of
from exo_sim.trials.whole_machines.friction_laws import EXPONENTIAL, SUM, TANH
from exo_sim.trials.whole_machines.gas_laws import CONSTANT, ELLIPSE, ORIFICE
from exo_sim.trials.whole_machines.hidden_effects import check_keys
from exo_sim.trials.whole_machines.machine_run import Run, Ticks, span_of, ticks
from exo_sim.trials.whole_machines.make import LABORATORY, Laws, Make

Array = NDArray[np.float64]
#: Effects that the reactors have.
BLOCKS = ("heat", "hose", "leak_piston", "leak_out", "coulomb", "viscous", "spring", "lag", "deadband", "flow")
CELLS = ("single", "whole", "nothing")
MAKE = Make(
    "cantera", True, (16.0, 20.0, 25.0, 32.0), "slide", 1000.0,
    Laws(TANH, EXPONENTIAL, (2.0, 2.0), SUM, ELLIPSE, "first", CONSTANT, ORIFICE, "node"),
    False, LABORATORY, ("sines", "triangles"), ("sines", "places"), "cylinder", "slide", (),
)  # fmt: skip
_TRIES = 8


def make_case(name: str, cell: str = "single", seed: int = 0, *, effects: Sequence[str] = (), bulk: float = 1.0,
              duration: float = 20.0) -> WholeCase:  # fmt: skip
    """Draw a case; nobody computes what each effect matters, so all are expected.

    Args:
        name: Its name.
        cell: "single" hides one effect, "whole" three to six, "nothing" none.
        seed: Chance; the same seed gives the same case.
        effects: Of `BLOCKS`, hidden instead of a draw.
        bulk: Factor on the sizes.
        duration: Length of a recording [s].

    Raises:
        TrialError: a cell or effect is unknown, Cantera is not installed, or no machine that moves was drawn.
    """
    cells_of(cell, CELLS)
    check_keys(effects, BLOCKS, "--truth cantera")
    for attempt in range(_TRIES):
        rng = np.random.default_rng([seed, attempt, 20265])
        built = build(MAKE, cell, rng, bulk=bulk, blocks=choose(cell, rng, effects))
        try:
            runs = [drive(built, MAKE.programs, duration, rng)]
            unseen = drive(built, MAKE.fresh, 0.6 * duration, rng)
        except TrialError as error:
            if "package cantera" in str(error):
                raise
            continue
        return instrumented(name, cell, seed, built, runs, unseen, False, rng)
    raise TrialError(f"--truth cantera, seed {seed}: {_TRIES} machines in a row were not moved; draw with another --seed")


def choose(cell: str, rng: np.random.Generator, only: Sequence[str] = ()) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the keys of what is hidden, and of what the owner knows of: some of the rest."""
    order = [str(key) for key in rng.permutation(BLOCKS)]
    count = {"single": 1, "whole": int(rng.integers(3, 7)), "nothing": 0}[cell]
    hidden = list(only) or order[:count]
    if not only and {"leak_piston", "leak_out"} <= set(hidden):
        hidden.remove("leak_out")
    leaks = {"leak_piston", "leak_out"}
    rest = [key for key in order if key not in hidden and rng.random() < 0.3 and not (key in leaks and leaks & set(hidden))]
    return tuple(hidden), tuple(key for key in rest if key != "leak_out" or "leak_piston" not in rest)


def drive(built: Built, names: tuple[str, ...], duration: float, rng: np.random.Generator) -> Run:
    """Run a machine of `MAKE`.

    Args:
        built: The machine.
        names: "sines", "triangles" or "places": what its piston follows, one after another.
        duration: Length [s].
        rng: Chance.

    Raises:
        TrialError: it was not moved, or lay at an end.
    """
    m = built.machine
    dt = 0.5 / MAKE.rate
    steps, sub = ticks(MAKE, dt, duration, rng)
    times = np.concatenate([[0.0], np.cumsum(steps[:-1]) * dt])
    span = span_of(built)
    middle = 0.5 * m["stroke"]
    goal = _goal(names, times, 0.33 * m["stroke"], 0.5 * built.full_speed, rng)
    # P control of a cylinder, an integrator behind an oscillator of the gas: a sixth of its natural frequency is far from ringing
    gain = min(span.natural / 6.0, 12.0) / built.full_speed
    start = middle + goal(0.0)[0]
    p2 = m["ambient"] + 0.5 * (m["supply"] - m["ambient"])
    p1 = (p2 * m["area_2"] + m["ambient"] * (m["area_1"] - m["area_2"]) + m["spring"] * (start - m["spring_rest"])) / m["area_1"]

    def steer(time: float, piston: float) -> float:
        place, speed = goal(time)
        return math.tanh(gain * (middle + place - piston) + speed / built.full_speed)

    log = Cylinder(m, steer, (start, p1, p2)).run(times)
    # an amplifier's card records the mean of what the valve was commanded until the next sample
    log["command"] = np.repeat(log["command"].reshape(-1, sub)[:, sub // 2], sub)
    x = log["piston"]
    if np.ptp(x) < 0.25 * m["stroke"] or x.min() < 0.0 or x.max() > m["stroke"]:
        raise TrialError("a drawn machine hardly moved or met its end")
    return Run(log, Ticks(steps, sub, dt), np.zeros((0, 0)))


def _goal(
    names: tuple[str, ...], times: Array, travel: float, fastest: float, rng: np.random.Generator
) -> Callable[[float], tuple[float, float]]:
    """Return a function of time to an excursion from the middle [m] and its speed [m/s], both continuous."""
    coarse = np.linspace(0.0, times[-1], round(times[-1] * 100) + 1)
    wave = np.zeros_like(coarse)
    edges = np.linspace(0, len(coarse), len(names) + 1).astype(int)
    for name, left, right in zip(names, edges[:-1], edges[1:]):
        t = coarse[left:right] - coarse[left]
        if name == "sines":
            rates = np.exp(rng.uniform(np.log(0.2), np.log(2.0), 4))
            wave[left:right] = sum(np.sin(2 * np.pi * f * t + rng.uniform(0, 6.28)) / math.sqrt(f) for f in rates)
        else:
            turns = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 2.5, 200))])
            heights = rng.uniform(0.4, 1.0, 201) * np.where(np.arange(201) % 2, 1.0, -1.0)
            known = np.searchsorted(turns, t, side="right") - 1
            wave[left:right] = np.interp(t, turns, heights) if name == "triangles" else heights[known]
        wave[left:right] /= np.abs(wave[left:right]).max()
    wave *= travel
    most = 0.9 * fastest * 0.01
    for i in range(1, len(wave)):  # no faster than the valve allows
        wave[i] = wave[i - 1] + min(max(wave[i] - wave[i - 1], -most), most)
    soft = np.hanning(15)[1:-1] / np.hanning(15)[1:-1].sum()
    wave = np.convolve(np.pad(wave, 6, mode="edge"), soft, mode="valid")
    speed = np.gradient(wave, coarse)
    pace, last = 1.0 / coarse[1], len(coarse) - 2

    def at(time: float) -> tuple[float, float]:
        i = min(max(int(time * pace), 0), last)
        share = time * pace - i
        return wave[i] + share * (wave[i + 1] - wave[i]), speed[i] + share * (speed[i + 1] - speed[i])

    return at

