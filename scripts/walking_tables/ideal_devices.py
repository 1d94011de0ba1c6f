"""Ideal devices without mass, for one joint and direction each, on a wearer who carries 38 kg."""

from __future__ import annotations

from exo_sim.machine.metabolism import Metabolic
from exo_sim.rig import Rig
from exo_sim.simulation import ideal_devices
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request
from exo_sim.simulation.wearer_inverse_dynamics import Held
from exo_sim.simulation.wearer_load import with_payload
from exo_sim.simulation.worn import Simulation

HEADING = "Ideal devices, one joint at a time"
PAYLOAD = 38.0
TEXT = """## Ideal devices, one joint at a time

Dembia, Silder, Uchida, Hicks and Delp (2017, PLoS ONE 12:e0180320) simulated ideal devices without mass on people who walked with 38 kg,
each for one joint and direction, with muscles, the recorded motion kept. Here the same is asked of the wearer with 38 kg as a backpack and
of the estimate from joint work (`exo_sim/simulation/ideal_devices.py`): a device takes the joint's whole moment while it has the device's
direction. Watts are what it saves of the backpack's cost, with the bounds of the estimate; torque is of one leg, power of both.

"""
AFTER = """
*What the published say.* Their devices for hip flexion, knee flexion and hip abduction saved more than the one for ankle plantarflexion
(p < 0.05, seven people); most of them gave other torques than the joint's moment, to relieve muscles that cross two joints. What each
saved stands in their table 1 and is not repeated here. *What differs.* @ORDER@
An estimate from joint work cannot see what they saw: here each joint works by itself, tendons give back the same share at every joint,
and a plane has no hip abduction. So this table says where the wearer's joint work is, and not which device to build: it has the ankle
first, which muscles and their long tendon put behind hip and knee.
"""


def saved(whole: Metabolic, left: Metabolic) -> str:
    """Return what was saved [W] with its bounds, and which share of the whole."""
    value = whole.value - left.value
    return f"{value:.0f} ({whole.low - left.low:.0f} to {whole.high - left.high:.0f}) | {100 * value / whole.value:.0f} %"


def rows(pack: Held, mass: float) -> tuple[list[list[str]], list[tuple[float, str]]]:
    """Return name, saving, torque and power of each device, and the savings [W] by name, the largest first."""
    whole = ideal_devices.cost(pack.powers, pack.sole_powers, mass)
    found = ideal_devices.devices(pack, mass)
    lines = [
        [f"{one.joint} {one.direction}", saved(whole, one.cost), f"{one.torque:.0f}", f"{one.power / mass:.1f}"] for one in found
    ]
    order = sorted(((whole.value - one.cost.value, f"{one.joint} {one.direction}") for one in found), reverse=True)
    return lines, order


def section(exo: Rig) -> str:
    """Return the section with its table: the wearer whose motion is prescribed, beside the one who is a body."""
    packs = {}
    for wearer in ("prescribed", "torques"):
        walk = Simulation(exo, Request("level_walk", PAYLOAD, cycles=4, law="inverse_dynamics", wearer=wearer)).run()
        packs[wearer] = with_payload(walk, PAYLOAD)
        mass = walk.person.mass
    lines = [
        "| device | saves W, motion prescribed (bounds) | of the whole | saves W, moved by torques (bounds) | of the whole "
        "| torque, N m, most | power, W/kg, most |",
        "|---|---|---|---|---|---|---|",
    ]
    prescribed, order = rows(packs["prescribed"], mass)
    yielding, _ = rows(packs["torques"], mass)
    for one, other in zip(prescribed, yielding):
        lines.append(f"| {one[0]} | {one[1]} | {other[1]} | {one[2]} | {one[3]} |")
    summary = summarise(Simulation(exo, Request("level_walk", PAYLOAD)).run())
    gain = summary["compared_with"]["backpack"]["metabolic_w"] - summary["wearer"]["metabolic_w"]["value"]
    share = 100 * gain / summary["compared_with"]["backpack"]["metabolic_w"]
    lines.append(f"| this machine, `least_load`, with all that it weighs | {gain:.0f} | {share:.0f} % | - | - | - | - |")
    print("\n".join(lines), flush=True)
    words = f"Here the order is {', '.join(f'{name} ({watts:.0f} W)' for watts, name in order)}."
    return TEXT + "\n".join(lines) + "\n" + AFTER.replace("@ORDER@", words)
