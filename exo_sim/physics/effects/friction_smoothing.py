"""Dry friction that builds up with speed instead of holding at rest."""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter

EFFECT = Effect(
    name="friction_smoothing",
    places=("cylinder", "joint"),
    family="friction",
    question="Does the part creep under any push, however small, instead of sticking?",
    says="Dry friction builds up with speed: the contact creeps and never sticks.",
    parameters=(
        Parameter(
            "velocity", "m/s", 1e-5, 1.0, (1e-4, 2e-2), "lubricated seals; 0.1-10 mm/s where simulators smooth Coulomb's law",
            angular_unit="rad/s",
        ),
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("viscous_friction", "presliding", "stribeck_friction"),
    experiment="push with half of the force that keeps it sliding and wait: a contact that sticks stays where it is",
    convention="all dry friction at the same part is multiplied by tanh(|v|/velocity); alone it does nothing.",
    valid=(
        "the contact answers to its speed at once, and at rest it carries nothing. Below level x step/mass the time step does not resolve "
        "the velocity: what is pushed then creeps more slowly than it should."
    ),
    signature="at reversals force turns round over a span of speed; what is pushed less than it takes to slide creeps on",
    identification=Identification(excluded=True),
)  # fmt: skip


@kernel
def present(p) -> bool:
    """Return whether dry friction is smoothed."""
    return p.velocity > 0.0


@kernel
def smoothed(p, level: float, v: float) -> float:
    """Return what is left of a level of dry friction at speed v [N or N m]."""
    return level * math.tanh(abs(v) / p.velocity) if p.velocity > 0.0 else level


@kernel
def creep(p, level: float, v: float) -> tuple[float, float]:
    """Return the smoothed force at speed v [N], signed as the speed, and its slope [N s/m]; both 0 where nothing is smoothed."""
    if p.velocity <= 0.0:
        return 0.0, 0.0
    share = math.tanh(v / p.velocity)
    return level * share, level * (1.0 - share * share) / p.velocity
