"""Dry friction that falls once the piston moves."""

from __future__ import annotations

import math

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import ObservedMotion, Starts, Twins
from exo_sim.physics.terms import DRY_EXCESS


def _starts(seen: ObservedMotion) -> Starts:
    """Return values to begin with: a little and much above what slides, at low and middling speeds."""
    levels, speeds = ((1.4, 0.1), (2.0, 0.4)), (0.05, 0.25)
    return tuple((b * seen.base + c * seen.force, w * seen.speed, 2.0, 1.0) for b, c in levels for w in speeds)


EFFECT = Effect(
    name="stribeck_friction",
    places=("cylinder", "joint"),
    family="friction",
    question="Does it take more force to start than to keep going slowly?",
    says="Friction is higher at rest and falls as motion starts.",
    parameters=(
        Parameter(
            "breakaway",
            "N",
            0.0,
            1e5,
            (2.0, 100.0),
            "5-60 N for 16-50 mm bores: the whole force at rest",
            angular_unit="N*m",
        ),
        Parameter("velocity", "m/s", 1e-4, 10.0, (5e-3, 0.1), "5-100 mm/s", angular_unit="rad/s"),
        Parameter(
            "exponent", "1", 0.5, 4.0, (0.5, 2.0),
            "0.5-1 to 2, much more where a lubricant holds at slow speed (Armstrong-Helouvry, Dupont, Canudas de Wit 1994)",
            required=False,
        ),
        Parameter(
            "tail", "1", 0.0, 1.0, (0.0, 1.0), "0 exponential, 1 Lorentzian (Armstrong-Helouvry, Dupont, Canudas de Wit 1994)",
            required=False,
        ),
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("coulomb_friction", "viscous_friction", "presliding", "backlash"),
    experiment="slow triangles at three speeds between 1 and 100 mm/s",
    convention=(
        "breakaway is the whole force at rest, not what it has more than Coulomb's; the excess falls as "
        "exp(-(v/velocity)^exponent), with an exponent of 2 where none is given; with a tail as "
        "(1 + tail (v/velocity)^exponent)^(-1/tail), more slowly at speed: 1 is the Lorentzian 1/(1 + (v/velocity)^exponent)."
    ),
    valid="friction follows speed at once: no film that builds up, no time at rest that makes it stronger.",
    signature="the piston jumps when it starts; friction falls over the first centimetres a second",
    identification=Identification(
        forms=(("breakaway", "velocity", "exponent"), ("breakaway", "velocity", "exponent", "tail")),
        starts_by_motion=_starts,
        within_speeds=("velocity",),
        on_top_of="coulomb_friction",
        prevalence=0.3,
        known={"exponent": (2.0, 0.75), "tail": (0.0, 1.0)},  # of a rig that gives none; seals have 0.5 to 2
        twins=Twins(damping=-1),  # friction that falls with speed
    ),
)


@DRY_EXCESS.of(EFFECT)
def excess(p, level, motion):
    """Return what is added to the other dry friction at this speed; `breakaway` is the whole force at rest [N or N m]."""
    if p.breakaway <= level:
        return 0.0
    ratio = motion.v / p.velocity
    fallen = ratio * ratio if p.exponent <= 0.0 else abs(ratio) ** p.exponent
    left = math.exp(-fallen) if p.tail <= 0.0 else (1.0 + p.tail * fallen) ** (-1.0 / p.tail)
    return (p.breakaway - level) * left
