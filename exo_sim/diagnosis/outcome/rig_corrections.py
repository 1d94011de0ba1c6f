"""Nominal numbers that a fit changed, as corrections of the rig file."""

from __future__ import annotations

from dataclasses import replace

import mujoco

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.uncertainty import bounded_interval, interval
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME, FLOW_CAPACITY, JOINT_DAMPING, JOINT_INERTIA, PAYLOAD_MASS, SET_PRESSURE
from exo_sim.diagnosis.policy.off_nominal import GAIN_SHARE, HELD_WITHIN
from exo_sim.diagnosis.selection.nuisance_calibration import Deviation, error_of_law, is_declared
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.diagnosis.subsystems.motion.moving_masses import PAYLOAD
from exo_sim.rig import Correction, JointFactors, Rig

#: Numbers of the rig that every comparison refits.
REFITTED = (FLOW_CAPACITY, DEAD_VOLUME, PAYLOAD_MASS, JOINT_INERTIA, SET_PRESSURE)
#: What is said of a number that was only refitted, within 95 % of data sheets or beyond.
WITHIN_SHEET_NOTE = "refitted within what a data sheet allows, no finding"
BEYOND_SHEET_NOTE = "refitted further than a data sheet allows; no finding, for it is uncertain or something without a name bends it"


def corrections(data: MachineData, result: SubsystemResult[SubsystemModel]) -> list[Correction]:
    """Return the corrections of what is reported as off, then of what was only refitted, as far as the rig holds these numbers.

    The latter have a note.
    """
    made = [_correction(data, one) for one in result.deviations if _is_the_rigs(data.rig, one.parameter)]
    found = [one for one in made if one is not None]
    values = result.final.fit.values
    asked_anew = {q.key for q in values if q.prior is None}  # what a law of an effect that the rig has says in place of its numbers
    for parameter, error in result.refitted:
        held = parameter.effect in REFITTED or (is_declared(parameter.effect) and _is_the_rigs(data.rig, parameter))
        if not held or (parameter.prior is None and not is_declared(parameter.effect)):
            continue
        if parameter.prior is not None and parameter.key in asked_anew:
            continue
        whole, value = parameter.prior[0] if parameter.prior else 0.0, values[parameter]
        if whole:
            known = error_of_law(parameter, value, error) if is_declared(parameter.effect) else error
            one = _correction(data, Deviation(parameter, value / whole, known / abs(whole)))
            if one is not None:
                found.append(replace(one, note=_note(parameter, value)))
        elif value or _is_given(data.rig, parameter):  # else the rig leaves it out: the dead time of its valve's lag, or how that goes on
            key = ("effects", parameter.effect, parameter.where, parameter.parameter)
            ends = bounded_interval(parameter, value, error)
            found.append(Correction(key, value, parameter.unit, ends, note=_note(parameter, value)))
    return found


def _note(parameter: FreeParameter, value: float) -> str:
    mean, spread = parameter.prior or (value, 0.0)
    return BEYOND_SHEET_NOTE if abs(value - mean) > HELD_WITHIN * spread else WITHIN_SHEET_NOTE


def _is_the_rigs(rig: Rig, parameter: FreeParameter) -> bool:
    """Return whether the rig file holds the number where it was judged; what a joint shares with its piston it does not."""
    return not is_declared(parameter.effect) or rig.effect(parameter.effect, parameter.where) is not None


def _is_given(rig: Rig, parameter: FreeParameter) -> bool:
    """Return whether the rig file gives a number of an effect."""
    effect = rig.effect(parameter.effect, parameter.where)
    return effect is not None and parameter.parameter in effect.parameters


def _correction(data: MachineData, off: Deviation) -> Correction | None:
    """Return a deviation as a correction; None of the mass of a body without a name, which a rig file cannot say."""
    parameter, factor, error = off.parameter, off.factor, max(off.error, GAIN_SHARE)
    if parameter.prior and is_declared(parameter.effect):
        nominal = parameter.prior[0]
        low, high = interval(factor, error)
        path = ("effects", parameter.effect, parameter.where, parameter.parameter)
        return Correction(path, nominal * factor, parameter.unit, (nominal * low, nominal * high))
    low, high = bounded_interval(parameter, factor, error)
    if parameter.effect == PAYLOAD_MASS:
        return _mass(data, parameter, factor, (low, high))
    if parameter.effect in (JOINT_DAMPING, JOINT_INERTIA):
        held = data.rig.joint_factors.get(parameter.where, JointFactors())
        name, nominal = ("inertia_factor", held.inertia) if parameter.effect == JOINT_INERTIA else ("damping_factor", held.damping)
        low, factor, high = (max(number, 1e-3) * nominal for number in (low, factor, high))
        return Correction(("joints", parameter.where, name), factor, "1", (low, high), nominal)
    if parameter.effect == SET_PRESSURE:
        nominal = data.rig.supply.pressure
        return Correction(("supply", "pressure"), nominal * factor, "Pa", (nominal * low, nominal * high), nominal)
    cylinder = data.rig.cylinders[parameter.where]
    if parameter.parameter == "valve_area":
        key, nominal, unit = ("cylinders", parameter.where, "valve", "area"), cylinder.valve_area, "m^2"
        return Correction(key, nominal * factor, unit, (nominal * low, nominal * high), nominal)
    nominal = getattr(cylinder, parameter.parameter)
    place = ("cylinders", parameter.where, parameter.parameter)
    return Correction(place, nominal * factor, "m^3", (nominal * low, nominal * high), nominal)


def _mass(data: MachineData, parameter: FreeParameter, factor: float, ends: tuple[float, float]) -> Correction | None:
    """Return the mass of the body whose nominal mass is most likely wrong, given the factor on all that a joint moves."""
    model = data.model
    root = int(model.jnt_bodyid[model.joint(parameter.where).id])
    whole = float(model.body_subtreemass[root])
    body = _load(data, root, (1.0 - ends[0]) * whole)
    own = float(model.body_mass[body])
    if not model.body(body).name:
        return None
    value, low, high = (max(share * whole - (whole - own), 1e-6) for share in (factor, *ends))
    return Correction(("bodies", model.body(body).name, "mass"), value, "kg", (low, high), own)


def _load(data: MachineData, root: int, taken: float) -> int:
    """Return which of the bodies that move with `root` is what the machine carries, and can lose a mass of `taken` [kg].

    That is the body called "payload"; else the one whose mass the owner says in the rig file, where he says one; else `root` itself.
    """
    model = data.model
    moved = [i for i in range(root, model.nbody) if _is_carried(model, i, root)]
    payload = [i for i in moved if model.body(i).name == PAYLOAD]
    said = [i for i in moved if model.body(i).name in data.rig.body_masses]
    for found in (payload, said):
        if len(found) == 1 and float(model.body_mass[found[0]]) > taken:
            return found[0]
    return root


def _is_carried(model: mujoco.MjModel, body: int, root: int) -> bool:
    while body > root:
        body = int(model.body_parentid[body])
    return body == root
