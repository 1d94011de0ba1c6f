"""The questions that can be put to a cylinder's gas: every declared effect in each of its forms, and what else imitates one."""

from __future__ import annotations

import itertools
from dataclasses import replace

from exo_sim.diagnosis.observed import CylinderRun
from exo_sim.diagnosis.quantity import SPREADS, Candidate, Quantity, Setting
from exo_sim.physics.effects.declaration import Effect, Parameter, declared

#: Effects whose answer is in jerks: play, dead zones, limits.
_ROUGH = {"valve_hysteresis", "valve_deadband", "backlash", "spool_rate_limit", "end_cushioning", "supply_regulator"}

#: Effects that are linear in their parameters from zero on: a signature may be scaled until it shows.
_PROPORTIONAL = {
    "wall_heat_transfer",
    "piston_leakage",
    "external_leakage",
    "valve_null_leakage",
    "valve_offset",
    "valve_lag",
}

#: Forms in which a question is put: which parameters are free together. Effects not listed have one form with all of them.
_FORMS: dict[str, tuple[tuple[str, ...], ...]] = {
    "wall_heat_transfer": (("conductance",), ("conductance_1", "conductance_2")),
    "piston_leakage": (("area",), ("laminar",)),
    "external_leakage": (
        ("area_1",),
        ("area_2",),
        ("laminar_1",),
        ("laminar_2",),
        ("area_1", "area_2"),
        ("laminar_1", "laminar_2"),
        ("laminar_1", "inertial"),
        ("laminar_2", "inertial"),
        ("laminar_1", "laminar_2", "inertial"),
    ),
    "valve_lag": (("time_constant",), ("delay",), ("time_constant", "delay")),
    "line_restriction": (("area", "volume"),),
    "exhaust_back_pressure": (("area",),),
    "supply_regulator": (("droop", "time_constant"),),
}

#: Values to begin with where the range is wide or the answer not in proportion; else a low and a high typical one.
_STARTS: dict[str, tuple[tuple[float, ...], ...]] = {
    "valve_deadband": ((0.01,), (0.04,), (0.1,)),
    "valve_hysteresis": ((0.01,), (0.04,), (0.1,)),
    "valve_offset": ((0.01,), (-0.01,)),
    "critical_ratio": ((0.4,), (0.25,)),
    "supply_droop": ((2e-3, 1e-7), (5e-4, 2e-8)),
    "supply_regulator": ((1e7, 0.1), (5e7, 0.05)),
    "spool_rate_limit": ((20.0,), (6.0,), (60.0,)),
    "transmission_compliance": ((3e5,), (3e4,)),
    "backlash": ((2e-4,), (1e-3,)),
}

#: As above, areas in units of the valve's.
_STARTS_BY_VALVE: dict[str, tuple[tuple[float, ...], ...]] = {
    "line_restriction": ((2.0, 5e-6), (0.6, 1e-5), (0.25, 5e-6)),
    "exhaust_back_pressure": ((3.0,), (1.0,), (0.5,), (0.25,)),
    "end_cushioning": ((0.01, 0.1), (0.02, 0.03), (0.03, 0.1)),
}

#: What a healthy machine shows as well: smaller than this is no finding.
_LEAST = {
    ("valve_deadband", "width"): 0.002,
    ("valve_offset", "shift"): 5e-4,
    ("valve_hysteresis", "width"): 0.002,
    ("valve_lag", "time_constant"): 4e-4,
    ("valve_lag", "delay"): 3e-4,
    ("critical_ratio", "ratio"): 0.02,
    ("backlash", "gap"): 4e-5,
}


def believed(cylinder: str) -> tuple[Quantity, ...]:
    """Return the believed numbers that every fit of the gas may move: valve area and both dead volumes, as factors."""
    return tuple(
        Quantity(name, cylinder, field, "1", "factor", 0.1, 0.2, 5.0, (1.0, SPREADS[key]), neutral=1.0)
        for name, field, key in (
            ("flow_capacity", "valve_area", "flow_capacity"),
            ("dead_volume", "dead_volume_1", "dead_volume_1"),
            ("dead_volume", "dead_volume_2", "dead_volume_2"),
        )
    )


def known_effects(setting: Setting, cylinder: str) -> tuple[Quantity, ...]:
    """Return the parameters of effects that the rig has on already, free within a tenth: an owner's numbers are estimates."""
    found = []
    for effect in declared().values():
        if effect.cut != "gas" or "cylinder" not in effect.places or effect.name == "critical_ratio":
            continue
        for parameter in effect.parameters:
            value = float(setting.cylinder[effect.name][parameter.name][0])
            if value != 0.0 and not parameter.choices:
                found.append(
                    Quantity(
                        effect.name,
                        cylinder,
                        parameter.name,
                        parameter.unit,
                        "cylinder",
                        0.1 * abs(value),
                        parameter.low,
                        parameter.high,
                        (value, 0.1 * abs(value)),
                        rough=effect.name in _ROUGH,
                    )  # fmt: skip
                )
    return tuple(found)


def candidates(setting: Setting, runs: list[CylinderRun], cylinder: str, joint: str) -> tuple[Candidate, ...]:
    """Return every question that these recordings of one cylinder can be asked, in the order of their names."""
    valve = float(setting.cylinder["valve_area"][0]) > 0.0
    commanded = valve and any(run.commanded for run in runs)
    moves = any(run.length is not None and float(run.length.max() - run.length.min()) > 1e-4 for run in runs)
    found: list[Candidate] = []
    for effect in declared().values():
        if effect.cut != "gas" or _measured_away(effect, runs):
            continue
        if effect.requires and not _is_on(declared()[effect.requires], setting):
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
        where = effect.places[0] if effect.places[0] in ("supply", "exhaust") else cylinder
        if where == cylinder and _is_on(effect, setting) and effect.name != "critical_ratio":
            continue
        single = float(setting.cylinder["single_acting"][0]) > 0.0
        for form in _FORMS.get(effect.name, (tuple(p.name for p in effect.parameters if not p.choices),)):
            if single and any(name.endswith("_2") for name in form):
                continue
            found += _forms(effect, where, form, setting)
    found += _sensors(runs, cylinder, joint, moves)
    return tuple(found)


def _measured_away(effect: Effect, runs: list[CylinderRun]) -> bool:
    """Say whether a measured supply or exhaust already holds what the effect would explain."""
    if effect.name in ("supply_droop", "supply_regulator"):
        return all(run.supply is not None for run in runs)
    return effect.name == "exhaust_back_pressure" and all(run.exhaust is not None for run in runs)


def _is_on(effect: Effect, setting: Setting) -> bool:
    return any(float(setting.cylinder[effect.name][parameter.name][0]) != 0.0 for parameter in effect.parameters)


def _forms(effect: Effect, where: str, form: tuple[str, ...], setting: Setting) -> list[Candidate]:
    """Return the candidates of one form; a choice (where the sensor sits) makes one for each of its words."""
    target = "world" if where in ("supply", "exhaust") else "cylinder"
    quantities = tuple(_quantity(effect, effect.parameter(name), where, target) for name in form)
    valve = float(setting.cylinder["valve_area"][0])
    porous = "inertial" in form
    if porous:  # where both terms of the path's law take half of the drop from 5 bar
        starts = tuple((*(a for _ in form[:-1]), 2.0 / (a * a * 2.5e11)) for a in (1e-16, 1e-17, 1e-18))
    elif effect.name in _STARTS:
        starts = _STARTS[effect.name]
    elif effect.name in _STARTS_BY_VALVE and valve > 0.0:
        starts = tuple(
            tuple(value * (valve if name == "area" else 1.0) for name, value in zip(form, values, strict=True))
            for values in _STARTS_BY_VALVE[effect.name]
        )
    else:
        low = tuple(_typical(effect.parameter(name), 0.25) for name in form)
        high = tuple(_typical(effect.parameter(name), 0.75) for name in form)
        starts = (low, high)
    pinned = tuple(
        (_quantity(effect, p, where, target), p.default)
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
        proportional=effect.name in _PROPORTIONAL and not porous,
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
                *((_quantity(effect, p, where, target), float(c)) for p, c in zip(choices, chosen, strict=True)),
            ),
        )
        for chosen in itertools.product(*(range(len(p.choices)) for p in choices))
    ]


def _typical(parameter: Parameter, share: float) -> float:
    low, high = parameter.typical
    return low * (high / low) ** share if low > 0.0 else low + share * (high - low)


def _quantity(effect: Effect, parameter: Parameter, where: str, target: str) -> Quantity:
    low, high = parameter.typical
    scale = abs(_typical(parameter, 0.5)) or 0.5 * (high - low)
    neutral = 0.528 if effect.name == "critical_ratio" else 0.0  # the nozzle's own
    return Quantity(
        effect.name, where, parameter.name, parameter.unit, target, scale, parameter.low, parameter.high, neutral=neutral,
        rough=effect.name in _ROUGH, least=_LEAST.get((effect.name, parameter.name), 0.0),
    )  # fmt: skip


def _sensors(runs: list[CylinderRun], cylinder: str, joint: str, moves: bool) -> list[Candidate]:
    found = []
    for side in (1, 2):
        column = f"{cylinder}.pressure_{side}"
        if all(run.pressure[side - 1] is None for run in runs):
            continue
        bias = Quantity("sensor_bias", column, f"pressure_{side}.bias", "Pa", "sensor", 2e3, -1.2e5, 1.2e5, least=800.0)
        scale = Quantity(
            "sensor_scale", column, f"pressure_{side}.scale", "1", "sensor", 0.02, 0.8, 1.25, neutral=1.0, least=0.003
        )
        delay = Quantity("sensor_delay", column, f"pressure_{side}.delay", "s", "sensor", 2e-3, -0.05, 0.05, least=3e-4)
        found.append(Candidate("sensor_bias", column, "value", (bias,), ((2e3,),), "sensor"))
        found.append(Candidate("sensor_scale", column, "factor", (scale,), ((1.02,),), "sensor"))
        found.append(Candidate("sensor_delay", column, "seconds", (delay,), ((2e-3,),), "sensor"))
    if moves:
        column = f"{joint}.position"
        scale = Quantity(
            "sensor_scale", column, "position.scale", "1", "sensor", 0.02, 0.8, 1.25, neutral=1.0, least=0.003
        )
        delay = Quantity("sensor_delay", column, "position.delay", "s", "sensor", 2e-3, -0.05, 0.05, least=3e-4)
        found.append(Candidate("sensor_delay", column, "seconds", (delay,), ((2e-3,),), "sensor"))
        found.append(Candidate("sensor_scale", column, "factor", (scale,), ((1.02,),), "sensor"))
    return found
