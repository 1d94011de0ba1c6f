"""A contact that gives before it slides (LuGre)."""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter

EFFECT = Effect(
    name="presliding",
    places=("cylinder", "joint"),
    family="friction",
    question="Does a stuck piston move elastically before it breaks away?",
    says="The stuck contact is elastic before it slides (LuGre).",
    parameters=(
        Parameter(
            "stiffness",
            "N/m",
            1.0,
            1e9,
            (1e4, 1e6),
            "breakaway over 0.05-0.3 mm; Canudas de Wit et al. (1995)",
            angular_unit="N*m/rad",
        ),
        Parameter(
            "damping",
            "N s/m",
            0.0,
            1e6,
            (0.0, 1e3),
            "0.2-1 sqrt(stiffness x mass)",
            angular_unit="N*m*s/rad",
            required=False,
        ),
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("transmission_compliance", "stribeck_friction", "backlash"),
    experiment="small force cycles below breakaway, position measured at the piston: presliding saturates, compliance does not",
    convention=(
        "LuGre with the levels of Coulomb, asymmetric, pressure-dependent and Stribeck friction at the same "
        "part; alone it does nothing. A contact stiffer than the time step resolves is softened to what it "
        "does. Damping fades as exp(-(v/v_d)^2), v_d = 0.02 m/s or 0.2 rad/s: what slides is not damped, and the contact stays "
        "passive (Astrom and Canudas de Wit 2008)."
    ),
    valid="travel before breakaway is short against the stroke and carries no memory of turning points but the last.",
    signature="reversals turn round over 0.05-0.3 mm instead of at once",
    identification=Identification(
        forms=(("stiffness",),),
        starts=((1e5,), (2e4,)),
        scale=5e4,
        every_contact="stiffness",
        open_by={"stiffness": (0.82, 1.0)},  # damping of the bristles, which no fit tells from it, adds to it
    ),
)

#: Speeds about which the damping of the contact fades: of a piston [m/s], of a joint [rad/s].
FADING, FADING_ANGLE = 0.02, 0.2


@kernel
def damping(p, v: float, turning: float) -> float:
    """Return the damping of the contact at speed v [N s/m or N m s/rad]."""
    if p.damping <= 0.0:
        return 0.0
    fading = FADING_ANGLE if turning > 0.0 else FADING
    return p.damping * math.exp(-((v / fading) ** 2))


@kernel
def bristle(stiffness: float, z: float, v: float, level: float, h: float) -> float:
    """Return the bristle's deflection after `h` seconds at constant speed [m]: LuGre's dz/dt = v - s0 |v| z/g, exactly."""
    if level <= 0.0:
        return 0.0
    fade = math.exp(-stiffness * abs(v) * h / level)
    settled = level / stiffness if v > 0.0 else -level / stiffness
    return settled + (z - settled) * fade if v != 0.0 else z
