"""What is known of a machine, as plain numbers, so that a sensor can be held against it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import mujoco

    from exo_sim.rig import Rig


@dataclass(frozen=True)
class Facts:
    """Nominal numbers of the machine.

    Attributes:
        atmosphere: Pa.
        supply_pressure: Pa, where it is known.
        joint_range: Joint to its least and greatest coordinate, m or rad.
        vented: Pressures of chambers that are open to the atmosphere.
    """

    atmosphere: float = 101325.0
    supply_pressure: float | None = None
    joint_range: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    vented: frozenset[str] = frozenset()

    @classmethod
    def of(cls, rig: Rig, model: mujoco.MjModel) -> Facts:
        """Return what a rig and its model say; a supply counts only where a valve could let it in."""
        ranges = {
            model.joint(i).name: (float(model.jnt_range[i, 0]), float(model.jnt_range[i, 1]))
            for i in range(model.njnt)
            if model.jnt_limited[i]
        }
        supply = rig.supply.pressure if any(one.valve_area > 0.0 for one in rig.cylinders.values()) else None
        vented = frozenset(f"{name}.pressure_2" for name, one in rig.cylinders.items() if one.single_acting)
        return cls(rig.environment.pressure, supply, ranges, vented)
