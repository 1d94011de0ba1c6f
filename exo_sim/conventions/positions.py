"""In which unit positions were written, and whether the pistons then stay inside their cylinders."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.conventions.check import Check
from exo_sim.conventions.gas_balance import Explained, explained
from exo_sim.conventions.machine import Machine, columns_of
from exo_sim.machine.linkage import Linkage
from exo_sim.recording.table import Recording

Array = NDArray[np.float64]

#: What a position under the heading of SI may have been written in, by what its joint does, in SI.
SLIDING: Mapping[str, float] = {"mm": 1e-3, "cm": 1e-2, "inches": 0.0254}
TURNING: Mapping[str, float] = {"degrees": math.pi / 180.0}
#: A piston may leave its stroke by this share of it before it is impossible, and by this much [m] before it is worth a word.
_IMPOSSIBLE, _ODD = 0.1, 3e-3
#: A unit is asked where the piston travels, or lies outside, more than so many strokes.
_TRAVEL, _FAR = 1.5, 5.0
#: Of a stroke that is used less than this, a unit may be too small.
_HARDLY = 0.03
#: Share of the pressure changes that must follow from the motion in the unit that is taken, and must not in the heading's.
_EXPLAINED, _UNEXPLAINED = 0.7, 0.3
#: A travel beyond which no stroke can be meant and the unit must be another [m]: rodless cylinders are made up to about 6 m.
_LONGEST = 10.0
#: By what factor the misfit of the gas balance must fall with another gear.
_BETTER = 4.0


def in_place(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Convert positions that cannot be in the unit of their heading; refuse pistons that no unit brings into their cylinders."""
    checks: list[Check] = []
    for link in machine.links:
        key = f"{link.joint}.position"
        if key in recording and np.isfinite(recording[key]).any():
            recording, found = _one(recording, machine, link, key)
            checks += found
    driven = {link.joint for link in machine.links}
    for joint in range(machine.model.njnt):
        key = f"{machine.model.joint(joint).name}.position"
        hinge = machine.model.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_HINGE)
        if key in recording and key.rsplit(".", 1)[0] not in driven and hinge and machine.model.jnt_limited[joint]:
            low, high = (float(each) for each in machine.model.jnt_range[joint])
            degrees = math.pi / 180.0
            if not _within(recording[key], (low, high)) and _within(degrees * recording[key], (low, high)):
                recording, found = _converted(recording, key, "degrees", degrees)
                checks += found
    return recording, checks


def _one(recording: Recording, machine: Machine, link: Linkage, key: str) -> tuple[Recording, list[Check]]:
    position, cylinder = recording[key], machine.cylinder(link)
    outside, used = _stand(position, machine, link)
    if (geared := _misgeared(recording, machine, link, key, outside)) is not None:
        return recording, [geared]
    possible = _in_range(position, machine, link)
    if outside > _IMPOSSIBLE or not possible:
        units = TURNING if link.turning else SLIDING
        scaled = not possible if link.turning else used > _TRAVEL or outside > _FAR  # else the zero is off, not the unit
        fitting = {unit: factor for unit, factor in units.items() if scaled and _fits(factor * position, machine, link)}
        if fitting:
            taken, factor, shown = _best(fitting, recording, machine, link, key)
            if not shown and not link.turning and _reach(position) < _LONGEST:
                return recording, [_unit_or_stroke(position, machine, link, key, tuple(fitting))]
            return _converted(recording, key, taken, factor)
        return recording, [_refusal(position, machine, link, key)] if outside > _IMPOSSIBLE else []
    if used < _HARDLY and cylinder.valve_area > 0.0:
        larger = {unit: 1.0 / factor for unit, factor in (TURNING if link.turning else SLIDING).items()}
        larger = {unit: factor for unit, factor in larger.items() if _fits(factor * position, machine, link)}
        plain = _explained(recording, machine, link, key, 1.0)
        shares = {unit: _explained(recording, machine, link, key, factor) for unit, factor in larger.items()}
        unit = max(shares, key=lambda each: shares[each].share, default=None)
        if unit and plain.intervals and plain.share < _UNEXPLAINED and shares[unit].share > _EXPLAINED:
            return _converted(recording, key, f"{'radians' if link.turning else 'metres'} under the heading of {unit}", larger[unit])
    if outside * cylinder.stroke > _ODD:
        beyond = f"{1e3 * outside * cylinder.stroke:.1f} mm"
        says = f'"{key}" takes the piston of {link.cylinder} {beyond} beyond its stroke; are stroke, retracted_length and zero right?'
        return recording, [Check("stroke", (key,), says)]
    return recording, []


def _misgeared(recording: Recording, machine: Machine, link: Linkage, key: str, outside: float) -> Check | None:
    """Refuse a gear of the actuator that is none of the machine's: with a gear of 1 the piston is in place, or its pressures follow."""
    gear, cylinder = float(machine.model.actuator_gear[link.actuator, 0]), machine.cylinder(link)
    if gear == 1.0 or gear == 0.0:
        return None
    retracted, stroke = cylinder.retracted_length, cylinder.stroke
    plain = (machine.piston(link, recording[key]) + retracted) / gear - retracted
    low, high = (float(np.nanquantile(plain, q)) for q in (0.01, 0.99))
    if not -_ODD < low < high < stroke + _ODD:
        return None
    if outside <= _IMPOSSIBLE:
        columns = columns_of(recording, machine, link)
        if columns is None or abs(gear) == 1.0:
            return None
        as_it_is = explained(columns, cylinder, machine.rig)
        with_one = explained(replace(columns, position=(columns.position + retracted) / gear - retracted), cylinder, machine.rig)
        if with_one.share < _EXPLAINED or as_it_is.misfit < _BETTER * with_one.misfit:
            return None
    says = (
        f'the actuator "{cylinder.actuator}" of {machine.rig.model.name} has gear="{gear:g}", with which "{key}" does not fit the '
        f'cylinder {link.cylinder}; with gear="1" it does: correct the MJCF'
    )
    return Check("lengths", (key,), says, refused=True)


def _stand(position: Array, machine: Machine, link: Linkage) -> tuple[float, float]:
    """Return how far the piston is outside its stroke at most, and how much of the stroke it uses, as shares of the stroke."""
    stroke = machine.cylinder(link).stroke
    piston = machine.piston(link, position)
    low, high = (float(np.nanquantile(piston, q)) for q in (0.01, 0.99))
    return max(0.0, -low, high - stroke) / stroke, (high - low) / stroke


def _in_range(position: Array, machine: Machine, link: Linkage) -> bool:
    """Return whether a joint stays about where it can, as far as that is known: half as far again, or a turn and a half either way."""
    most = float(np.nanquantile(np.abs(position), 0.99))
    limits = machine.joint_range(link)
    if limits is None:
        return not link.turning or most < 3.0 * math.pi
    return _within(position, limits)


def _within(position: Array, limits: tuple[float, float]) -> bool:
    """Return whether a joint stays in its range, or half that range beyond it."""
    if not np.isfinite(position).any():
        return True
    low, high = (float(np.nanquantile(position, q)) for q in (0.01, 0.99))
    slack = 0.5 * (limits[1] - limits[0])
    return low > limits[0] - slack and high < limits[1] + slack


def _fits(position: Array, machine: Machine, link: Linkage) -> bool:
    outside, used = _stand(position, machine, link)
    return outside < 0.5 * _IMPOSSIBLE and used > 0.005 and _in_range(position, machine, link)


def _explained(recording: Recording, machine: Machine, link: Linkage, key: str, factor: float) -> Explained:
    scaled = replace(recording, columns={**recording.columns, key: factor * recording[key]})
    columns = columns_of(scaled, machine, link)
    cylinder = machine.cylinder(link)
    return explained(columns, cylinder, machine.rig) if columns is not None else Explained(0.0, 0.0, 0, 0.0, 0.0)


def _reach(position: Array) -> float:
    """Return between how far ends a joint moves [m]."""
    low, high = (float(np.nanquantile(position, q)) for q in (0.01, 0.99))
    return high - low


def _best(
    fitting: Mapping[str, float], recording: Recording, machine: Machine, link: Linkage, key: str
) -> tuple[str, float, bool]:
    """Return the unit in which pressures follow the motion best, its factor and True; where they say nothing that of most travel, False."""
    shares = {unit: _explained(recording, machine, link, key, factor) for unit, factor in fitting.items()}
    likeliest = max(shares, key=lambda unit: shares[unit].share)
    best = shares[likeliest]
    others = [share.share for unit, share in shares.items() if unit != likeliest]
    if best.share > _EXPLAINED and best.worked > 0.1 and best.share > max(others, default=-1.0) + 0.2:
        return likeliest, fitting[likeliest], True
    unit = max(fitting, key=lambda unit: fitting[unit])
    return unit, fitting[unit], False


def _converted(recording: Recording, key: str, unit: str, factor: float) -> tuple[Recording, list[Check]]:
    columns, changed = dict(recording.columns), [key]
    before = columns[key]
    columns[key] = factor * before
    rate = f"{key.rsplit('.', 1)[0]}.velocity"
    if rate in columns and is_rate_of(columns[rate], before, recording.time):
        columns[rate] = factor * columns[rate]
        changed.append(rate)
    si = recording.units[key]
    reach = f"{float(np.nanmin(before)):.4g} to {float(np.nanmax(before)):.4g} {si}"
    says = f'"{key}" goes from {reach}, which this machine cannot; was it written in {unit}? Taken as {unit}'
    return replace(recording, columns=columns), [Check("unit", tuple(changed), says)]


def is_rate_of(velocity: Array, position: Array, time: Array) -> bool:
    """Return whether a velocity is that of a position as it stands: in the same unit."""
    stride = max(1, len(time) // 2000)
    moved = np.diff(position[::stride])
    summed = np.concatenate(([0.0], np.cumsum(np.nan_to_num(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time)))))
    way = np.diff(summed[::stride])
    good = np.isfinite(moved) & np.isfinite(way)
    moved, way = moved[good], way[good]
    size = float(moved @ moved)
    return size > 0.0 and 0.5 < float(way @ moved) / size < 2.0


def _unit_or_stroke(position: Array, machine: Machine, link: Linkage, key: str, units: tuple[str, ...]) -> Check:
    """Refuse a travel that is longer than the stroke where either of both may be wrong and no pressure tells which."""
    cylinder, rig = machine.cylinder(link), machine.rig
    says = (
        f'"{key}" moves by {1e3 * _reach(position):.4g} mm, the stroke of {link.cylinder} is {1e3 * cylinder.stroke:.4g} mm: either '
        f"stroke in cylinders.{link.cylinder} of {rig.path} is too short, or the column is in {' or '.join(units)} and its heading wrong; "
        "correct one of them"
    )
    return Check("stroke", (key,), says, refused=True)


def _refusal(position: Array, machine: Machine, link: Linkage, key: str) -> Check:
    """Return the refusal of a piston that is where none can be, with what would put it right."""
    cylinder, rig = machine.cylinder(link), machine.rig
    piston = machine.piston(link, position)
    low, high = (float(np.nanquantile(piston, q)) for q in (0.01, 0.99))
    length_low, length_high = low + cylinder.retracted_length, high + cylinder.retracted_length
    travel, stroke = high - low, cylinder.stroke
    where = f"cylinders.{link.cylinder} of {rig.path}"
    asks = (
        f'"{key}" puts the piston of {link.cylinder} at {1e3 * low:.4g} to {1e3 * high:.4g} mm, '
        f"outside its stroke of 0 to {1e3 * stroke:.4g} mm"
    )
    if travel > (1.0 + _IMPOSSIBLE) * stroke:
        cure = f"it moves by {1e3 * travel:.4g} mm: correct stroke in {where}, the gear of the actuator, or the column's unit"
    elif length_high <= 0.0:
        cure = "its length grows the wrong way: turn the sign of the column, of the joint's axis or of the actuator's gear"
    else:
        cure = (
            f"correct retracted_length in {where}, now {1e3 * cylinder.retracted_length:.4g} mm: "
            f"from {1e3 * (length_high - stroke):.4g} to {1e3 * length_low:.4g} mm would fit"
        )
    return Check("stroke", (key,), f"{asks}; {cure}", refused=True)
