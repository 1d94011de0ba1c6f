"""What was found, put into the rig file: effects switched on, believed numbers corrected, curves for what has no name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.intervals import bounds, spreads
from exo_sim.diagnosis.judging import Judged
from exo_sim.diagnosis.quantity import Candidate, Quantity
from exo_sim.diagnosis.verdict import Unnamed
from exo_sim.physics.effects.declaration import declared
from exo_sim.physics.effects.unknown import ACTS, DEPENDS_ON
from exo_sim.rig import Correction, EffectSetting, improved
from exo_sim.rig import Finding as Entry


def improved_text(case: Case, judged: Sequence[Judged], nameless: Sequence[Unnamed], folder: Path) -> str:
    """Return the text of `improved.toml` for `folder`."""
    entries, corrections = [], []
    for one in judged:
        kept = {(finding.name, finding.where) for finding in one.findings}
        spread = (
            spreads(one.problem, one.trial.fit, one.search.correlation_time(one.trial.fit.residual))
            if not one.empty
            else {}
        )
        entries += [_entry(c, one, spread) for c in one.named if (c.effect, c.where) in kept]
        corrections += [_correction(case, *numbers) for numbers in one.calibrations]
    for found in case.sensors:
        if found.name in declared() and found.parameters and not found.where.endswith(".valve_command"):
            setting = EffectSetting(found.name, found.where, {name: e.value for name, e in found.parameters.items()})
            entries.append(Entry(setting, {name: (e.low, e.high) for name, e in found.parameters.items()}, found.says))
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


def _entry(candidate: Candidate, judged: Judged, spread: dict[Quantity, float]) -> Entry:
    values, intervals = {}, {}
    turning = False
    for quantity in candidate.quantities:
        value = judged.trial.fit.values[quantity]
        name = quantity.parameter
        if quantity.target == "sensor":
            name = {"bias": "value", "scale": "factor", "delay": "seconds"}[quantity.parameter.rsplit(".", 1)[-1]]
        values[name] = value
        intervals[name] = bounds(quantity, value, spread.get(quantity, 0.0))
        turning = turning or "rad" in quantity.unit or quantity.unit == "N*m"
    for quantity, value in candidate.fixed:
        values[quantity.parameter] = value
    return Entry(
        EffectSetting(candidate.effect, candidate.where, values, turning), intervals, wording.says(candidate.effect)
    )


def _correction(case: Case, quantity: Quantity, factor: float, error: float) -> Correction:
    low, high = bounds(quantity, factor, error)
    if quantity.effect == "payload_mass":
        model = case.model
        body = int(model.jnt_bodyid[model.joint(quantity.where).id])
        whole, own = float(model.body_subtreemass[body]), float(model.body_mass[body])

        def mass(share: float) -> float:
            return max(share * whole - (whole - own), 1e-6)

        key: tuple[str, ...] = ("bodies", model.body(body).name, "mass")
        return Correction(key, mass(factor), "kg", (mass(low), mass(high)), own)
    if quantity.effect == "joint_damping":
        believed = case.rig.damping_factors.get(quantity.where, 1.0)
        low, factor, high = (max(number, 1e-3) * believed for number in (low, factor, high))
        return Correction(("joints", quantity.where, "damping_factor"), factor, "1", (low, high), believed)
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
