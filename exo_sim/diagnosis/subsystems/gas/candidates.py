"""Candidates for a cylinder's gas: every declared effect in each of its forms, and the sensor faults that imitate one."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.estimation.sensor_error import sensor_error
from exo_sim.diagnosis.nominal_numbers import CARD_OF_PRESSURES, DEAD_VOLUME, POSITION_DELAY
from exo_sim.diagnosis.policy import healthy, priors
from exo_sim.diagnosis.subsystems.gas.healthy_limits import healthy_limit
from exo_sim.diagnosis.subsystems.gas.place import measured_places, place_of
from exo_sim.physics.declaration import Effect, Parameter, declared, identification_of
from exo_sim.physics.effects import sensor_bias, sensor_delay, sensor_scale

#: A parameter that is never zero and whose typical range spans more than this factor is fitted by its logarithm.
LOGARITHMIC = 4.0
#: Of a cylinder's record.
DEAD_VOLUMES = ("dead_volume_1", "dead_volume_2")


def candidates(plant: PlantParameters, runs: Sequence[CylinderRun], cylinder: str, joint: str) -> tuple[Candidate, ...]:
    """Return every candidate that these recordings of one cylinder can show, in the order of their names."""
    valve = float(plant.cylinder["valve_area"][0]) > 0.0
    commanded = valve and any(run.commanded for run in runs)
    steered = commanded and not all(run.stays_open for run in runs)
    switched = steered and all(run.is_switched for run in runs if run.commanded)
    thrown = switched and all(run.is_never_partly_open for run in runs if run.commanded)
    changes_sides = any(run.changes_sides for run in runs)
    moves = any(run.moves for run in runs)
    measured, contained = measured_places(runs), plant.contained_effects
    single = float(plant.cylinder["single_acting"][0]) > 0.0
    found: list[Candidate] = []
    period = sample_period(runs)
    for effect in declared().values():
        sense = effect.identification.applicability
        if effect.cut != "gas" or effect.identification.excluded or effect.name in contained or effect.places[0] in measured:
            continue
        if (sense.commanded and not commanded) or ("valve_command" in effect.needs and not steered):
            continue
        if (sense.moving and not moves) or (sense.two_chambers and single) or (sense.partly_open and thrown):
            continue
        if plant.is_on(effect):
            found += _left_open(effect, cylinder, plant)
            continue
        if sense.known_at_joint and float(plant.cylinder[sense.known_at_joint][0]) > 0.0:
            continue
        for form in effect.identification.forms or (tuple(p.name for p in effect.parameters if not p.choices),):
            if single and any(name.endswith("_2") for name in form):
                continue
            made = _of_form(effect, cylinder, form, plant)
            if effect.identification.starts_by_reach:
                made = [replace(one, starts=_starts_within_reach(effect, form, plant, runs)) for one in made]
            found += [_beyond_a_sample(one, period) for one in made]
        at_once = effect.identification.switched if switched else {}
        for form, values in at_once.items():
            found += [_beyond_a_sample(one, period) for one in _begun_at(effect, cylinder, form, values, plant)]
        for form, values in effect.identification.further.items():
            if form not in at_once:
                made = [replace(one, further=frozenset(values)) for one in _begun_at(effect, cylinder, form, values, plant)]
                found += [_beyond_a_sample(one, period) for one in made]
    found = [one for one in found if changes_sides or not _shows_by_reversals(one)]
    found += _sensor_faults(runs, cylinder, joint, moves)
    asked = {"", *(one.effect for one in found)}
    return tuple(one if one.prerequisite in asked else _without_what_is_not_asked(one) for one in found)


def _shows_by_reversals(candidate: Candidate) -> bool:
    """Return whether a candidate differs from another only where commands switch the valve straight from one side to the other."""
    return any(declared()[q.effect].parameter(q.parameter).by_reversals for q, _ in candidate.fixed)


def _without_what_is_not_asked(candidate: Candidate) -> Candidate:
    """Return a candidate that stands alone where what it would come on top of is not asked; of what it acts through it stays a part."""
    return replace(candidate, prerequisite="") if candidate.prerequisite == identification_of(candidate.effect).on_top_of else candidate


def _left_open(effect: Effect, cylinder: str, plant: PlantParameters) -> list[Candidate]:
    """Return what an owner who has an effect left open of its law: of one that every machine follows in some form, or that may go on.

    How it goes on is one question: all parameters that say it are asked together.
    """
    declares, has = effect.identification, plant.numbers_of(effect)
    forms = [
        {name: (mean - spread, mean + spread)} for name, (mean, spread) in declares.known.items() if declares.every_law and name not in has
    ]  # fmt: skip
    found = [_as_law(effect, cylinder, values, plant) for values in forms]
    for values in (asked for question in declares.left_open if (asked := question(has))):
        one = _as_law(effect, cylinder, values, plant)  # how much there is of what he has is no finding, in whichever form
        found.append(replace(one, parameters=tuple(replace(q, healthy_limit=0.0) for q in one.parameters)))
    return found


def _as_law(effect: Effect, cylinder: str, values: Mapping[str, tuple[float, ...]], plant: PlantParameters) -> Candidate:
    """Return the candidate of how a law goes on, by parameter with the values that it begins with; the rest is the rig's."""
    one = _of_form(effect, cylinder, tuple(values), plant)[0]
    return replace(one, form="+".join(values), is_law=True, starts=tuple(zip(*values.values(), strict=True)), fixed=())


def _begun_at(
    effect: Effect, cylinder: str, form: tuple[str, ...], values: Mapping[str, tuple[float, ...]], plant: PlantParameters
) -> list[Candidate]:
    """Return the candidates of a form that begin at these values; what has none, for a poorer form ended there, at a typical one."""
    begun = {name: values.get(name, (_typical(effect.parameter(name), 0.5),)) for name in form}
    most = max(map(len, begun.values()))
    starts = tuple(tuple(begun[name][min(k, len(begun[name]) - 1)] for name in form) for k in range(most))
    return [replace(one, starts=starts) for one in _of_form(effect, cylinder, form, plant)]


def sample_period(runs: Sequence[CylinderRun]) -> float:
    """Return the longest usual sample period of several runs [s]."""
    return max(float(np.median(np.diff(run.time))) for run in runs)


def _beyond_a_sample(candidate: Candidate, period: float) -> Candidate:
    """Return a candidate of whose healthy delays none is shorter than a sample.

    A card's filter is slower the slower it samples (it lets nothing beyond half that rate pass), and all pressures share it.
    """
    return replace(
        candidate,
        parameters=tuple(
            replace(q, healthy_limit=max(q.healthy_limit, period)) if q.unit == "s" and q.healthy_limit > 0.0 else q
            for q in candidate.parameters
        ),
    )


def _starts_within_reach(
    effect: Effect, form: tuple[str, ...], plant: PlantParameters, runs: Sequence[CylinderRun]
) -> tuple[tuple[float, ...], ...]:
    """Return initial values of what lies at fixed distances from the ends of the stroke, where the piston comes that near."""
    stroke, valve = float(plant.cylinder["stroke"][0]), float(plant.cylinder["valve_area"][0])
    paths = [run.length for run in runs if run.length is not None]
    nearest = max(min(min(float(np.nanmin(x)), stroke - float(np.nanmax(x))) for x in paths), 0.0)
    shift, size = {"length": nearest}, {"length": 0.5 * stroke, "area": valve}
    return tuple(
        tuple(shift.get(name, 0.0) + value * size[name] for name, value in zip(form, values, strict=True))
        for values in effect.identification.starts_by_reach
    )


def _of_form(effect: Effect, cylinder: str, form: tuple[str, ...], plant: PlantParameters) -> list[Candidate]:
    """Return the candidates of one form: one, or one for each word of a choice (where the sensor sits)."""
    where, target = place_of(effect, cylinder)
    parameters = tuple(_free(effect, effect.parameter(name), where, target, plant) for name in form)
    if "inertial" in form or effect.identification.logarithmic:
        parameters = tuple(replace(parameter, logarithmic=True) for parameter in parameters)
    valve, by_name = float(plant.cylinder["valve_area"][0]), effect.identification.starts_by_valve
    porous = "inertial" in form
    if porous:  # where both terms of the path's law take half of the drop from 5 bar
        starts = tuple((*(a for _ in form[:-1]), 2.0 / (a * a * 2.5e11)) for a in (1e-16, 1e-17, 1e-18))
    elif effect.identification.starts:
        starts = tuple(start[: len(form)] for start in effect.identification.starts)
    elif valve > 0.0 and set(form) <= set(by_name):
        starts = tuple(zip(*(tuple(value * (valve if name == "area" else 1.0) for value in by_name[name]) for name in form), strict=True))
    else:
        low = tuple(_typical(effect.parameter(name), 0.25) for name in form)
        high = tuple(_typical(effect.parameter(name), 0.75) for name in form)
        starts = (low, high)
    held = tuple(
        (_free(effect, p, where, target, plant), p.default) for p in effect.parameters if p.default and p.name not in form and not p.choices
    )
    dead = [volume for name in DEAD_VOLUMES if (volume := float(plant.cylinder[name][0])) > 0.0]
    beneath = effect.requires or effect.identification.on_top_of
    one = Candidate(
        effect.name,
        where,
        "+".join(form),
        parameters,
        starts,
        fixed=held,
        proportional=effect.identification.proportional and not porous,
        prerequisite=beneath if beneath and not plant.is_on(declared()[beneath]) else "",
        additive=effect.identification.adds_up,
        is_law=effect.identification.is_law,
        shapes=effect.identification.shapes[form](min(dead)) if form in effect.identification.shapes and dead else (),
    )
    choices = [parameter for parameter in effect.parameters if parameter.choices and (not parameter.shapes or parameter.shapes in form)]
    if not choices:
        return [one]
    found = []
    for chosen in itertools.product(*(range(len(p.choices)) for p in choices)):
        # the first choice of what shapes another parameter is not held: the form goes on from the one without both
        told = [(p, c) for p, c in zip(choices, chosen, strict=True) if c or not p.shapes]
        fixed = (*held, *((_free(effect, p, where, target, plant), float(c)) for p, c in told))
        found.append(replace(one, form=one.form + "".join(f",{p.name}={p.choices[c]}" for p, c in told), fixed=fixed))
    return found


def _typical(parameter: Parameter, share: float) -> float:
    low, high = parameter.typical
    return low * (high / low) ** share if low > 0.0 else low + share * (high - low)


def _free(effect: Effect, parameter: Parameter, where: str, target: Target, plant: PlantParameters) -> FreeParameter:
    low, high = parameter.typical
    scale = effect.identification.known.get(parameter.name, (0.0, 0.0))[1] or abs(_typical(parameter, 0.5)) or 0.5 * (high - low)
    most, valve = parameter.high, float(plant.cylinder["valve_area"][0])
    if parameter.name == "area" and effect.identification.starts_by_valve and valve > 0.0:
        most = min(most, priors.WIDEST_IN_SERIES * valve)
    return FreeParameter(
        effect.name, where, parameter.name, parameter.unit, target, scale, parameter.low, most,
        effect.identification.known.get(parameter.name), neutral=effect.identification.neutral.get(parameter.name, 0.0),
        nonsmooth=effect.identification.jerky, healthy_limit=healthy_limit(effect, parameter, plant),
        logarithmic=parameter.low > 0.0 and high > LOGARITHMIC * low,
        displaces=_displaced(plant, where) if parameter.name == effect.identification.of_dead_volume else (),
        saturates=parameter.name in effect.identification.saturates,
    )  # fmt: skip


def _displaced(plant: PlantParameters, cylinder: str) -> tuple[tuple[tuple[str, str, str], float], ...]:
    """Return the dead volumes of a cylinder, each with what a cubic metre is of it."""
    dead = {name: float(plant.cylinder[name][0]) for name in DEAD_VOLUMES}
    return tuple(((DEAD_VOLUME, cylinder, name), 1.0 / volume) for name, volume in dead.items() if volume > 0.0)


def _sensor_faults(runs: Sequence[CylinderRun], cylinder: str, joint: str, moves: bool) -> list[Candidate]:
    found = []
    period = sample_period(runs)
    for side in (1, 2):
        if all(run.pressure[side - 1] is None for run in runs):
            continue
        column, signal = f"{cylinder}.pressure_{side}", f"pressure_{side}"
        limit, reach = healthy.ZEROS * priors.PRESSURE_ZERO, priors.SENSOR_BIAS_REACH
        found.append(sensor_error(sensor_bias.EFFECT, column, f"{signal}.bias", "Pa", 2e3, (-reach, reach), limit))
        found += [_scale(column, signal), _delay(column, f"{signal}.delay", period, healthy.SKEW)]
    if all(run.pressure[side] is not None for run in runs for side in range(2)):
        card = _delay(f"{cylinder}.pressure_1", CARD_OF_PRESSURES, period, healthy.MOST_CARD_SKEW)
        found.append(replace(card, form=f"{card.form},card", also=(f"{cylinder}.pressure_2",)))
    if moves:
        column = f"{joint}.position"
        found += [_delay(column, POSITION_DELAY, period, healthy.MOST_CARD_SKEW), _scale(column, "position")]
    return found


def _scale(column: str, signal: str) -> Candidate:
    reach = (priors.SENSOR_SCALE_LEAST, priors.SENSOR_SCALE_MOST)
    return sensor_error(sensor_scale.EFFECT, column, f"{signal}.scale", "1", priors.SENSOR_SCALE_TYPICAL, reach, healthy.SCALE, neutral=1.0)


def _delay(column: str, name: str, period: float, healthy_skew: float) -> Candidate:
    """Return a delay; of pressures beside each other less is a finding than of cards beside each other.

    A logger with this sample period [s] reads its channels one after the other: what is within a period is no finding, and many
    periods may be. No sensor shows what is yet to come.
    """
    limit = max(healthy_skew, period)
    reach = max(priors.SENSOR_DELAY_REACH, priors.SENSOR_DELAY_SAMPLES * period)
    return sensor_error(sensor_delay.EFFECT, column, name, "s", max(priors.SENSOR_DELAY_TYPICAL, period), (-limit, reach), limit)
