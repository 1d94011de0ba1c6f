"""From a rig to the records of a plant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.plant_records import CYLINDER, JOINT, WORLD
from exo_sim.physics.pneumatics import Pneumatics
from exo_sim.rig.schema import EffectSetting, Rig


def world(rig: Rig) -> NDArray[np.void]:
    """Return the record of gas, atmosphere, supply and exhaust, shape (1,)."""
    record = np.zeros(1, WORLD)
    record["k"], record["r"] = rig.heat_capacity_ratio, rig.specific_gas_constant
    record["atmosphere"], record["ambient"] = rig.environment.pressure, rig.environment.temperature
    record["supply_pressure"], record["supply_temperature"] = rig.supply.pressure, rig.supply.temperature
    record["exhaust_pressure"] = rig.environment.pressure
    if rig.recovery is not None:
        record["tank_volume"], record["tank_pressure"] = rig.recovery.volume, rig.recovery.pressure
    for effect in rig.effects:
        if effect.where in ("supply", "exhaust"):
            _switch_on(record[0], effect)
    return record


def cylinders(rig: Rig, drives: Mapping[str, str] | None = None) -> NDArray[np.void]:
    """Return one record a cylinder in the order of the rig, shape (n,).

    Args:
        rig: The machine.
        drives: Joint that each cylinder drives; what gives or plays in that joint's drive is felt by the cylinder.
    """
    records = np.zeros(len(rig.cylinders), CYLINDER)
    for record, cylinder in zip(records, rig.cylinders.values(), strict=True):
        record["area_1"], record["area_2"], record["stroke"] = cylinder.area_1, cylinder.area_2, cylinder.stroke
        record["dead_volume_1"], record["dead_volume_2"] = cylinder.dead_volume_1, cylinder.dead_volume_2
        record["single_acting"], record["valve_area"], record["arm"] = (
            float(cylinder.single_acting),
            cylinder.valve_area,
            1.0,
        )
        record["independent"] = float(cylinder.valve.independent)
        record["tank_area"] = cylinder.valve_area if rig.recovery is not None else 0.0
        for effect in rig.effects:
            if effect.where == cylinder.name:
                _switch_on(record, effect)
            elif effect.where == (drives or {}).get(cylinder.name):
                if effect.name == "transmission_compliance":
                    record["drive_stiffness"] = effect.parameters["stiffness"]
                elif effect.name == "backlash":
                    record["drive_gap"] = effect.parameters["gap"]
    return records


def joints(rig: Rig, names: Sequence[str]) -> NDArray[np.void]:
    """Return one record for each of the named joints, shape (m,)."""
    records = np.zeros(len(names), JOINT)
    for record, name in zip(records, names, strict=True):
        for effect in rig.effects:
            if effect.where == name and effect.name in (JOINT.names or ()):
                _switch_on(record, effect)
                record["turning"] = float(effect.turning)
    return records


def joints_with_effects(rig: Rig) -> tuple[str, ...]:
    """Return the names of the joints on which a declared effect acts, in the order of the rig."""
    known = {*rig.cylinders, "supply", "exhaust"}
    return tuple(dict.fromkeys(e.where for e in rig.effects if e.where not in known and "." not in e.where))


def pneumatics(
    rig: Rig, dt: float, joint_names: Sequence[str] = (), drives: Mapping[str, str] | None = None
) -> Pneumatics:
    """Return the plant of a rig, not yet filled.

    Args:
        rig: The machine.
        dt: Seconds a step.
        joint_names: Joints whose own friction, spring or drag is to be carried along.
        drives: Joint that each cylinder drives; what gives or plays in that joint's drive is felt by the cylinder.
    """
    return Pneumatics(
        world(rig), cylinders(rig, drives), joints(rig, joint_names), dt, names=tuple(rig.cylinders), source=str(rig.path)
    )


def _switch_on(record: np.void, effect: EffectSetting) -> None:
    for name, value in effect.parameters.items():
        record[effect.name][name] = value
    for name, values in effect.curves.items():
        held = record[effect.name][name]
        held[: len(values)] = values
        held[len(values) :] = values[-1]
