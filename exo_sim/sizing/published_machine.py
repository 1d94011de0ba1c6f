"""A machine of the published class, sized here by the way it was sized there: from a walking person's joint moments.

The class (BLEEX): 34 kg of payload, about 75 kg carried altogether, actuators sized from clinical gait analysis of a 75 kg person.
For a pneumatic one: knee 60 N m at an arm of 50 mm, 1200 N, a bore of 40 mm at 10 bar net, rod speeds of 0.3 to 0.35 m/s. All of it
from the literature at second hand, not verified.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from exo_sim.gait import recorded_gait
from exo_sim.gait import scenario as scenarios
from exo_sim.gait.motion import phases
from exo_sim.rig import Rig
from exo_sim.rig.catalogue import CATALOGUE
from exo_sim.sizing.design_space import Space
from exo_sim.sizing.length_and_arm import length_and_arm
from exo_sim.sizing.loads import JOINTS, Condition, JointLoads, joint_loads
from exo_sim.sizing.screening import chosen_bores, screen

#: The class [kg, kg, Pa, m^2]: person it was sized from, payload, 250 psi above the atmosphere, valve.
PERSON, PAYLOAD, SUPPLY, VALVE = 75.0, 34.0, 1825014.0, 5e-6
#: Knee torque [N m], moment arm [m], net pressure [Pa], bore [m], and rod speed [m/s] that the literature leads to.
KNEE, ARM, NET, BORE, ROD_SPEED = 60.0, 0.050, 1.0e6, 0.040, (0.30, 0.35)
#: Bore [m] and pressure [Pa] of the hydraulic prototype; `report/sizing.html` shows them.
HYDRAULIC = 0.019, 6.9e6
#: What that prototype took in level walking at 0.9 m/s with 34 kg: hydraulic and electric power [W].
HYDRAULIC_POWER, ELECTRIC_POWER = 1143.0, 200.0


def power_words(summary: Mapping[str, Any]) -> list[str]:
    """Return what the published machine and the wearer spend, to be read beside the power of the gas, in lines of text.

    Args:
        summary: Of a level walk, as `exo-sim run --json` gives it.
    """
    lines = [
        f"beside it, from the literature at second hand: a hydraulic machine of this class took {HYDRAULIC_POWER:.0f} W of hydraulic and "
        f"{ELECTRIC_POWER:.0f} W of electric power, level walking at 0.9 m/s with {PAYLOAD:g} kg"
    ]
    wearer, pack = summary["wearer"].get("metabolic_w"), summary.get("compared_with", {}).get("backpack", {}).get("metabolic_w")
    if wearer is not None:
        alone = f"; {pack:.0f} W with the payload as a backpack" if pack is not None else ""
        lines.append(f"the wearer spends {wearer['value']:.0f} W ({wearer['low']:.0f} to {wearer['high']:.0f}, estimated){alone}")
    return lines


@dataclass(frozen=True)
class PublishedClass:
    """The class beside this machine.

    Attributes:
        peak: Largest recorded moment of a person of `PERSON` by kind of joint [N m].
        bores: What those moments ask for with this machine's linkage [m].
        own_peak: Largest torque of this machine's own inverse dynamics [N m].
        own_bores: What that asks for at the same supply and valve [m].
        force: Largest rod force for those moments at this machine's linkage [N].
        own_force: The same for its own loads [N].
        by_rule: Bore for `force` by the class's own rule, `NET` on the piston and the next size up [m].
        rod_speed: Largest in the cycle [m/s].
        margin: Left by the bores of the moments.
    """

    peak: dict[str, float]
    bores: dict[str, float]
    own_peak: dict[str, float]
    own_bores: dict[str, float]
    force: dict[str, float]
    own_force: dict[str, float]
    by_rule: dict[str, float]
    rod_speed: dict[str, float]
    margin: float


def published_class(rig: Rig, space: Space) -> PublishedClass:
    """Size level walking twice at the published supply: from scaled human moments, and from the machine's own loads."""
    own = joint_loads(rig, Condition("level_walk", PAYLOAD))
    unrated = tuple(replace(entry, rating=np.inf) for entry in space.catalogue.cylinders)  # the class has a supply beyond any rating
    space = replace(space, catalogue=replace(space.catalogue, cylinders=unrated))
    human = _from_gait_analysis(own)
    numbers = {**space.owners(rig), "supply": SUPPLY, **{f"{kind.name}.valve": VALVE for kind in space.kinds}}
    found = {}
    for name, loads in (("human", human), ("own", own)):
        bores = chosen_bores(rig, space, (loads,), numbers)
        found[name] = (loads, bores, screen(rig, space.kinds, (loads,), space.design(numbers, bores)))

    def peak(loads: JointLoads) -> dict[str, float]:
        return {kind.name: float(np.abs(loads.column(kind.joints[0])[2]).max()) for kind in space.kinds}

    def force(loads: JointLoads) -> dict[str, float]:
        out = {}
        for kind in space.kinds:
            angle, _, torque = loads.column(kind.joints[0])
            out[kind.name] = float(np.abs(torque / length_and_arm(kind.own, kind.across, angle)[1]).max())
        return out

    speeds = {}
    for kind in space.kinds:
        angle, speed, _ = own.column(kind.joints[0])
        speeds[kind.name] = float(np.abs(length_and_arm(kind.own, kind.across, angle)[1] * speed).max())
    return PublishedClass(
        peak=peak(human),
        bores={name: space.catalogue.cylinders[bore].bore for name, bore in found["human"][1].items()},
        own_peak=peak(own),
        own_bores={name: space.catalogue.cylinders[bore].bore for name, bore in found["own"][1].items()},
        force=force(human),
        own_force=force(own),
        by_rule={name: rule_of_the_class(value) for name, value in force(human).items()},
        rod_speed=speeds,
        margin=found["human"][2].margin,
    )


def rule_of_the_class(force: float) -> float:
    """Return the bore of the catalogue that holds a force with `NET` on its piston [m]; the largest where none does."""
    return next((entry.bore for entry in CATALOGUE if np.pi / 4 * entry.bore**2 * NET >= force), CATALOGUE[-1].bore)


def _from_gait_analysis(own: JointLoads) -> JointLoads:
    """Return the recorded moments of a walking person, scaled to `PERSON`, as loads of the machine's joints."""
    name = scenarios.find("level_walk").gait
    assert name is not None
    gait = recorded_gait.load(name)
    right = phases()
    columns = [gait.moment[j](phase) for phase in ((right + 0.5) % 1.0, right) for j in ("hip", "knee", "ankle")]
    assert len(columns) == len(JOINTS)
    return replace(own, torque=np.stack(columns, axis=1) * (PERSON / gait.mass))
