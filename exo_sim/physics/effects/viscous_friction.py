"""Resistance in proportion to speed."""

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
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("quadratic_drag", "pressure_dependent_friction", "stribeck_friction", "wall_heat_transfer"),
    experiment="constant speeds, three of them",
    valid=(
        "the film between seal and barrel is full and its viscosity stays: resistance in proportion to speed, at one "
        "temperature."
    ),
    signature="the pressure difference at constant speed grows in proportion",
    identification=Identification(prevalence=0.5, twins=Twins(damping=1)),
)


@DAMPING.of(EFFECT)
def damping(p, motion):
    """Return the resistance for each unit of speed [N s/m or N m s/rad]."""
    return p.coefficient
