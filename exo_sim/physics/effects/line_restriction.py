"""A hose between valve and chamber."""

from __future__ import annotations

import math
from collections.abc import Mapping

from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.effects import critical_ratio
from exo_sim.physics.identification import Applicability

#: Throat area of a nozzle over the sonic conductance of the same choked flow of air at 293.15 K and 1.185 kg/m^3 [Pa s/m].
_NOZZLE = 502.0


def sonic_conductance(bore: float, length: float) -> float:
    """Return the sonic conductance C of a smooth hose [m^3/(s Pa)] (ISO 6358-3, annex on tubes; lengths in m)."""
    return 0.029 * bore**2 / math.sqrt(length / bore**1.25 + 510.0)


#: Heat that a metre of hose takes from gas that flows in layers, Nu k pi with Nu = 3.66 (Incropera, ch. 8) [W/(K m)].
_HEAT = 0.3


def _hoses_within(
    dead_volume: float, lengths: tuple[float, ...] = (0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0)
) -> tuple[tuple[float, float, float], ...]:
    """Return area [m^2], volume [m^3] and length [m] of hoses that hold a share of a dead volume, each with the area of its bore."""
    found = []
    for share in (0.35, 0.6, 0.85):
        for length in lengths:
            volume = share * dead_volume
            bore = math.sqrt(4.0 * volume / (math.pi * length))
            found.append((_NOZZLE * sonic_conductance(bore, length), volume, length))
    return tuple(found)


def _warm_hoses_within(dead_volume: float) -> tuple[tuple[float, float, float], ...]:
    """Return area [m^2], volume [m^3] and conductance [W/K] of such hoses."""
    return tuple((area, volume, _HEAT * length) for area, volume, length in _hoses_within(dead_volume, (0.5, 1.0, 2.0, 3.0)))


def _as_a_line(known: Mapping[str, float]) -> dict[str, tuple[float, ...]]:
    """Return the question how a known hose goes on: its ratio, waves and heat together, as far as its owner does not say them."""
    begun = {"ratio": (0.36, 0.36, 0.36), "length": (0.7, 1.5, 3.0), "conductance": (0.2, 0.45, 0.9)}
    return {name: values for name, values in begun.items() if name not in known}


EFFECT = Effect(
    name="line_restriction",
    places=("cylinder",),
    family="line",
    question="Do valve end and cylinder end of the hose differ in pressure while gas flows?",
    says="The hose between valve and cylinder throttles the flow.",
    parameters=(
        Parameter(
            "area", "m^2", 1e-8, 1e-3, (2e-6, 3e-5),
            "502 Pa s/m times C = 0.029 D^2/sqrt(L/D^1.25 + 510) in m^3/(s Pa), D and L in m, for 3-8 mm hoses of 0.3-2 m",
        ),
        Parameter(
            "volume",
            "m^3",
            1e-7,
            1e-3,
            (2e-6, 5e-5),
            "12.6 cm^3/m (4 mm), 28.3 cm^3/m (6 mm)",
            required=False,
            default=5e-6,
        ),
        Parameter(
            "ratio", "1", 0.02, 0.6, (0.2, 0.5), "b = 474 C/D^2 (ISO 6358; C in m^3/(s Pa), D in m): 0.24-0.55 for the same hoses",
            required=False,
        ),
        Parameter(
            "length", "m", 0.1, 20.0, (0.5, 5.0), "machines with valves on a frame, hoses of 4-8 mm (estimate)", required=False
        ),
        Parameter(
            "conductance", "W/K", 0.0, 1e2, (0.1, 2.0),
            "Nu k pi L: 0.3 W/K a metre where the flow is laminar (Nu = 3.66), some times that where it is not; Incropera, ch. 8",
            required=False,
        ),
        Parameter(
            "sensor", "1", 0, 1, (0, 1), "where the pressure sensors sit", required=False, choices=("chamber", "valve")
        ),
    ),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("flow_capacity", "critical_ratio", "valve_lag", "dead_volume"),
    experiment="measure the pressure at both ends of the hose during a fill, or double its length",
    convention=(
        "the hose's volume comes on top of the dead volumes of the rig; both hoses are alike. ratio is the b of ISO 6358, choked flow "
        "staying that of a nozzle of this area; without one it is a nozzle throughout. With a length its gas has inertia and, at small "
        "flows, laminar friction over a section of volume / length: a quarter of it lies at the valve, one half in the middle and a "
        "quarter at the chamber, between which waves pass. conductance is heat transfer coefficient times area of the wall of one hose, "
        "which is as warm as the surroundings."
    ),
    valid=(
        "without a length the hose is shorter than a twentieth of the wave (2 m up to 8 Hz): one node, no delay; with one it is shorter "
        "than a sixth of it. One conductance holds at rest and in any flow. As a nozzle (b = 0.528) it passes 17 % more at a pressure "
        "ratio of 0.8 than the b = 0.3 of a long hose does."
    ),
    signature="flow saturates at large openings; a sensor at the valve jumps when the flow starts and stops",
    identification=Identification(
        forms=(("area", "volume"), ("area", "volume", "ratio"), ("area", "volume", "length")),
        further={
            ("area", "volume", "conductance"): {"conductance": (0.3, 0.6)},
            ("area", "volume", "ratio", "conductance"): {"ratio": (0.36, 0.36), "conductance": (0.3, 0.6)},
            ("area", "volume", "length", "conductance"): {"length": (1.0, 2.0), "conductance": (0.3, 0.6)},
            ("area", "volume", "ratio", "length", "conductance"): {
                "ratio": (0.36, 0.36), "length": (1.0, 2.0), "conductance": (0.3, 0.6)
            },
        },
        starts_by_valve={"area": (2.0, 0.6, 0.25), "volume": (5e-6, 1e-5, 5e-6), "ratio": (0.36,) * 3, "length": (1.0, 2.0, 1.0)},
        shapes={("area", "volume", "length"): _hoses_within, ("area", "volume", "conductance"): _warm_hoses_within},
        of_dead_volume="volume",
        saturates=("area",),
        known={"ratio": (0.36, 0.08)},
        left_open=(_as_a_line,),
        applicability=Applicability(bursts=False),  # it delays and does not ring
    ),
)

#: Of air at 20 degrees [Pa s].
_VISCOSITY = 1.8e-5

#: Below this share of the pressure a drop is so small that the gas keeps its density, and `nozzle` and ellipse join a straight line.
_KNEE = 0.005


@kernel
def present(p) -> bool:
    """Return whether there is a hose at all."""
    return p.area > 0.0


@kernel
def has_inertia(p) -> bool:
    """Return whether the gas in it moves on for a while when the pressures that moved it are gone: then it has a middle, too."""
    return p.area > 0.0 and p.length > 0.0


@kernel
def node_volume(p) -> float:
    """Return the volume at the valve's end [m^3]."""
    return 0.25 * p.volume if has_inertia(p) else p.volume


@kernel
def middle_volume(p) -> float:
    """Return the volume in the middle [m^3]."""
    return 0.5 * p.volume if has_inertia(p) else 0.0


@kernel
def volume_at_chamber(p) -> float:
    """Return the volume that fills and empties with the chamber [m^3]."""
    return 0.25 * p.volume if has_inertia(p) else 0.0


@kernel
def warming(p, volume: float, t: float, ambient: float) -> float:
    """Return the heat that the wall gives to gas at t in a part of the hose's volume [W]."""
    return volume / p.volume * p.conductance * (ambient - t)


@kernel
def wave_rate(p, temperature: float, k: float, r: float) -> float:
    """Return a bound on the angular frequency of its waves [1/s], by Gershgorin's circles."""
    return 4.0 * math.sqrt(k * r * temperature) / p.length


@kernel
def friction_rate(p, whole: float, w: float) -> float:
    """Return how fast the throttle takes away a flow of w [1/s]; `whole` is its `resistance`."""
    return 2.0 * p.volume / (p.length * p.length) * whole * abs(w)


@inlined_kernel
def resistances(p, outlet: float, p_a: float, t_a: float, p_b: float, t_b: float, k: float, r: float) -> tuple[float, float]:
    """Return the `resistance` of which each half has one half: of the half at the valve, and of that at a chamber whose cushion leaves
    `outlet` of the throttle [m^2]. What the cushion adds acts there alone; steadily the two are those of `outlet`.
    """
    whole = resistance(p, p.area, p_a, t_a, p_b, t_b, k, r)
    if outlet >= p.area:
        return whole, whole
    return whole, 2.0 * resistance(p, outlet, p_a, t_a, p_b, t_b, k, r) - whole


@inlined_kernel
def resistance(p, area: float, p_a: float, t_a: float, p_b: float, t_b: float, k: float, r: float) -> float:
    """Return the drop of pressure from end to end over the square of the flow that it drives steadily [Pa s^2/kg^2].

    `area` is the throttle's as a cushion leaves it.
    """
    drop = p_a - p_b
    if abs(drop) > _KNEE * max(p_a, p_b):
        steady = flow(p, area, p_a, t_a, p_b, t_b, k, r)
        return abs(drop) / (steady * steady)
    return r / ((p_a / t_a + p_b / t_b) * area * area)


@kernel
def acceleration(p, whole: float, w: float, p_a: float, t_a: float, p_b: float, t_b: float, r: float) -> float:
    """Return by how much the flow w through one half of it grows [kg/s^2]: pressures push it, throttle or wall hold it back.

    Where the throttle takes less than the wall does by Hagen and Poiseuille's law, it is the wall.

    Args:
        whole: `resistance` of both halves.
        w: From a to b [kg/s].
        p_a, t_a, p_b, t_b: At the ends of the half.
    """
    section, length = p.volume / p.length, 0.5 * p.length
    density = 0.5 * (p_a / t_a + p_b / t_b) / r
    laminar = 8.0 * math.pi * _VISCOSITY * length / (density * section * section)
    return section / length * (p_a - p_b - max(0.5 * whole * abs(w), laminar) * w)


@inlined_kernel
def flow(p, area: float, p_a: float, t_a: float, p_b: float, t_b: float, k: float, r: float) -> float:
    """Return the mass flow through the hose's throttle from a to b [kg/s], negative where b is upstream.

    `area` is the throttle's as a cushion leaves it.
    """
    return critical_ratio.path_flow(p.ratio, area, p_a, t_a, p_b, t_b, k, r)
