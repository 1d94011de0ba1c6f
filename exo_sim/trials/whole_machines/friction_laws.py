"""Laws of seal friction: a level over speed, pressures, place, dwell and warmth, and how a contact comes to it.

The level falls from breakaway after an exponential or a Lorentzian with an exponent of its own (Armstrong-Helouvry, Dupont and Canudas
de Wit 1994), or after a hyperbolic secant, flat at rest and exponential in its tail. Pressure presses the lips that it reaches: both
chambers' alike, their difference, the larger, or each the piston's lip on its side and the second the rod's as well. The level is
reached through tanh of the speed, through a bristle (LuGre; Canudas de Wit and others 1995), or through a bristle that is elastic up to
a limit (elasto-plastic; Dupont and others 2002).
"""

from __future__ import annotations

import math

from exo_sim.trials.whole_machines.compiled import kernel

TANH, LUGRE, ELASTOPLASTIC = 0, 1, 2
EXPONENTIAL, LORENTZIAN, SECANT = 0, 1, 2
SUM, DIFFERENCE, LARGER, LIPS = 0, 1, 2, 3


@kernel
def level(v, x, p1, p2, rest, warmth, p):
    """Return the dry friction [N] that a slide at this speed meets.

    Args:
        v, x: Speed [m/s] and place [m] of the piston.
        p1, p2: Chamber pressures, absolute [Pa].
        rest: Seconds at rest, forgotten over a tenth of a millimetre.
        warmth: Warmth of the seal, 0 cold.
        p: The machine.
    """
    gauge_1, gauge_2 = max(p1 - p.ambient, 0.0), max(p2 - p.ambient, 0.0)
    if p.pressure_law == SUM:
        felt = gauge_1 + gauge_2
    elif p.pressure_law == DIFFERENCE:
        felt = abs(p1 - p2)
    elif p.pressure_law == LIPS:
        # the rod's lip is shorter than the piston's as the rod is thinner
        felt = gauge_1 + (1.0 + math.sqrt(max(1.0 - p.area_2 / p.area_1, 0.0))) * gauge_2
    else:
        felt = max(gauge_1, gauge_2)
    sliding = p.coulomb + p.pressure_friction * felt
    sliding *= 1.0 + (p.asymmetry if v > 0.0 else -p.asymmetry)
    excess = p.breakaway_excess
    if p.dwell_gain > 0.0:
        excess += p.dwell_gain * math.log10(1.0 + rest / 0.1)
    if excess > 0.0:
        s = (abs(v) / p.stribeck_speed) ** p.stribeck_exponent
        if p.stribeck_law == EXPONENTIAL:
            sliding += excess * math.exp(-s)
        elif p.stribeck_law == SECANT:
            sliding += excess / math.cosh(min(s, 100.0))
        else:
            sliding += excess / (1.0 + s)
    if p.place_gain != 0.0:
        sliding *= 1.0 + p.place_gain * math.cos(2.0 * math.pi * x / p.place_pitch + p.place_phase)
    return sliding / (1.0 + p.warm_gain * warmth)


@kernel
def viscous(v, warmth, p):
    """Return the viscous friction [N], signed as the speed; an index below 1 is a lubricant that thins with shear."""
    if p.viscous <= 0.0 or v == 0.0:
        return 0.0
    size = abs(v)
    force = p.viscous * (size if p.viscous_index == 1.0 else size**p.viscous_index)
    force /= 1.0 + p.warm_gain * warmth
    return force if v > 0.0 else -force


@kernel
def contact(v, z, sliding, p):
    """Return the friction [N] of a contact and the rate of its bristle [m/s].

    Args:
        v: Speed [m/s].
        z: Deflection of the bristle [m].
        sliding: What `level` says [N].
        p: The machine.
    """
    if sliding <= 0.0:
        return 0.0, 0.0
    if p.contact_law == TANH:
        return sliding * math.tanh(v / p.smooth_speed), 0.0
    stiffness = min(p.bristle_stiffness, sliding / 1e-5)  # a weak contact is a soft one
    share = 1.0
    if p.contact_law == ELASTOPLASTIC:
        if v * z < 0.0:
            share = 0.0
        else:
            low, high = 0.6 * sliding / stiffness, sliding / stiffness
            size = abs(z)
            if size < low:
                share = 0.0
            elif size < high:
                share = 0.5 - 0.5 * math.cos(math.pi * (size - low) / (high - low))
    rate = v - share * stiffness * abs(v) * z / sliding
    fading = math.exp(-((v / 0.05) ** 2))
    return stiffness * z + p.bristle_damping * fading * rate, rate
