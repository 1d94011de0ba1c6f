"""How fast the pressure of a volume settles, from what flows into it: bounds that keep an explicit step stable."""

from __future__ import annotations

import math
from typing import NamedTuple

from exo_sim.physics import nozzle
from exo_sim.physics.compiled import kernel
from exo_sim.physics.conditions import Chamber
from exo_sim.physics.terms import Function, within

#: Temperature that the bounds assume of the gas [K]; `step_length.py` scales them where it is warmer.
HOT = 400.0

#: Relative changes of pressure and temperature for which an undeclared flow's answer is tried: where the gas is, and where a step leads.
_TRIED = (1e-4, -1e-4, 0.02, -0.02)


class HotGas(NamedTuple):
    """What the bounds ask of the gas at `HOT`, worked out once a step: compiled, each bound would take the same roots again.

    Attributes:
        k: Ratio of specific heats.
        sound: Speed of sound [m/s].
        laminar: Gamma at the pressure ratio above which a nozzle's flow falls linearly.
    """

    k: float
    sound: float
    laminar: float


@kernel
def hot_gas(k: float, r: float) -> HotGas:
    """Return the gas of this ratio of specific heats and gas constant [J/(kg K)] at `HOT`."""
    return HotGas(k, math.sqrt(k * r * HOT), nozzle.laminar_flow_factor(k))


@kernel
def settling_rate(area: float, volume: float, gas: HotGas) -> float:
    """Return how fast a volume behind one choked path fills or empties [1/s]."""
    return gas.k * area * gas.sound / volume


@kernel
def path_rate(area: float, p_up: float, p_down: float, volume: float, span: float, gas: HotGas) -> float:
    """Return a bound on how fast a volume behind one path can settle within `span` seconds [1/s].

    B15's time constant, inverted. The flow's slope steepens towards equal pressures, so it is taken where the span may lead.
    """
    if area <= 0.0:
        return 0.0
    settling = settling_rate(area, volume, gas)
    left = 1.0 - min(p_up, p_down) / max(p_up, p_down) - settling * span - 0.02
    knee = 1.0 - nozzle.LAMINAR_RATIO
    if left <= knee:
        return settling * gas.laminar / knee
    return settling * max(0.8 / math.sqrt(left), 1.0)


@kernel
def laminar_rate(conductance: float, p: float, volume: float, k: float, r: float) -> float:
    """Return how fast a volume at pressure p settles through a path whose flow is conductance times the difference of p^2 [1/s]."""
    return 2.0 * conductance * p * k * r * HOT / volume


@kernel
def thermal_rate(conductance: float, p: float, volume: float, k: float) -> float:
    """Return how fast gas at pressure p takes the temperature of its wall [1/s]."""
    return conductance * (k - 1.0) * HOT / (p * volume)


@within
def pressed(here, change):
    """Return a chamber whose pressure has changed by a share of itself, isentropically within a few parts in a hundred."""
    return Chamber(
        here.side, here.p * (1.0 + change), here.t * (1.0 + 0.3 * change), here.volume, here.wall, here.area, here.depth, here.speed,
        here.x, here.v, here.bore_area, here.stroke,
    )  # fmt: skip


@within
def warmed(here, change):
    """Return a chamber whose temperature and pressure have changed by a share of themselves, at constant volume."""
    return Chamber(
        here.side, here.p * (1.0 + change), here.t * (1.0 + change), here.volume, here.wall, here.area, here.depth, here.speed, here.x,
        here.v, here.bore_area, here.stroke,
    )  # fmt: skip


def by_outward_flow(flow: Function) -> Function:
    """Return a bound for a flow to the surroundings that declares none: rate(p, here, there, span, world) [1/s]."""

    @within
    def rate(p, here, there, span, world):
        usual = flow(p, here, there, world)
        steepest = 0.0
        for change in _TRIED:
            answer = abs(flow(p, pressed(here, change), there, world) - usual) / (abs(change) * here.p)
            steepest = max(steepest, answer)
        return steepest * world.k * world.r * HOT / here.volume

    return rate


def by_across_flow(flow: Function) -> Function:
    """Return a bound for a flow between the chambers that declares none: rate(p, here, there, span, world) [1/s]."""

    @within
    def rate(p, here, there, span, world):
        steepest = 0.0
        for change in _TRIED:
            if here.side == 1:
                answer = flow(p, pressed(here, change), there, world) - flow(p, here, there, world)
            else:
                answer = flow(p, there, pressed(here, change), world) - flow(p, there, here, world)
            steepest = max(steepest, abs(answer) / (abs(change) * here.p))
        return steepest * world.k * world.r * HOT / here.volume * (1.0 + math.sqrt(here.volume / there.volume))

    return rate


def by_heat_flow(flow: Function) -> Function:
    """Return a bound for a heat flow that declares none: rate(p, here, world) [1/s]."""

    @within
    def rate(p, here, world):
        usual = flow(p, here, world)
        steepest = 0.0
        for change in _TRIED:
            steepest = max(steepest, abs(flow(p, warmed(here, change), world) - usual) / (abs(change) * here.t))
        return steepest * (world.k - 1.0) * HOT / (here.p * here.volume)

    return rate
