"""The questions that can be put to a cylinder's gas: every declared effect in each of its forms, and what else imitates one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.observed import CylinderRun
from exo_sim.diagnosis.quantity import SPREADS, Candidate, Quantity, Setting
from exo_sim.physics.effects.declaration import Effect, Parameter, declared
from exo_sim.signals import SHARED_PARTS

#: A number that is never zero and whose typical range is wider than this is fitted by its logarithm.
WIDE = 4.0
#: What is in series with a valve and so many times as wide holds nothing up, and only takes long to predict.
WIDEST = 20.0
#: Zero of a good pressure sensor, one standard deviation [Pa].
ZERO_SPREAD = 500.0
#: Seconds by which filters and cards of a good laboratory may be apart.
HEALTHY_SKEW = 6e-4

#: Heat that walls may take from a gas at rest, one standard deviation [W/K].
REST_HEAT = 2.0
#: Leaks of a healthy cylinder for its swept volume, by their unit [m^2/m^3, kg/(s Pa^2 m^3)]: they take minutes to empty it.
_HEALTHY_LEAKS = {"m^2": 1.8e-5, "kg/(s Pa^2)": 1.8e-13}

#: Heat transfer that no gas at rest goes below, on the wall of the whole cylinder [W/(m^2 K)].
HEALTHY_FILM = 2.0


def believed(setting: Setting, cylinder: str, commanded: bool, sides: Sequence[int], rests: bool = False) -> tuple[Quantity, ...]:
    """Return what every fit of the gas may move: valve area and dead volumes as factors, sensor zeros, a healthy valve's faults.

    A gas at rest gives heat to its walls while its pressure falls, in every machine: where nothing else happens that is no finding.

    Args:
        setting: The machine as believed.
        cylinder: Its name.
        commanded: Whether a valve command was recorded; without one nothing is asked of the valve.
        sides: Chambers whose pressure was recorded, of 1 and 2.
        rests: Neither valve nor piston ever moves.
    """
    numbers = tuple(
        Quantity(name, cylinder, field, "1", "factor", 0.1, 0.05, 10.0, (1.0, SPREADS[key]), neutral=1.0)
        for name, field, key in (
            ("flow_capacity", "valve_area", "flow_capacity"),
            ("dead_volume", "dead_volume_1", "dead_volume_1"),
            ("dead_volume", "dead_volume_2", "dead_volume_2"),
        )
        if commanded or field != "valve_area"
    )
    zeros = tuple(
        Quantity(
            "sensor_zero",
            f"{cylinder}.pressure_{side}",
            f"pressure_{side}.bias",
            "Pa",
            "sensor",
            ZERO_SPREAD,
            -1e4,
            1e4,
            (0.0, ZERO_SPREAD),
        )  # fmt: skip
        for side in sides
    )
    if rests and not setting.is_on(declared()["wall_heat_transfer"]):
        spread = REST_HEAT
        zeros += (Quantity("wall_heat_transfer", cylinder, "conductance", "W/K", "cylinder", spread, 0.0, 20.0 * spread, (0.0, spread)),)
    return (*numbers, *zeros, *_imperfections(setting, cylinder)) if commanded else (*numbers, *zeros)


def _imperfections(setting: Setting, cylinder: str) -> tuple[Quantity, ...]:
    """Return what a healthy valve shows, of what the rig does not know already."""
    found = []
    for effect in declared().values():
        for name, (spread, most) in effect.asked.healthy.items():
            parameter = effect.parameter(name)
            if not setting.is_on(effect):
                low = 0.0 if parameter.low >= 0.0 else -most
                found.append(
                    Quantity(
                        effect.name, cylinder, name, parameter.unit, "cylinder", spread, low, most, (0.0, spread),
                        rough=effect.asked.jerky,
                    )  # fmt: skip
                )
    return tuple(found)


def known_effects(setting: Setting, cylinder: str) -> tuple[Quantity, ...]:
    """Return the parameters of effects that the rig has on already, free within a tenth: an owner's numbers are estimates."""
    found = []
    for effect in declared().values():
        if effect.cut != "gas" or effect.name == "critical_ratio":
            continue
        where, target = _place(effect, cylinder)
        record = setting.world if target == "world" else setting.cylinder
        for parameter in effect.parameters:
            value = float(record[effect.name][parameter.name][0])
            if value != 0.0 and not parameter.choices:
                found.append(
                    Quantity(
                        effect.name, where, parameter.name, parameter.unit, target, 0.1 * abs(value), parameter.low, parameter.high,
                        (value, 0.1 * abs(value)), rough=effect.asked.jerky,
                    )  # fmt: skip
                )
    return tuple(found)


def without_what_was_measured(setting: Setting, runs: Sequence[CylinderRun]) -> Setting:
    """Return a setting whose supply and exhaust are what was measured there, whatever the rig knows of how they come about."""
    measured = setting.copy()
    switch_off(measured.world, _measured(runs))
    return measured


def switch_off(world: NDArray[np.void], places: Collection[str]) -> None:
    """Switch off what acts at these shared parts, in the place: where its pressure was measured, that holds already what they do.

    Args:
        world: Record WORLD, shape (1,).
        places: Of "supply" and "exhaust".
    """
    for effect in declared().values():
        if effect.places[0] in places:
            world[effect.name] = np.zeros(1, world[effect.name].dtype)


def candidates(setting: Setting, runs: list[CylinderRun], cylinder: str, joint: str) -> tuple[Candidate, ...]:
    """Return every question that these recordings of one cylinder can be asked, in the order of their names."""
    valve = float(setting.cylinder["valve_area"][0]) > 0.0
    commanded = valve and any(run.commanded for run in runs)
    moves = any(run.length is not None and float(run.length.max() - run.length.min()) > 1e-4 for run in runs)
    measured = _measured(runs)
    found: list[Candidate] = []
    for effect in declared().values():
        if effect.cut != "gas" or effect.places[0] in measured:
            continue
        if "valve_command" in effect.needs and not commanded:
            continue
        if not commanded and effect.name in (
            "valve_null_leakage",
            "exhaust_back_pressure",
            "supply_droop",
            "supply_regulator",
        ):
            continue
        if not moves and effect.name in ("transmission_compliance", "backlash", "end_cushioning"):
            continue
        if effect.name == "piston_leakage" and float(setting.cylinder["single_acting"][0]) > 0.0:
            continue  # chamber 2 is the atmosphere: the leak is an external one
        where, target = _place(effect, cylinder)
        if setting.is_on(effect) and effect.name != "critical_ratio":
            continue
        driven = {"transmission_compliance": "drive_stiffness", "backlash": "drive_gap"}.get(effect.name)
        if driven and float(setting.cylinder[driven][0]) > 0.0:  # the rig has it at the joint
            continue
        single = float(setting.cylinder["single_acting"][0]) > 0.0
        for form in effect.asked.forms or (tuple(p.name for p in effect.parameters if not p.choices),):
            if single and any(name.endswith("_2") for name in form):
                continue
            made = _forms(effect, (where, target), form, setting)
            if effect.asked.starts_by_reach:
                made = [replace(one, starts=_within_reach(effect, form, setting, runs)) for one in made]
            found += made
    found += _sensors(runs, cylinder, joint, moves)
    return tuple(found)


def _within_reach(effect: Effect, form: tuple[str, ...], setting: Setting, runs: list[CylinderRun]) -> tuple[tuple[float, ...], ...]:
    """Return values to begin with for what lies at fixed distances from the ends of the stroke."""
    stroke, valve = float(setting.cylinder["stroke"][0]), float(setting.cylinder["valve_area"][0])
    moved = [run.length for run in runs if run.length is not None]
    nearest = max(min(min(float(np.nanmin(x)), stroke - float(np.nanmax(x))) for x in moved), 0.0)
    shift, size = {"length": nearest}, {"length": 0.5 * stroke, "area": valve}
    return tuple(
        tuple(shift.get(name, 0.0) + value * size[name] for name, value in zip(form, values, strict=True))
        for values in effect.asked.starts_by_reach
    )


def _measured(runs: Sequence[CylinderRun]) -> set[str]:
    """Return the shared parts whose pressure every run holds."""
    return {place for place in ("supply", "exhaust") if all(getattr(run, place) is not None for run in runs)}


def _place(effect: Effect, cylinder: str) -> tuple[str, str]:
    """Return where a cylinder's gas feels an effect, and which record holds its numbers."""
    return (effect.places[0], "world") if effect.places[0] in SHARED_PARTS else (cylinder, "cylinder")


def _forms(effect: Effect, place: tuple[str, str], form: tuple[str, ...], setting: Setting) -> list[Candidate]:
    """Return the candidates of one form; a choice (where the sensor sits) makes one for each of its words."""
    where, target = place
    quantities = tuple(_quantity(effect, effect.parameter(name), where, target, setting) for name in form)
    if "inertial" in form or effect.name == "supply_droop":
        quantities = tuple(replace(quantity, wide=True) for quantity in quantities)
    valve = float(setting.cylinder["valve_area"][0])
    porous = "inertial" in form
    if porous:  # where both terms of the path's law take half of the drop from 5 bar
        starts = tuple((*(a for _ in form[:-1]), 2.0 / (a * a * 2.5e11)) for a in (1e-16, 1e-17, 1e-18))
    elif effect.asked.starts:
        starts = effect.asked.starts
    elif effect.asked.starts_by_valve and valve > 0.0:
        starts = tuple(
            tuple(value * (valve if name == "area" else 1.0) for name, value in zip(form, values, strict=True))
            for values in effect.asked.starts_by_valve
        )
    else:
        low = tuple(_typical(effect.parameter(name), 0.25) for name in form)
        high = tuple(_typical(effect.parameter(name), 0.75) for name in form)
        starts = (low, high)
    pinned = tuple(
        (_quantity(effect, p, where, target, setting), p.default)
        for p in effect.parameters
        if p.default and p.name not in form and not p.choices
    )
    one = Candidate(
        effect.name,
        where,
        "+".join(form),
        quantities,
        starts,
        fixed=pinned,
        proportional=effect.asked.proportional and not porous,
        beside=effect.requires if effect.requires and not setting.is_on(declared()[effect.requires]) else "",
        adds_up=effect.asked.adds_up,
    )
    choices = [parameter for parameter in effect.parameters if parameter.choices]
    if not choices:
        return [one]
    return [
        replace(
            one,
            form=one.form + "".join(f",{p.name}={p.choices[c]}" for p, c in zip(choices, chosen, strict=True)),
            fixed=(
                *pinned,
                *((_quantity(effect, p, where, target, setting), float(c)) for p, c in zip(choices, chosen, strict=True)),
            ),
        )
        for chosen in itertools.product(*(range(len(p.choices)) for p in choices))
    ]


def _typical(parameter: Parameter, share: float) -> float:
    low, high = parameter.typical
    return low * (high / low) ** share if low > 0.0 else low + share * (high - low)


def healthy_leaks(setting: Setting) -> dict[str, float]:
    """Return, by parameter of a leak, what takes minutes to empty the cylinder [m^2, kg/(s Pa^2)]."""
    swept = float(setting.cylinder["area_1"][0] * setting.cylinder["stroke"][0])
    parameters = declared()["external_leakage"].parameters
    return {p.name: _HEALTHY_LEAKS[p.unit] * swept for p in parameters if p.unit in _HEALTHY_LEAKS}


def _least(effect: Effect, parameter: Parameter, setting: Setting) -> float:
    """Return what a healthy machine has of a parameter; of a leak, what empties the cylinder by half in some minutes."""
    c = setting.cylinder[0]
    if effect.asked.leaks and parameter.unit in _HEALTHY_LEAKS:
        return effect.asked.leaks * _HEALTHY_LEAKS[parameter.unit] * float(c["area_1"] * c["stroke"])
    if effect.name == "wall_heat_transfer":
        bore = math.sqrt(4.0 * float(c["area_1"]) / math.pi)
        return HEALTHY_FILM * math.pi * bore * (float(c["stroke"]) + 0.5 * bore)
    return effect.asked.smallest(parameter.name)


def _quantity(effect: Effect, parameter: Parameter, where: str, target: str, setting: Setting) -> Quantity:
    low, high = parameter.typical
    scale = abs(_typical(parameter, 0.5)) or 0.5 * (high - low)
    neutral = 0.528 if effect.name == "critical_ratio" else 0.0  # the nozzle's own
    most, valve = parameter.high, float(setting.cylinder["valve_area"][0])
    if parameter.name == "area" and effect.asked.starts_by_valve and valve > 0.0:
        most = min(most, WIDEST * valve)
    return Quantity(
        effect.name, where, parameter.name, parameter.unit, target, scale, parameter.low, most, neutral=neutral,
        rough=effect.asked.jerky, least=_least(effect, parameter, setting), wide=parameter.low > 0.0 and high > WIDE * low,
    )  # fmt: skip


def _sensors(runs: list[CylinderRun], cylinder: str, joint: str, moves: bool) -> list[Candidate]:
    found = []
    for side in (1, 2):
        column = f"{cylinder}.pressure_{side}"
        if all(run.pressure[side - 1] is None for run in runs):
            continue
        bias = Quantity("sensor_bias", column, f"pressure_{side}.bias", "Pa", "sensor", 2e3, -1.2e5, 1.2e5, least=4.0 * ZERO_SPREAD)
        scale = Quantity("sensor_scale", column, f"pressure_{side}.scale", "1", "sensor", 0.02, 0.8, 1.25, neutral=1.0, least=0.003)
        delay = Quantity("sensor_delay", column, f"pressure_{side}.delay", "s", "sensor", 2e-3, -0.05, 0.05, least=HEALTHY_SKEW)
        found.append(Candidate("sensor_bias", column, "value", (bias,), ((2e3,),), "sensor"))
        found.append(Candidate("sensor_scale", column, "factor", (scale,), ((1.02,),), "sensor"))
        found.append(Candidate("sensor_delay", column, "seconds", (delay,), ((2e-3,),), "sensor"))
    if moves:
        column = f"{joint}.position"
        scale = Quantity("sensor_scale", column, "position.scale", "1", "sensor", 0.02, 0.8, 1.25, neutral=1.0, least=0.003)
        delay = Quantity("sensor_delay", column, "position.delay", "s", "sensor", 2e-3, -0.05, 0.05, least=HEALTHY_SKEW)
        found.append(Candidate("sensor_delay", column, "seconds", (delay,), ((2e-3,),), "sensor"))
        found.append(Candidate("sensor_scale", column, "factor", (scale,), ((1.02,),), "sensor"))
    return found
