"""The actuators' own mass on the bodies that carry them, before a search.

Half of a cylinder with its valves hangs at each of its ends, a recovery tank on the body that carries the payload.

A search draws hundreds of designs, and the loads are worked out once. So what acts is the mass of the smallest cylinders that carry the
loads at the owner's geometry, those masses included; what is chosen in the end may weigh more or less, and the result says how much.
"""

from __future__ import annotations

from dataclasses import replace

from exo_sim.machine.linkage import linkages, tendon_ends
from exo_sim.machine.rig_model import load
from exo_sim.rig import Rig
from exo_sim.sizing.design import TANK_VALVES_MASS, Design, fit, tank_mass
from exo_sim.sizing.design_space import Space
from exo_sim.sizing.loads import Condition, JointLoads, joint_loads
from exo_sim.sizing.screening import chosen_bores

#: So often the smallest cylinders are chosen anew for the loads that they themselves make.
_ROUNDS = 2


def carried(rig: Rig, space: Space, conditions: tuple[Condition, ...], loads: tuple[JointLoads, ...]) -> Rig:
    """Return the rig whose bodies carry the smallest cylinders that suffice, and the tank (`[bodies.NAME] mass`).

    Args:
        rig: The owner's machine, its bodies without actuators.
        space: What may be chosen.
        conditions: What the machine must do.
        loads: What that asks of the joints, in the same order.
    """
    heavy = rig
    for _ in range(_ROUNDS):
        bores = chosen_bores(heavy, space, loads, space.owners(heavy))
        design = space.design(space.owners(heavy), bores)
        heavy = with_masses(rig, masses_of(space, design), tank_mass(design))
        loads = tuple(joint_loads(heavy, condition) for condition in conditions)
    return heavy


def masses_of(space: Space, design: Design) -> dict[str, float]:
    """Return the mass of each cylinder with its valves [kg], those to a recovery tank among them.

    One whose stroke is not to be had counts with its longest.
    """
    out: dict[str, float] = {}
    way = TANK_VALVES_MASS if design.recovery is not None else 0.0
    for kind in space.kinds:
        chosen = design.joints[kind.name]
        stroke = fit(kind, chosen).stroke or chosen.cylinder.strokes[-1]
        mass = chosen.cylinder.mass(stroke) + way + (chosen.valve.mass if chosen.valve is not None else 0.0)
        out |= dict.fromkeys(kind.cylinders, mass)
    return out


def with_masses(rig: Rig, masses: dict[str, float], tank: float = 0.0) -> Rig:
    """Return a rig whose bodies carry half of each cylinder's mass [kg] at each of its ends, and a tank's where the payload hangs."""
    model = load(rig)
    bodies = dict(rig.body_masses)

    def hang(body: int, mass: float) -> None:
        name = model.body(body).name
        bodies[name] = bodies.get(name, float(model.body_mass[body])) + mass

    if tank > 0.0:  # the payload's own body weighs what is carried, whatever a rig says
        hang(int(model.body_parentid[model.geom("payload").bodyid[0]]), tank)
    for link in linkages(rig, model):
        ends = tendon_ends(model, rig.cylinders[link.cylinder].actuator)
        for site in ends or ():
            hang(int(model.site_bodyid[site]), 0.5 * masses.get(link.cylinder, 0.0))
    return replace(rig, body_masses=bodies)
