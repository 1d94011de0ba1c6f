"""A sizing in numbers and words: what `exo-sim size` prints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from exo_sim.physics.compressed_air import exergy, free_air
from exo_sim.simulation import gas_use
from exo_sim.sizing import published_machine
from exo_sim.sizing.bought_parts import BoughtParts, provenance, too_cold
from exo_sim.sizing.design import fit, recovery_mass, spring_mass
from exo_sim.sizing.force_bandwidth import NEEDED
from exo_sim.sizing.hand_calculation import Step
from exo_sim.sizing.joint_kinds import JointKind
from exo_sim.sizing.loads import JointLoads
from exo_sim.sizing.recommendation import fates
from exo_sim.sizing.search import Found
from exo_sim.sizing.sensitivity import cheaper
from exo_sim.sizing.study import Sizing

SCHEMA = "exo-sim/size/1"


def entry(kinds: tuple[JointKind, ...], found: Found) -> dict[str, Any]:
    """Return one design as the contract has it; what differs by joint is a table by kind of joint."""
    design, score = found.design, found.score
    joints = {kind.name: design.joints[kind.name] for kind in kinds}
    places = {kind.name: fit(kind, design.joints[kind.name]) for kind in kinds}
    return {
        "bore_mm": {name: _mm(one.cylinder.bore) for name, one in joints.items()},
        "rod_mm": {name: _mm(one.cylinder.rod) for name, one in joints.items()},
        "stroke_mm": {name: _mm(place.stroke or 0.0) for name, place in places.items()},
        "supply_pa": design.supply,
        "part": {name: one.cylinder.standard for name, one in joints.items()},
        "valve": {name: one.valve.name for name, one in joints.items() if one.valve is not None},
        "valve_area_mm2": {name: round(1e6 * one.valve_area, 3) for name, one in joints.items()},
        "spring": {
            name: {
                "stiffness_n_per_m": one.spring[0],
                "rest_mm": _mm(one.spring[1]),
                "mass_kg": spring_mass(one.spring, places[name].stroke or 0.0),
            }
            for name, one in joints.items()
            if one.spring is not None
        },
        "attachment_mm": {
            name: {"from": [_mm(value) for value in one.attachment.base], "to": [_mm(value) for value in one.attachment.rod]}
            for name, one in joints.items()
        },
        "recovery_pa": None if design.recovery is None else design.recovery.pressure,
        "torque_margin": score.margin,
        "gas_kg_per_stride": score.gas,
        "gas_kg_per_stride_most": score.most_gas,
        "free_air_l_per_stride": 1e3 * free_air(score.gas),
        "exergy_j_per_stride": score.gas * exergy(design.supply),
        "actuator_mass_kg": score.mass,
        "torque_error_rms_nm": score.error,
        "design": design.number,
    }


def numbers(sizing: Sizing, folder: Path) -> dict[str, Any]:
    """Return the JSON object."""
    kinds = sizing.task.space.kinds
    return {
        "schema": SCHEMA,
        "evaluated": len(sizing.outcome.trials),
        "simulated": sum(one.score.simulated for one in sizing.outcome.trials),
        "new": sizing.outcome.new,
        "pareto": [entry(kinds, one) for one in sizing.outcome.front],
        "chosen": folder / "sized.toml",
        "recommended": entry(kinds, sizing.choice.found),
        "why": sizing.choice.why,
        "finer": {"gas_kg_per_stride": sizing.fine.gas, "torque_error_rms_nm": sizing.fine.error},
        "fates": {what: len(found) for what, found in fates(sizing.outcome, sizing.task)},
        "designs_by_fate": {what: list(found) for what, found in fates(sizing.outcome, sizing.task)},
        "walked": [
            {"design": one.number, "torque_error_rms_nm": _finite(one.error), "pressure_peak_pa": _finite(one.peak),
             "pressure_limit_pa": one.limit, "trouble": one.trouble or None, "fails": one.fails or None, "condition": one.condition}
            for one in sizing.choice.walked
        ],
        "loads": [load_numbers(one) for one in sizing.loads],
        "closed_loop": sizing.choice.confirmed.summary or None,
        "gas": sizing.choice.confirmed.summary.get("gas"),
        "trouble": sizing.choice.confirmed.trouble or None,
        "without": [
            {"what": one.what, "recommended": entry(kinds, one.choice.found), "same_design": {
                "torque_margin": one.same.margin, "gas_kg_per_stride": one.same.gas, "torque_error_rms_nm": one.same.error}}
            for one in sizing.without
        ],
        "conditions": [
            {"condition": str(one.condition), "gas_kg_per_stride": _finite(one.gas), "torque_error_rms_nm": _finite(one.error),
             "pressure_peak_pa": _finite(one.peak), "trouble": one.trouble or None}
            for one in sizing.choice.everywhere
        ],
        "requirements": [one.__dict__ for one in sizing.sensitivity.requirements],
        "neighbours": [
            {"what": one.what, "fails": one.fails or None, "torque_margin": one.score.margin, "gas_kg_per_stride": one.score.gas,
             "actuator_mass_kg": one.score.mass, "torque_error_rms_nm": one.score.error, "simulated": one.score.finished}
            for one in sizing.sensitivity.neighbours
        ],
        "relaxed": [
            {"requirement": one.requirement, "needs": one.needs, "design": entry(kinds, one.found)} for one in sizing.sensitivity.relaxed
        ],
        "parts": {one.name: one.numbers() for one in parts(sizing)},
        "bandwidths": [one.__dict__ for one in sizing.bandwidths],
        "beside": spent(sizing),
        "not_sized": [one.__dict__ for one in sizing.others],
        "ankle_motor": None if sizing.motor is None else sizing.motor.__dict__,
        "rods": [{**one.__dict__, "buckling": _finite(one.buckling)} for one in sizing.rods],
        "published_class": None if sizing.published is None else sizing.published.__dict__,
        "report": folder / "report.html",
        "recording": None if sizing.choice.confirmed.walk is None else folder / "sized.rrd",
    }  # fmt: skip


def load_numbers(loads: JointLoads) -> dict[str, Any]:
    """Return the range of each right joint's torque, and of the recorded moments beside it [N m]."""
    out: dict[str, Any] = {"condition": str(loads.condition), "mass_kg": loads.mass, "torque_nm": {}, "human_scaled_nm": {}}
    for joint in ("hip_r", "knee_r", "ankle_r"):
        out["torque_nm"][joint] = _range(loads.column(joint)[2])
        if loads.human_scaled is not None:
            at = ("hip_l", "knee_l", "ankle_l", "hip_r", "knee_r", "ankle_r").index(joint)
            out["human_scaled_nm"][joint] = _range(loads.human_scaled[:, at])
    return out


def words(sizing: Sizing, folder: Path) -> str:
    """Return the result for people."""
    kinds, chosen = sizing.task.space.kinds, sizing.choice.found
    trials = sizing.outcome.trials
    lines = [
        f"{len(trials)} designs, {sum(one.score.simulated for one in trials)} of them simulated, "
        f"{len(sizing.outcome.front)} on the Pareto front",
        "",
        *described(kinds, chosen),
        *(one.words for one in sizing.others),
        "",
        f"Why: {sizing.choice.why}.",
    ]
    for one in sizing.without:
        there = one.choice.found
        bores = ", ".join(f"{kind.name} {_mm(there.design.joints[kind.name].cylinder.bore):g} mm" for kind in kinds)
        lines.append(
            f"Without {one.what} the same design would have {100 * one.same.margin:.0f} % margin and draw {1e3 * one.same.gas:.2f} g; "
            f"the choice would be {bores} at {there.design.supply / 1e5:.1f} bar, {1e3 * there.score.gas:.2f} g, "
            f"{there.score.mass:.1f} kg, {100 * there.score.margin:.0f} % margin."
        )
    confirmed = sizing.choice.confirmed
    if confirmed.walk is not None:
        joints = confirmed.summary["joints"]
        peaks = ", ".join(f"{kind.name} {joints[kind.joints[-1]]['torque_peak_nm']:.0f}" for kind in kinds)
        straps = confirmed.summary["strap_load_n"]
        lines.append(
            f"Walked with it in closed loop ({confirmed.summary['scenario']}): peak torques {peaks} N m; "
            f"torso straps {straps['torso_rms']:.0f} N rms."
        )
        lines += gas_use.words(confirmed.summary["gas"])
        lines += [*spent(sizing), *changes(sizing), *rods(sizing), *bought(sizing)]
    else:
        lines.append(f"It could not be walked with in closed loop: {confirmed.trouble}")
    lines.append(f"{folder / 'sized.toml'}, {folder / 'report.html'}" + (f", {folder / 'sized.rrd'}" if confirmed.walk is not None else ""))
    return "\n".join(lines)


def changes(sizing: Sizing) -> list[str]:
    """Return what would change the recommendation, in lines of text."""
    tight = sizing.sensitivity.requirements[0]
    required = "" if tight.asked == "none" else f" ({tight.asked} required)"
    lines = [f"Tightest requirement: {tight.name}, {tight.has}{required}."]
    for one in sizing.sensitivity.relaxed:
        score = one.found.score
        lines.append(
            f"With {one.requirement} of {one.needs} design {one.found.design.number} would do: {1e3 * score.gas:.2f} g, "
            f"{score.mass:.1f} kg."
        )
    better = [one for one in sizing.sensitivity.neighbours if cheaper(one, sizing.choice.found.score)]
    for step in better:
        said = f"fails {step.fails}" if step.fails else "keeps all requirements of the search"
        lines.append(f"One step cheaper: {step.what}: {1e3 * step.score.gas:.2f} g, {step.score.mass:.1f} kg; {said}.")
    return lines


def parts(sizing: Sizing) -> tuple[BoughtParts, ...]:
    """Return what is to be bought for the recommended design."""
    joints = sizing.choice.found.design.joints
    return tuple(BoughtParts(kind.name, joints[kind.name].cylinder, joints[kind.name].valve) for kind in sizing.task.space.kinds)


def bought(sizing: Sizing) -> list[str]:
    """Return where the figures of the recommended parts come from, which are estimates, and which gets too cold, in lines of text."""
    walk, least = sizing.choice.confirmed.walk, {}
    if walk is not None:
        for kind in sizing.task.space.kinds:
            least[kind.name] = min(float(walk.columns[f"{name}.temperature_{side}"].min()) for name in kind.cylinders for side in (1, 2))
    return [*provenance(parts(sizing)), *too_cold(parts(sizing), least)]


def rods(sizing: Sizing) -> list[str]:
    """Return what the walk asks of the rods, of both sides the worse, and the loads of the ankles' motors, in lines of text."""
    lines = []
    for kind in sizing.task.space.kinds:
        found = [one for one in sizing.rods if one.name in kind.cylinders]
        if not found:
            continue
        worst, side = min(found, key=lambda one: one.buckling), [one.side for one in found if one.side is not None]
        safety = f"buckles at {worst.buckling:.0f} times its push of {worst.push:.0f} N" if np.isfinite(worst.buckling) else "only pulls"
        across = f"; at most {max(side):.0f} N across it by the cylinder's own weight and inertia" if side else ""
        lines.append(f"{kind.name} rod: {safety}{across}; piston up to {max(one.speed for one in found):.2f} m/s.")
        lines += [
            f"{kind.name} force: ±{one.amplitude:.0f} N followed up to {one.words}; {100 * NEEDED:.0f} % of the demand lies below "
            f"{one.needed:.1f} Hz."
            for one in sizing.bandwidths
            if one.name in kind.cylinders
        ]
    return lines if sizing.motor is None else [*lines, sizing.motor.words + "."]


def spent(sizing: Sizing) -> list[str]:
    """Return what the published machine of this class and the wearer spend, in lines of text; none where nobody walks on level ground."""
    summary = sizing.choice.confirmed.summary
    return published_machine.power_words(summary) if sizing.published is not None and summary else []


def described(kinds: tuple[JointKind, ...], found: Found) -> list[str]:
    """Return a design in lines of text."""
    one = entry(kinds, found)
    lines = [f"supply {one['supply_pa'] / 1e5:.1f} bar, absolute"]
    if (tank := found.design.recovery) is not None:
        weight = recovery_mass(kinds, found.design)
        lines[0] += f"; recovery tank {1e3 * tank.volume:g} l at {tank.pressure / 1e5:.1f} bar, {weight:.1f} kg with its valves"
    for kind in kinds:
        name = kind.name
        points = one["attachment_mm"][name]
        lines.append(
            f"{name}: {one['part'][name]}, "
            f"bore {one['bore_mm'][name]:g}, rod {one['rod_mm'][name]:g}, stroke {one['stroke_mm'][name]:g} mm; "
            f"{one['valve'].get(name, 'valve')} "
            f"{one['valve_area_mm2'][name]:.1f} mm^2; from {points['from']} to {points['to']} mm; margin "
            f"{100 * found.score.by_joint[name]:.0f} %"
            + (
                f"; spring beside the rod {one['spring'][name]['stiffness_n_per_m'] / 1e3:.1f} N/mm, slack at "
                f"{one['spring'][name]['rest_mm']:.0f} mm, {one['spring'][name]['mass_kg']:.1f} kg"
                if name in one["spring"]
                else ""
            )
        )
    lines.append(
        f"gas {1e3 * found.score.gas:.2f} g a cycle, actuators {found.score.mass:.2f} kg, torque error {found.score.error:.2f} N m rms"
    )
    return lines


def by_hand_words(example: list[Step], joints: dict[str, list[Step]]) -> str:
    """Return the hand calculation for people."""
    lines = ["One horsepower from 250 psi above the atmosphere (equation 39):"]
    lines += [_line(step) for step in example]
    for name, steps in joints.items():
        lines += ["", f"{name}:", *[_line(step) for step in steps]]
    return "\n".join(lines)


def by_hand_numbers(example: list[Step], joints: dict[str, list[Step]]) -> dict[str, Any]:
    """Return the hand calculation as the JSON object."""
    quick = {"example": [step.__dict__ for step in example]}
    return {
        "schema": SCHEMA, "evaluated": 0, "pareto": [], "chosen": None,
        "by_hand": {**quick, "joints": {name: [step.__dict__ for step in steps] for name, steps in joints.items()}},
    }  # fmt: skip


def _line(step: Step) -> str:
    return f"  {step.what:58} {step.value:10.4g} {step.unit:7} {step.source}"


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _mm(value: float) -> float:
    return round(1e3 * value, 4)


def _range(values: np.ndarray) -> list[float]:
    return [float(values.min()), float(values.max())]
