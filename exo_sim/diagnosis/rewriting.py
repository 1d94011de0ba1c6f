"""What was found, put into the rig file: effects switched on, believed numbers corrected, curves for what has no name.

Numbers that were refitted within what a data sheet allows, and what a healthy machine shows, are no findings, but the errors that are
told are those with them: so the file holds them too, as far as a rig can.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.calibrations import MODEL_SHARE, known
from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.intervals import bounds, ends
from exo_sim.diagnosis.judging import Judged
from exo_sim.diagnosis.quantity import Candidate, Quantity
from exo_sim.diagnosis.result import Estimate, Finding
from exo_sim.diagnosis.verdict import Unnamed
from exo_sim.physics.effects.declaration import declared
from exo_sim.physics.effects.unknown import ACTS, DEPENDS_ON
from exo_sim.rig import Correction, EffectSetting, JointFactors, Rig, improved
from exo_sim.rig import Finding as Entry

#: Numbers of the rig that every comparison refits.
REFITTED = ("flow_capacity", "dead_volume", "payload_mass")
#: Less than this share of what adds up to one thing is not written.
LEAST_PART = 0.05
_NO_FINDING = "No finding: a healthy machine shows as much; it is in the errors that were told."
_REFITTED_NOTE = "refitted within what a data sheet allows, no finding"


def improved_text(case: Case, judged: Sequence[Judged], nameless: Sequence[Unnamed], folder: Path) -> str:
    """Return the text of `improved.toml` for `folder`."""
    entries, corrections = [], []
    for one in judged:
        told = {(finding.name, finding.where): finding for finding in one.findings}
        entries += [_entry(c, one, told[c.effect, c.where], case.rig) for c in one.named if (c.effect, c.where) in told]
        corrections += [_correction(case, *numbers) for numbers in one.calibrations if _is_the_rigs(case.rig, numbers[0])]
        corrections += _refitted(case, one)
        entries += _healthy(case.rig, one)
    for found in case.sensors:
        if found.name in declared() and found.parameters and not found.where.endswith(".valve_command"):
            entries.append(_sensor_entry(found, case.rig))
    for unnamed in nameless:
        best = unnamed.nameless.best
        if best is not None and best.variable in DEPENDS_ON:
            numbers = {
                "acts": float(ACTS.index(unnamed.nameless.acts)),
                "depends_on": float(DEPENDS_ON.index(best.variable)),
            }
            shift = (
                case.rig.environment.pressure
                if best.variable in ("pressure_1", "pressure_2") and unnamed.nameless.acts == "force"
                else 0.0
            )
            curves = {"at": tuple(float(v) + shift for v in best.at), "values": tuple(float(v) for v in best.values)}
            turning = unnamed.nameless.unit == "N*m" and unnamed.judged.where not in case.rig.cylinders
            entries.append(
                Entry(
                    EffectSetting("unknown", unnamed.judged.where, numbers, turning, curves), {}, unnamed.finding.says
                )
            )
    once = {
        (entry.setting.name, entry.setting.where): entry for entry in reversed(entries)
    }  # a part holds an effect once
    return improved(case.rig, list(reversed(once.values())), corrections, folder)


def _entry(candidate: Candidate, judged: Judged, finding: Finding, rig: Rig) -> Entry:
    if candidate.kind == "sensor":
        return _sensor_entry(finding, rig)
    values = {quantity.parameter: judged.trial.fit.values[quantity] for quantity in candidate.quantities}
    values |= {quantity.parameter: value for quantity, value in candidate.fixed}
    values = {**_healthy_part(candidate, judged), **values}
    turning = any("rad" in quantity.unit or quantity.unit == "N*m" for quantity in candidate.quantities)
    intervals = {name: (e.low, e.high) for name, e in finding.parameters.items()}
    return Entry(EffectSetting(candidate.effect, candidate.where, values, turning), intervals, wording.says(candidate.effect))


def _healthy_part(candidate: Candidate, judged: Judged) -> dict[str, float]:
    """Return the other numbers of what adds up to one thing: what a healthy machine has of them was taken off before the rest was told."""
    if not candidate.adds_up:
        return {}
    own = {q: value for q, value in judged.trial.fit.values.items() if (q.effect, q.where) == (candidate.effect, candidate.where)}
    least = LEAST_PART * sum(own.values())
    return {q.parameter: value for q, value in own.items() if q not in candidate.quantities and value > least}


def _healthy(rig: Rig, judged: Judged) -> list[Entry]:
    """Return the entries of what was refitted and no number of the rig holds: zeros of sensors, and what a healthy machine shows."""
    parts: dict[tuple[str, str], dict[Quantity, float]] = {}
    for quantity, error in judged.refitted:
        if quantity.effect == "sensor_zero":
            parts.setdefault(("sensor_bias", quantity.where), {})[quantity] = error
        elif known(quantity.effect) and rig.effect(quantity.effect, quantity.where) is None and quantity.prior and not quantity.prior[0]:
            parts.setdefault((quantity.effect, quantity.where), {})[quantity] = error
    entries = []
    for (name, where), errors in parts.items():
        values = judged.trial.fit.values
        estimates = {
            "value" if name == "sensor_bias" else q.parameter: Estimate(values[q], q.unit, *bounds(q, values[q], error))
            for q, error in errors.items()
        }
        small = Finding(name, where, "calibration", _NO_FINDING, estimates, 0.0, 0.0)
        if name == "sensor_bias":
            entries.append(_sensor_entry(small, rig))
        else:
            intervals = {parameter: (e.low, e.high) for parameter, e in estimates.items()}
            entries.append(Entry(EffectSetting(name, where, {p: e.value for p, e in estimates.items()}), intervals, _NO_FINDING))
    return entries


def _refitted(case: Case, judged: Judged) -> list[Correction]:
    """Return the corrections of numbers that were refitted, of those that the rig holds."""
    values, found = judged.trial.fit.values, []
    for quantity, error in judged.refitted:
        alone = quantity.effect == "inertia" and case.model.nv == 1  # else what the others take of it is in the same number
        whole = quantity.prior[0] if quantity.prior else 0.0
        if whole and (alone or quantity.effect in REFITTED or (known(quantity.effect) and _is_the_rigs(case.rig, quantity))):
            made = _correction(case, quantity, values[quantity] / whole, error / abs(whole))
            found.append(replace(made, interval=None, note=_REFITTED_NOTE))
    return found


def _sensor_entry(finding: Finding, rig: Rig) -> Entry:
    """Return what the rig must say of a sensor: what it knew was taken off before anything was found, so both count."""
    known = rig.effect(finding.name, finding.where)
    scale = rig.effect("sensor_scale", finding.where)
    turning = any("rad" in e.unit or e.unit == "N*m" for e in finding.parameters.values())

    def both(name: str, found: float) -> float:
        before = known.parameters.get(name, 0.0) if known else 0.0
        if finding.name == "sensor_scale":
            return (before or 1.0) * found
        return before + found * (scale.parameters["factor"] if scale and finding.name == "sensor_bias" else 1.0)

    values = {name: both(name, e.value) for name, e in finding.parameters.items()}
    intervals = {name: (both(name, e.low), both(name, e.high)) for name, e in finding.parameters.items()}
    return Entry(EffectSetting(finding.name, finding.where, values, turning), intervals, finding.says)


def _is_the_rigs(rig: Rig, quantity: Quantity) -> bool:
    """Say whether the rig file holds the number where it was judged; what a joint shares with its piston it does not."""
    return not known(quantity.effect) or rig.effect(quantity.effect, quantity.where) is not None


def _correction(case: Case, quantity: Quantity, factor: float, error: float) -> Correction:
    if quantity.prior and known(quantity.effect):
        believed = quantity.prior[0]
        low, high = ends(factor, max(error, MODEL_SHARE))
        path = ("effects", quantity.effect, quantity.where, quantity.parameter)
        return Correction(path, believed * factor, quantity.unit, (believed * low, believed * high))
    low, high = bounds(quantity, factor, max(error, MODEL_SHARE))
    if quantity.effect == "payload_mass":
        model = case.model
        body = int(model.jnt_bodyid[model.joint(quantity.where).id])
        whole, own = float(model.body_subtreemass[body]), float(model.body_mass[body])

        def mass(share: float) -> float:
            return max(share * whole - (whole - own), 1e-6)

        key: tuple[str, ...] = ("bodies", model.body(body).name, "mass")
        return Correction(key, mass(factor), "kg", (mass(low), mass(high)), own)
    if quantity.effect in ("joint_damping", "inertia"):
        held = case.rig.joint_factors.get(quantity.where, JointFactors())
        name, believed = ("inertia_factor", held.inertia) if quantity.effect == "inertia" else ("damping_factor", held.damping)
        low, factor, high = (max(number, 1e-3) * believed for number in (low, factor, high))
        return Correction(("joints", quantity.where, name), factor, "1", (low, high), believed)
    cylinder = case.rig.cylinders[quantity.where]
    if quantity.parameter == "valve_area":
        key, believed, unit = ("cylinders", quantity.where, "valve", "area"), cylinder.valve_area, "m^2"
    else:
        key, believed, unit = (
            ("cylinders", quantity.where, quantity.parameter),
            getattr(cylinder, quantity.parameter),
            "m^3",
        )
    return Correction(key, believed * factor, unit, (believed * low, believed * high), believed)
