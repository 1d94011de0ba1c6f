"""What is known of a machine, as plain numbers, so that a sensor can be held against it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Facts:
    """Believed numbers of the machine.

    Attributes:
        atmosphere: Pa.
        supply_pressure: Pa, where it is known.
        joint_range: Joint to its least and greatest coordinate, m or rad.
    """

    atmosphere: float = 101325.0
    supply_pressure: float | None = None
    joint_range: Mapping[str, tuple[float, float]] = field(default_factory=dict)
