"""Where an effect on a cylinder's gas acts: in the cylinder, or in a supply or exhaust that cylinders share."""

from __future__ import annotations

from collections.abc import Sequence

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.estimation.parameters import Target
from exo_sim.physics.declaration import Effect
from exo_sim.signals import SHARED_PARTS


def place_of(effect: Effect, cylinder: str) -> tuple[str, Target]:
    """Return the part where a cylinder's gas feels an effect, and which record holds its parameters."""
    return (effect.places[0], Target.WORLD) if effect.places[0] in SHARED_PARTS else (cylinder, Target.CYLINDER)


def measured_places(runs: Sequence[CylinderRun]) -> set[str]:
    """Return the shared parts whose pressure was recorded in every run."""
    return {place for place in ("supply", "exhaust") if all(getattr(run, place) is not None for run in runs)}
