"""The actuators' own mass on the bodies that carry them, before a search: half of a cylinder with its valve at each of its ends.

A search draws hundreds of designs, and the loads are worked out once. So what acts is the mass of the smallest cylinders that carry the
loads at the owner's geometry, those masses included; what is chosen in the end may weigh more or less, and the result says how much.
"""

from __future__ import annotations

from dataclasses import replace

from exo_sim.machine.linkage import linkages, tendon_ends
from exo_sim.machine.load import load
from exo_sim.rig import Rig
from exo_sim.sizing.design import Design, fit
from exo_sim.sizing.design_space import Space
from exo_sim.sizing.loads import Condition, JointLoads, joint_loads
from exo_sim.sizing.screening import chosen_bores

#: So often the smallest cylinders are chosen anew for the loads that they themselves make.
_ROUNDS = 2


def carried(rig: Rig, space: Space, conditions: tuple[Condition, ...], loads: tuple[JointLoads, ...]) -> Rig:
    """Return the rig whose bodies carry the smallest cylinders that suffice (`[bodies.NAME] mass`).

    Args:
        rig: The owner's machine, its bodies without actuators.
        space: What may be chosen.
        conditions: What the machine must do.
        loads: What that asks of the joints, in the same order.
    """
    heavy = rig
    for _ in range(_ROUNDS):
        bores = chosen_bores(heavy, space, loads, space.owners(heavy))
        heavy = with_masses(rig, masses_of(space, space.design(space.owners(heavy), bores)))
        loads = tuple(joint_loads(heavy, condition) for condition in conditions)
    return heavy


def masses_of(space: Space, design: Design) -> dict[str, float]:
    """Return the mass of each cylinder with its valve [kg]; one whose stroke is not to be had counts with its longest."""
    out: dict[str, float] = {}
    for kind in space.kinds:
        chosen = design.joints[kind.name]
        stroke = fit(kind, chosen).stroke or chosen.cylinder.strokes[-1]
        mass = chosen.cylinder.mass(stroke) + (chosen.valve.mass if chosen.valve is not None else 0.0)
        out |= dict.fromkeys(kind.cylinders, mass)
    return out


def with_masses(rig: Rig, masses: dict[str, float]) -> Rig:
    """Return a rig whose bodies carry half of each cylinder's mass [kg] at each of its ends."""
    model = load(rig)
    bodies = dict(rig.body_masses)
    for link in linkages(rig, model):
        ends = tendon_ends(model, rig.cylinders[link.cylinder].actuator)
        for site in ends or ():
            body = int(model.site_bodyid[site])
            name = model.body(body).name
            bodies[name] = bodies.get(name, float(model.body_mass[body])) + 0.5 * masses.get(link.cylinder, 0.0)
    return replace(rig, body_masses=bodies)
