"""A whole run of a worn machine."""

from __future__ import annotations

from exo_sim.rig import Rig
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.worn import Simulation


def simulate(rig: Rig, request: Request) -> Walk:
    return Simulation(rig, request).run()
