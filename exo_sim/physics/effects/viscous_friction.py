"""Resistance of a film that grows with speed: in proportion, or more slowly where the film grows with speed or thins with shear."""

from __future__ import annotations

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Twins
from exo_sim.physics.terms import DAMPING

EFFECT = Effect(
    name="viscous_friction",
    places=("cylinder", "joint"),
    family="friction",
    question="Does resistance grow in proportion to speed?",
    says="Viscous friction resists motion.",
    parameters=(
        Parameter(
            "coefficient", "N s/m", 0.0, 1e5, (5.0, 250.0), "10-150 N s/m for 16-50 mm bores", angular_unit="N*m*s/rad"
        ),
        Parameter(
            "index", "1", 0.4, 1.0, (0.7, 0.95),
            "estimate: 1 for a film of one height, 0.5 for one that speed draws in (inverse lubrication)", required=False,
        ),
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("quadratic_drag", "pressure_dependent_friction", "stribeck_friction", "wall_heat_transfer"),
    experiment="constant speeds, three of them",
    convention=(
        "the force is coefficient * v, and with an index coefficient * v * (v/V)^(index - 1): coefficient is then what it is at V, "
        "0.1 m/s (rad/s)."
    ),
    valid="the film between seal and barrel is full, at one temperature.",
    signature="the pressure difference at constant speed grows with it, in proportion or a little less",
    identification=Identification(
        forms=(("coefficient",), ("coefficient", "index")), prevalence=0.5, twins=Twins(damping=1),
        known={"index": (1.0, 0.15)},  # of a rig that gives none
    ),
)

#: Speed at which the coefficient stands, and that below which the film resists in proportion: a power below 1 has no slope at rest
#: [m/s or rad/s].
REFERENCE, SLOWEST = 0.1, 1e-3


@DAMPING.of(EFFECT)
def damping(p, motion):
    """Return the resistance for each unit of speed [N s/m or N m s/rad]."""
    if p.index <= 0.0 or p.index == 1.0:
        return p.coefficient
    return p.coefficient * (max(abs(motion.v), SLOWEST) / REFERENCE) ** (p.index - 1.0)
