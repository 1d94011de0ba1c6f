"""A regulator whose pressure falls with flow, late and with hysteresis."""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability, Twins

EFFECT = Effect(
    name="supply_regulator",
    places=("supply",),
    family="supply",
    question="Is the supply lower the more gas flows, with no memory of how much was used?",
    says="The regulator lets the supply pressure droop with flow.",
    parameters=(
        Parameter("droop", "Pa s/kg", 0.0, 1e10, (1e6, 2e8), "ISO 6953 flow characteristics, 0.1-1 bar at 1-10 g/s"),
        Parameter("time_constant", "s", 0.0, 0.3, (0.02, 0.2), "first order, 20-200 ms", required=False),
        Parameter("hysteresis", "Pa", 0.0, 1e6, (5e3, 2e4), "ISO 6953, 0.05-0.2 bar", required=False),
    ),
    cut="gas",
    reveals=("supply.pressure", "pressure_1", "pressure_2"),
    mistaken_for=("supply_droop", "critical_ratio"),
    experiment="record the supply pressure under two constant flows",
    convention="hysteresis is the whole width in pressure; with supply_droop the regulator feeds the accumulator.",
    valid=(
        "droop goes with flow in a straight line. Back-flow raises the pressure above its set point (no relief), and the "
        "inlet's pressure has no influence."
    ),
    signature="supply falls at once with flow and returns at once",
    identification=Identification(
        jerky=True,
        forms=(("droop", "time_constant"), ("droop", "time_constant", "hysteresis")),
        # the diaphragm may stick before the lag or behind it: peaks of flow that a lag has cut off first need less of it
        open_by={"droop": (1.0, 1.04), "time_constant": (0.9, 1.1), "hysteresis": (0.9, 1.8)},
        applicability=Applicability(commanded=True),
        # a tank whose gas keeps its temperature is a regulator with lag; only hysteresis is a regulator's own
        twins=Twins(unmeasured=("supply_droop",), measured=("supply_droop",), unless="hysteresis"),
    ),
)


@kernel
def follow(p, flow_felt: float, flow: float, h: float, resolved: float) -> float:
    """Return the flow that the regulator answers after `h` seconds [kg/s]: first order behind the drawn flow.

    `resolved` is the shortest time constant that the step resolves [s]: a faster regulator would hunt with the step.
    """
    lag = max(p.time_constant, resolved)
    if lag <= 0.0:
        return flow
    return flow + (flow_felt - flow) * math.exp(-h / lag)


@kernel
def stick(p, held: float, flow_felt: float) -> float:
    """Return the flow that the diaphragm has moved to: a play as wide as the hysteresis [kg/s]."""
    if p.droop <= 0.0:
        return flow_felt
    half = 0.5 * p.hysteresis / p.droop
    return min(max(held, flow_felt - half), flow_felt + half)


@kernel
def pressure(p, p_set: float, held: float) -> float:
    """Return the regulated pressure [Pa]."""
    return p_set - p.droop * held
