"""The improved rig: effects switched on, nominal numbers corrected, curves for unknown effects.

Nuisance parameters that were refitted within what a data sheet allows, and imperfections that a healthy machine shows, are no findings,
but the reported errors are those with them: the file holds them too, as far as a rig can.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import partial
from pathlib import Path

import numpy as np

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.uncertainty import bounded_interval
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.nominal_numbers import ZERO
from exo_sim.diagnosis.outcome.rig_corrections import corrections
from exo_sim.diagnosis.outcome.sensor_entries import NO_FINDING, late_entries, sensor_entry, sensor_error_entry
from exo_sim.diagnosis.policy.off_nominal import LEAST_PART
from exo_sim.diagnosis.selection.nuisance_calibration import is_declared
from exo_sim.diagnosis.selection.sensor_zero import error_of, is_faulty
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import UnknownEffect, effect_of
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.declaration import declared
from exo_sim.physics.effects import sensor_bias
from exo_sim.physics.effects.unknown import ACTS, DEPENDS_ON
from exo_sim.physics.effects.unknown import EFFECT as UNKNOWN
from exo_sim.rig import Correction, EffectEntry, EffectSetting, Rig, improved
from exo_sim.signals import VALVE_COMMANDS

#: What stands above a rig that holds such numbers.
_HEADER = (
    '# Numbers marked "no finding" are within what a data sheet allows or a healthy machine shows. They can stay: they were fitted\n'
    "# together with what was found, and the errors that were reported are those with them.\n"
)

#: ... and where they were fitted once more.
_TOGETHER = (
    "# Numbers of the machine were then fitted once more together, each within the 95 % of its balance, to motion and gas at once.\n"
    "# The report gives them as the balances do.\n"
)

Result = SubsystemResult[SubsystemModel]


class Rank(IntEnum):
    """What an entry of an update is, in the order in which it is left out where it does not win.

    What was only refitted of the sensors is apart from what was of the machine: a filter before a card moves no piston.
    """

    CURVE = 0
    REFITTED = 1
    SENSORS = 2
    FOUND = 3


_CALLED = {
    Rank.CURVE: "the curve of what has no name",
    Rank.REFITTED: "numbers that were refitted and are no finding",
    Rank.SENSORS: "zeros and delays of sensors that were refitted and are no finding",
}


@dataclass(frozen=True)
class Part:
    """Entries and corrections of one rank that one source (a subsystem, or the sensors) gives."""

    source: str
    rank: Rank
    entries: tuple[EffectEntry, ...] = ()
    corrections: tuple[Correction, ...] = ()


@dataclass(frozen=True)
class RigUpdate:
    """What changes in a rig: effects, and corrections of nominal numbers.

    Attributes:
        rig: The rig as handed in.
        parts: What changes.
        is_fitted_together: Whether the numbers were fitted once more to the whole machine.
        unsayable: What was found and no rig file can hold.
    """

    rig: Rig
    parts: tuple[Part, ...]
    is_fitted_together: bool = False
    unsayable: tuple[EffectEntry, ...] = ()

    @property
    def holds_findings(self) -> bool:
        """Whether it holds more than numbers that were only refitted."""
        return any(part.rank in (Rank.FOUND, Rank.CURVE) for part in self.parts)

    @property
    def entries(self) -> tuple[EffectEntry, ...]:
        """The effects; a part of the machine holds each once."""
        every = [entry for part in self.parts for entry in part.entries]
        return tuple(reversed({(entry.setting.name, entry.setting.where): entry for entry in reversed(every)}.values()))

    @property
    def corrections(self) -> tuple[Correction, ...]:
        """The corrections of nominal numbers, each once: of what cylinders share, what the first of them says."""
        every = [one for part in self.parts for one in part.corrections]
        return tuple({one.key: one for one in reversed(every)}.values())[::-1]

    def reduced(self) -> tuple[RigUpdate, ...]:
        """Return the updates that have one rank less of one source.

        Its curve goes first, for it was fitted to what the rest leaves; what was found goes last. Numbers of the machine and of the
        sensors that were only refitted do without each other: a zero that the gas hardly shows may be worse for the forces alone.
        """
        gone: dict[str, list[Rank]] = {}
        for source in dict.fromkeys(part.source for part in self.parts):
            ranks = {one.rank for one in self.parts if one.source == source}
            either = sorted(ranks & {Rank.REFITTED, Rank.SENSORS})
            gone[source] = [Rank.CURVE] if Rank.CURVE in ranks else either or [Rank.FOUND]
        return tuple(
            replace(self, parts=tuple(part for part in self.parts if (part.source, part.rank) != (source, rank)))
            for source, ranks in gone.items()
            for rank in ranks
        )

    def with_parts_of(self, other: RigUpdate) -> RigUpdate:
        """Return the update with no more parts than another has that was made of the same."""
        kept = {(part.source, part.rank) for part in other.parts}
        return replace(self, parts=tuple(part for part in self.parts if (part.source, part.rank) in kept))

    def found_alone(self) -> tuple[RigUpdate, ...]:
        """Return the updates with nothing but what was found: by all sources, and by each where there are several; those that hold less."""
        found = tuple(part for part in self.parts if part.rank is Rank.FOUND)
        fewer = (found, *((part,) for part in found)) if len(found) > 1 else (found,)
        return tuple(replace(self, parts=parts) for parts in fewer if parts and parts != self.parts)

    def without(self, kept: RigUpdate) -> str:
        """Return in words what this update has and another, which was made of it by leaving something out, has not."""
        said = []
        for part in self.parts:
            if part not in kept.parts:
                names = [*(entry.setting.name for entry in part.entries), *(" ".join(one.key[2:]) for one in part.corrections)]
                found = ", ".join(dict.fromkeys(map(wording.name_of, names)))
                what = found if part.rank is Rank.FOUND else _CALLED[part.rank]
                said.append(f"{what} ({part.source})")
        return "; ".join(said)

    def text(self, folder: Path) -> str:
        """Return the text of `improved.toml` for a folder."""
        text = improved(self.rig, list(self.entries), list(self.corrections), folder)
        refitted = any(part.rank in (Rank.REFITTED, Rank.SENSORS) for part in self.parts)
        header = (_HEADER if refitted else "") + (_TOGETHER if self.is_fitted_together and self.parts else "")
        return text if text.startswith(header) else f"{header}{text}"


def rig_update(data: MachineData, results: Sequence[Result], unknown: Sequence[UnknownEffect]) -> RigUpdate:
    """Return what was found as an update of the rig."""
    calibrated = {one.where for one in results if one.model.calibrates_pressures and not one.is_empty}
    parts: list[Part] = []
    unsayable: list[EffectEntry] = []
    for one in results:
        source = f"{one.model.kind} of {one.name}"
        reported = {finding.at: finding for finding in one.findings}
        entries = [
            _entry(c, one, each, data.rig) for c in one.named if c.at in reported for each in reported[c.at].at_each_place()
        ]
        corrected = corrections(data, one)
        findings = tuple(each for each in corrected if not each.note)
        sayable = tuple(_sayable(data.rig, one, entries))
        unsayable += [entry for entry in entries if entry not in sayable]
        parts.append(Part(source, Rank.FOUND, sayable, findings))
        refitted = tuple(each for each in corrected if each.note)
        healthy = _sayable(data.rig, one, _healthy(data.rig, one, calibrated))
        zeros = tuple(entry for entry in healthy if declared()[entry.setting.name].cut == "sensor")
        parts.append(Part(source, Rank.REFITTED, tuple(entry for entry in healthy if entry not in zeros), refitted))
        parts.append(Part(source, Rank.SENSORS, (*zeros, *late_entries(data, one, calibrated))))
        effect = effect_of(unknown, one)
        parts.append(Part(source, Rank.CURVE, tuple(_sayable(data.rig, one, _curves(data.rig, [effect] if effect else [])))))
    apart = [effect for effect in unknown if all(one.key != effect.result.key for one in results)]
    parts.append(Part("elsewhere", Rank.CURVE, tuple(_curves(data.rig, apart))))
    faults = [
        sensor_entry(found, data.rig)
        for found in data.sensors
        if is_declared(found.name) and found.parameters and found.where.rsplit(".", 1)[-1] not in VALVE_COMMANDS
    ]
    parts.append(Part("sensors", Rank.FOUND, tuple(faults)))
    kept = tuple(part for part in map(partial(_not_said_twice, parts), parts) if part.entries or part.corrections)
    return RigUpdate(data.rig, kept, unsayable=tuple(unsayable))


def _not_said_twice(parts: Sequence[Part], part: Part) -> Part:
    """Return a part of an update without what a healthy machine shows and a finding at the same place says as well."""
    found = [entry.setting for one in parts if one.rank is Rank.FOUND for entry in one.entries]
    said = {(poorer, setting.where) for setting in found for poorer, _ in declared()[setting.name].absorbs}
    kept = tuple(entry for entry in part.entries if (entry.setting.name, entry.setting.where) not in said)
    return part if part.rank is Rank.FOUND else replace(part, entries=kept)


def _sayable(rig: Rig, result: Result, entries: Sequence[EffectEntry]) -> list[EffectEntry]:
    """Return the entries that a rig file can hold: none of a joint with the name of a cylinder, for what stands there is the cylinder's."""
    taken = result.model.is_of_joint and result.where in rig.cylinders
    return [entry for entry in entries if not taken or entry.setting.where != result.where]


def _entry(candidate: Candidate, result: Result, finding: Finding, rig: Rig) -> EffectEntry:
    if candidate.kind is Kind.SENSOR:
        return sensor_entry(finding, rig)
    values = {parameter.parameter: result.final.fit.values[parameter] for parameter in candidate.parameters}
    values |= {parameter.parameter: value for parameter, value in candidate.fixed if parameter.effect == candidate.effect}
    values = {**_healthy_part(candidate, result), **values}
    turning = _turns(parameter.unit for parameter in candidate.parameters)
    intervals = {name: (e.low, e.high) for name, e in finding.parameters.items()}
    for name, less in _said_of_the_joint(candidate, result, rig).items():
        values[name] = max(values[name] - less, 0.0)
        intervals[name] = tuple(max(end - less, 0.0) for end in intervals[name])  # type: ignore[assignment]
    return EffectEntry(EffectSetting(candidate.effect, candidate.where, values, turning), intervals, wording.says(candidate.effect))


def _said_of_the_joint(candidate: Candidate, result: Result, rig: Rig) -> dict[str, float]:
    """Return by how much less of an effect a piston has than was found, for its joint keeps what the rig says there of the poorer form."""
    held = dict[str, float]()
    for poorer, shares in declared()[candidate.effect].absorbs:
        if any(q.effect == poorer for q, _ in candidate.fixed):
            own = rig.effect(poorer, candidate.where)
            for mine, its in shares:
                whole = float(result.model.nominal.cylinder[poorer][its][0])
                held[mine] = whole - (own.parameters.get(its, 0.0) if own else 0.0)
    return held


def _healthy_part(candidate: Candidate, result: Result) -> dict[str, float]:
    """Return the other parameters of an additive effect: what a healthy machine has of them was fitted as a nuisance."""
    if not candidate.additive:
        return {}
    unit = candidate.parameters[0].unit
    own = {q: value for q, value in result.final.fit.values.items() if (q.effect, q.where, q.unit) == (*candidate.at, unit)}
    least = LEAST_PART * sum(own.values())
    return {q.parameter: value for q, value in own.items() if q not in candidate.parameters and value > least}


def _healthy(rig: Rig, result: Result, calibrated: Collection[str]) -> list[EffectEntry]:
    """Return the entries of what was refitted and no number of the rig holds: zeros of sensors, imperfections of healthy machines.

    Where the pressures of a cylinder were `calibrated` by its gas, its forces say nothing of their zeros. A scale only the forces know.
    """
    parts: dict[tuple[str, str], dict[FreeParameter, float]] = {}
    entries, faulty = [], set[str]()
    for parameter, error in result.refitted:
        by_force = result.model.as_sensor_error(parameter, result.final.fit.values[parameter])
        if by_force is not None:
            column, name = by_force[:2]
            if not ("pressure" in column and name == sensor_bias.EFFECT.name and column.split(".")[0] in calibrated):
                entries.append(sensor_error_entry(*by_force, error, rig, result.model.unit))
        elif parameter.effect == ZERO:
            parts.setdefault((sensor_bias.EFFECT.name, parameter.where), {})[parameter] = error_of(result, parameter, error)
            if is_faulty(result, parameter, error):
                faulty.add(parameter.where)
        elif is_declared(parameter.effect) and rig.effect(*parameter.key[:2]) is None and parameter.target is not Target.SENSOR:
            parts.setdefault((parameter.effect, parameter.where), {})[parameter] = error
    for (name, where), errors in parts.items():
        values = result.final.fit.values
        estimates = {
            "value" if name == sensor_bias.EFFECT.name else q.parameter: Estimate(values[q], q.unit, *bounded_interval(q, values[q], error))
            for q, error in errors.items()
        }
        if name == sensor_bias.EFFECT.name:
            says = wording.says(name) if where in faulty else NO_FINDING
            entries.append(sensor_entry(Finding(name, where, Kind.CALIBRATION, says, estimates, 0.0, 0.0), rig))
        else:
            intervals = {parameter: (e.low, e.high) for parameter, e in estimates.items()}
            setting = EffectSetting(name, where, {p: e.value for p, e in estimates.items()}, _turns(e.unit for e in estimates.values()))
            entries.append(EffectEntry(setting, intervals, NO_FINDING))
    return entries


def _turns(units: Iterable[str]) -> bool:
    return any("rad" in unit or unit == "N*m" for unit in units)


def _curves(rig: Rig, unknown: Iterable[UnknownEffect]) -> list[EffectEntry]:
    """Return the entries of unknown effects whose curve the simulator can follow, and of which it is known whether they are a force."""
    entries = []
    for effect in unknown:
        best, acts, where = effect.discrepancy.best, effect.discrepancy.acts, effect.result.where
        if best is None or best.variable not in DEPENDS_ON or not effect.is_told_apart:
            continue
        numbers = {"acts": float(ACTS.index(acts)), "depends_on": float(DEPENDS_ON.index(best.variable))}
        gauge = best.variable in ("pressure_1", "pressure_2") and acts == "force"
        shift = rig.environment.pressure if gauge else 0.0
        curves = {"at": tuple(float(v) + shift for v in best.at), "values": tuple(float(v) for v in best.values)}
        turning = effect.discrepancy.unit == "N*m" and where not in rig.cylinders
        entries.append(EffectEntry(EffectSetting(UNKNOWN.name, where, numbers, turning, curves), {}, effect.finding.says))
    return entries


def curve_of(rig: Rig, where: str) -> Curve | None:
    """Return the force that a rig's unknown effect exerts at a part, as a curve over what the balance of forces knows; None without one."""
    effect = rig.effect(UNKNOWN.name, where)
    if effect is None or ACTS[round(effect.parameters["acts"])] != "force":
        return None
    variable = DEPENDS_ON[round(effect.parameters["depends_on"])]
    gauge = rig.environment.pressure if variable in ("pressure_1", "pressure_2") else 0.0
    at, values = (np.asarray(effect.curves[name], dtype=float) for name in ("at", "values"))
    return Curve(variable, at - gauge, values, np.zeros_like(values), 1.0)
