"""Why a step was refused, or a chamber cannot be filled, in words that say what to change."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics import nodes, state
from exo_sim.physics.conditions import Reservoir
from exo_sim.physics.gas_effects_off import effects_on_gas
from exo_sim.physics.plant import NO_COMMAND, opening
from exo_sim.physics.settling import hot_gas
from exo_sim.physics.step_length import rate_of_effects, side_rate

Array = NDArray[np.float64]
Sides = tuple[float, float]


class Refusal(NamedTuple):
    """What is wrong.

    Attributes:
        cylinder: Its index.
        says: One sentence, without the cylinder's name.
    """

    cylinder: int
    says: str


def unfillable(x: Array, p_1: Array, p_2: Array, t: Array) -> Refusal | None:
    """Return why chambers cannot be filled with pistons at x [m], pressures [Pa] and temperature [K], shape (n,) each; None if they can."""
    for i in range(len(x)):
        if not np.isfinite(x[i]):
            return Refusal(i, f"its piston is at {x[i]:g} m: start it at a position that is a number")
        for what, value, unit in (("pressure_1", p_1[i], "Pa"), ("pressure_2", p_2[i], "Pa"), ("temperature", t[i], "K")):
            if not 0.0 < value < np.inf:
                return Refusal(i, f"{what} = {value:g} {unit} at the start: fill it with an absolute {what.split('_')[0]} above zero")
    return None


def why(
    code: int, world: NDArray[np.void], cylinders: NDArray[np.void], vector: Array, x0: Array, x1: Array, command: Array, dt: float
) -> Refusal:
    """Return why `plant.step` ended with a code other than `FOLLOWED`.

    Args:
        code: What it returned.
        world, cylinders: Records, shape (1,) and (n,).
        vector: The state as far as it was followed.
        x0, x1, command: Where the pistons went from and to [m], under which commands, shape (n,).
        dt: Length of the step [s].
    """
    if code >= NO_COMMAND:
        at = code - NO_COMMAND
        return Refusal(at % len(cylinders), f"its valve command is {command[at]:g}: a controller must give a number from -1 to 1")
    for record, i in [(world, 0), *((cylinders[i : i + 1], i) for i in range(len(cylinders)))]:
        if name := _no_number(record):
            return Refusal(i, f"{name} is not a number: give it one")
    rates = {
        (i, side): rate
        for i in range(len(cylinders))
        for side, rate in enumerate(_rates(world, cylinders[i : i + 1], vector, i, x1[i], _both(command, i, cylinders), dt), 1)
    }
    (i, side), rate = max(rates.items(), key=lambda item: item[1])
    before, after = nodes.volumes(cylinders[i], x0[i])[side - 1], nodes.volumes(cylinders[i], x1[i])[side - 1]
    volume = f"chamber {side}, {1e6 * min(before, after):.3g} cm^3 there,"
    if not rate * dt > 1e3:
        return Refusal(
            i, f"{volume} changes to {max(before, after) / min(before, after):.3g} times its volume in a step of {dt:g} s, "
            f"which no smaller steps follow: give it more dead volume, or take a shorter time step"
        )  # fmt: skip
    both = _both(command, i, cylinders)
    cause = min(_causes(cylinders[i]), key=lambda other: _rates(world, other[1], vector, i, x1[i], both, dt)[side - 1])[0]
    return Refusal(
        i, f"{volume} settles in {1.0 / rate:.2g} s, {rate * dt:.2g} times in a step of {dt:g} s, which no smaller steps follow: "
        f"give it more dead volume, less {cause}, or take a shorter time step"
    )  # fmt: skip


def _both(command: Array, i: int, cylinders: NDArray[np.void]) -> Sides:
    """Return the commands of one cylinder towards its chambers 1 and 2."""
    one = float(command[i])
    return one, float(command[len(cylinders) + i]) if cylinders["independent"][i] > 0.0 else -one


def _no_number(record: NDArray[np.void]) -> str:
    """Return which number of a record of shape (1,) is not finite, like "wall_heat_transfer.conductance"; "" if all are."""
    for name in record.dtype.names or ():
        if record.dtype[name].names:
            if inner := _no_number(record[name]):
                return f"{name}.{inner}"
        elif not np.isfinite(record[name]).all():
            return name
    return ""


def _causes(cylinder: np.void) -> Iterator[tuple[str, NDArray[np.void]]]:
    """Yield what may make a cylinder's gas fast, and the cylinder without it, shape (1,)."""
    for name in ("valve_area", *effects_on_gas()):
        without = np.array([cylinder])
        if np.any(without[name].view(np.float64)):
            without[name] = np.zeros(1, without[name].dtype)
            yield ("valve area" if name == "valve_area" else name), without


def _rates(world: NDArray[np.void], cylinder: NDArray[np.void], vector: Array, i: int, x: float, command: Sides, dt: float) -> list[float]:
    """Return how fast each chamber that a cylinder has can settle [1/s]."""
    c, w, base = cylinder[0], world[0], i * state.INTEGRATED
    one, two = nodes.chambers(w, c, vector, base, x, 0.0)
    supply, exhaust = Reservoir(w["supply_pressure"], w["supply_temperature"]), Reservoir(w["exhaust_pressure"], w["ambient"])
    towards_1 = opening(c, command[0])
    towards_2 = opening(c, command[1]) if c["independent"] > 0.0 else -towards_1
    a_s1, a_1e, a_s2, a_2e = nodes.path_areas(c, towards_1, towards_2)
    sides = [(one, two, a_s1, a_1e), (two, one, a_s2, a_2e)][: 1 if c["single_acting"] > 0.0 else 2]
    gas = hot_gas(w["k"], w["r"])
    found = [
        side_rate(w, c, vector, base, here, fed, let_off, supply, exhaust, dt, rate_of_effects(w, c, here, there, dt), gas)[0]
        for here, there, fed, let_off in sides
    ]
    return [rate if np.isfinite(rate) else 0.0 for rate in found]
