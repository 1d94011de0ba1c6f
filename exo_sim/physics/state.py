"""Where each number of the pneumatic state stands in its one vector.

Per cylinder: what is integrated, then what is remembered; then the nodes that all cylinders share; then one bristle a joint.
"""

from __future__ import annotations

# Integrated, per cylinder: what volumes hold, walls, flows from the valve's end of a long hose to its middle and on to the chamber. The
# last eight are the books: what passed through since the start.
MASS_1, ENERGY_1, MASS_2, ENERGY_2 = 0, 1, 2, 3
HOSE_MASS_1, HOSE_ENERGY_1, HOSE_MASS_2, HOSE_ENERGY_2 = 4, 5, 6, 7
MIDDLE_MASS_1, MIDDLE_ENERGY_1, MIDDLE_MASS_2, MIDDLE_ENERGY_2 = 8, 9, 10, 11
WALL_1, WALL_2 = 12, 13
HOSE_FLOW_1, MIDDLE_FLOW_1, HOSE_FLOW_2, MIDDLE_FLOW_2 = 14, 15, 16, 17
DRAWN, EXHAUSTED, LEAKED = 18, 19, 20
DRAWN_ENTHALPY, EXHAUSTED_ENTHALPY, LEAKED_ENTHALPY = 21, 22, 23
HEAT, WORK = 24, 25
CONTENTS = 12  # the first so many, chambers before hoses before their middles, are what volumes hold: never below zero
INTEGRATED = 26

# Integrated, shared: accumulator, exhaust manifold, recovery tank, and the books of what fed and left the first two.
SUPPLY_MASS, SUPPLY_ENERGY, EXHAUST_MASS, EXHAUST_ENERGY, TANK_MASS, TANK_ENERGY = 0, 1, 2, 3, 4, 5
FED, FED_ENTHALPY, RELEASED, RELEASED_ENTHALPY = 6, 7, 8, 9
SHARED_CONTENTS = 6  # the first so many
SHARED = 10

# Remembered, per cylinder: spool, bristle of the dry friction, piston and its speed where the transmission gives; spool of the second
# valve where each chamber has its own, and of those to a recovery tank; how fast each of these spools moves where it has mass.
SPOOL, BRISTLE, PISTON, PISTON_SPEED = 0, 1, 2, 3
SPOOL_2, TANK_SPOOL_1, TANK_SPOOL_2 = 4, 5, 6
SPOOL_SPEED, SPOOL_SPEED_2, TANK_SPOOL_SPEED_1, TANK_SPOOL_SPEED_2 = 7, 8, 9, 10
REMEMBERED = 11

# Remembered, shared: flow that the regulator feels, and the flow its diaphragm holds; how fast the gas turned out to be where a step
# was too coarse for it.
FELT, HELD, FASTER = 0, 1, 2
SHARED_REMEMBERED = 3


def integrated_size(cylinders: int) -> int:
    """Return the length of the integrated part."""
    return cylinders * INTEGRATED + SHARED


def size(cylinders: int, joints: int) -> int:
    """Return the length of the whole state vector."""
    return integrated_size(cylinders) + cylinders * REMEMBERED + SHARED_REMEMBERED + joints
