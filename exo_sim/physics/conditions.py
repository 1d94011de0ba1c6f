"""What an effect gets to know of the gas and of the part that it acts on."""

from __future__ import annotations

from typing import NamedTuple


class Reservoir(NamedTuple):
    """Gas at rest upstream or downstream of the valves.

    Attributes:
        p: Pressure, absolute [Pa].
        t: Temperature [K].
    """

    p: float
    t: float


class Chamber(NamedTuple):
    """One chamber of a cylinder; chamber 2 of a single-acting one is the atmosphere.

    Attributes:
        side: 1 or 2.
        p: Pressure, absolute [Pa].
        t: Temperature of the gas [K].
        volume: [m^3].
        wall: Temperature of the wall [K].
        area: Of the piston on this side [m^2].
        depth: From the piston to this chamber's end of the stroke [m].
        speed: With which the depth grows [m/s].
        x, v: Position and speed of the piston, + outwards [m], [m/s]; from the end of the stroke where the rod is fully in.
        bore_area: Of the barrel's cross-section [m^2].
        stroke: [m].
    """

    side: int
    p: float
    t: float
    volume: float
    wall: float
    area: float
    depth: float
    speed: float
    x: float
    v: float
    bore_area: float
    stroke: float


class Motion(NamedTuple):
    """A piston or a joint in motion.

    Attributes:
        x, v: Position and speed [m, rad], [m/s, rad/s]; a piston's positive outwards and from the end of the stroke where the rod is
            fully in, a joint's as MuJoCo has them.
        bristle: How far the dry contact is bent [m, rad], in the direction that the part moves or is pushed in; of what dry friction
            depends on, its sign alone.
        gauge_1, gauge_2: Chamber pressures above the atmosphere [Pa]; 0 at a joint.
    """

    x: float
    v: float
    bristle: float
    gauge_1: float
    gauge_2: float
