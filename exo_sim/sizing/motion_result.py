"""What a sizing along a motion came to: the rig file, the JSON, the words."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exo_sim.errors import ScenarioError
from exo_sim.outputs import replacing
from exo_sim.rig import Correction, EffectEntry, EffectSetting, Rig, improved
from exo_sim.sizing.bought_parts import provenance, too_cold
from exo_sim.sizing.design import valve_effects
from exo_sim.sizing.evaluation import ENOUGH_MARGIN
from exo_sim.sizing.motion_search import RodDesign, RodJudge, front_of, recommended

SCHEMA = "exo-sim/size/1"


@dataclass(frozen=True)
class MotionSizing:
    """What a search along a motion came to.

    Attributes:
        judge: The machine, the motion, what could be chosen.
        designs: All that were looked at.
        front: Those that no other betters in everything.
        chosen: The recommended one.
    """

    judge: RodJudge
    designs: list[RodDesign]
    front: list[RodDesign]
    chosen: RodDesign


def result(judge: RodJudge, designs: list[RodDesign]) -> MotionSizing:
    """Return the front of a search and its recommended design.

    Raises:
        ScenarioError: no design can be had; why, and how often.
    """
    front = front_of(designs)
    if not front:
        why = Counter(one.fate for one in designs).most_common(3)
        said = "; ".join(f"{fate} ({count})" for fate, count in why)
        raise ScenarioError(
            f"{judge.loads.motion.name}: none of {len(designs)} designs does it: {said}. Allow more pressure (--pressure-limit), give "
            "larger cylinders (--catalogue), more trials or a slower motion"
        )
    return MotionSizing(judge, designs, front, recommended(front))


def sized_text(rig: Rig, chosen: RodDesign, groups: Mapping[str, tuple[str, ...]], folder: Path) -> str:
    """Return the owner's rig file with a design's numbers, the old ones in comments, for a file in `folder`."""
    numbers: list[tuple[tuple[str, ...], float, float, str]] = [
        (("supply", "pressure"), rig.supply.pressure, chosen.rig.supply.pressure, "Pa")
    ]
    ratings = []
    for name in (name for names in groups.values() for name in names):
        old, new = rig.cylinders[name], chosen.rig.cylinders[name]
        units = {"bore": "m", "rod": "m", "stroke": "m", "retracted_length": "m", "dead_volume_1": "m^3", "dead_volume_2": "m^3"}
        numbers += [(("cylinders", name, word), getattr(old, word), getattr(new, word), unit) for word, unit in units.items()]
        numbers.append((("cylinders", name, "valve", "area"), old.valve_area, new.valve_area, "m^2"))
        if new.rating is not None and old.rating != new.rating:
            ratings.append(Correction(("cylinders", name, "rating"), new.rating, "Pa"))
    corrections = [Correction(key, new, unit) for key, old, new, unit in numbers if not math.isclose(old, new, rel_tol=1e-7, abs_tol=1e-12)]
    corrections += ratings
    effects = [
        EffectEntry(EffectSetting(name, cylinder, {parameter: value}), says=f"Of {part.valve.name}.")
        for group, part in chosen.parts.items()
        if part.valve is not None
        for name, parameter, value in valve_effects(part.valve)
        for cylinder in groups[group]
    ]
    return improved(rig, effects, corrections, folder)


def write(found: MotionSizing, folder: Path) -> Path:
    """Write `sized.toml` into a folder; return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    with replacing(folder / "sized.toml") as new:
        new.write_text(sized_text(found.judge.rig, found.chosen, found.judge.space.groups, folder), encoding="utf-8")
    return folder / "sized.toml"


def entry(found: MotionSizing, one: RodDesign) -> dict[str, Any]:
    """Return one design; what differs by cylinder is a table by group."""
    first = {group: one.rig.cylinders[names[0]] for group, names in found.judge.space.groups.items()}
    return {
        "bore_mm": {group: _mm(c.bore) for group, c in first.items()},
        "rod_mm": {group: _mm(c.rod) for group, c in first.items()},
        "stroke_mm": {group: _mm(c.stroke) for group, c in first.items()},
        "supply_pa": one.rig.supply.pressure,
        "part": {group: part.cylinder.standard for group, part in one.parts.items()},
        "valve": {group: part.valve.name for group, part in one.parts.items() if part.valve is not None},
        "valve_area_mm2": {group: round(1e6 * c.valve_area, 3) for group, c in first.items()},
        "torque_margin": one.margin,
        "gas_kg_per_stride": one.gas,
        "actuator_mass_kg": one.mass,
        "force_error_rms_n": one.error,
        "position_error_rms": one.position_error,
        "pressure_peak_pa": one.peak,
        "design": one.number,
    }


def numbers(found: MotionSizing, folder: Path) -> dict[str, Any]:
    """Return the JSON object; a stride is the whole motion here."""
    return {
        "schema": SCHEMA,
        "motion": found.judge.loads.motion.name,
        "evaluated": len(found.designs),
        "pareto": [entry(found, one) for one in found.front],
        "chosen": folder / "sized.toml",
        "report": folder / "report.html",
        "recommended": entry(found, found.chosen),
        "parts": {group: part.numbers() for group, part in found.chosen.parts.items()},
        "fates": dict(Counter(one.fate or "can be had" for one in found.designs)),
    }


def words(found: MotionSizing, folder: Path) -> str:
    """Return the result for people."""
    head = f"{len(found.designs)} designs, {len(found.front)} on the Pareto front"
    lines = [head, "", *described(found), *changes(found), *bought(found)]
    return "\n".join([*lines, f"{folder / 'sized.toml'}, {folder / 'report.html'}"])


def described(found: MotionSizing) -> list[str]:
    """Return the recommended design in lines of text."""
    one = entry(found, found.chosen)
    turns = any(link.turning for link in found.judge.links)
    lines = [f"supply {one['supply_pa'] / 1e5:.1f} bar, absolute"]
    for group in found.judge.space.groups:
        lines.append(
            f"{group}: {one['part'][group]}, bore {one['bore_mm'][group]:g}, rod {one['rod_mm'][group]:g}, stroke "
            f"{one['stroke_mm'][group]:g} mm; {one['valve'].get(group, 'valve')} {one['valve_area_mm2'][group]:.1f} mm^2"
        )
    error = f"{math.degrees(found.chosen.position_error):.2f} deg" if turns else f"{1e3 * found.chosen.position_error:.2f} mm"
    return [
        *lines,
        f"gas {1e3 * one['gas_kg_per_stride']:.2f} g over the motion, cylinders {one['actuator_mass_kg']:.2f} kg, force margin "
        f"{100 * one['torque_margin']:.0f} %, position error {error} rms, force error {one['force_error_rms_n']:.1f} N rms",
    ]


def bought(found: MotionSizing) -> list[str]:
    """Return where the figures of the recommended parts come from, which are estimates, and which gets too cold, in lines of text."""
    parts = found.chosen.parts.values()
    return [*provenance(parts), *too_cold(parts, found.chosen.coldest)]


def changes(found: MotionSizing) -> list[str]:
    """Return what the recommendation rests on and what would have been chosen beside it, in lines of text."""
    chosen = found.chosen
    margin = f"Force margin {100 * chosen.margin:.0f} %, {100 * ENOUGH_MARGIN:.0f} % required"
    lines = [f"{margin}; largest pressure {chosen.peak / 1e5:.1f} bar."]
    for what, key, unit in (("gas", "gas", "g"), ("mass", "mass", "kg"), ("position error", "position_error", "")):
        best = min(found.front, key=lambda one: float(getattr(one, key)))
        if best is chosen:
            continue
        weak = f"has a force margin of {100 * best.margin:.0f} %, less than required"
        short = weak if best.margin < ENOUGH_MARGIN else "costs more of the rest"
        value = f", {(1e3 if key == 'gas' else 1.0) * getattr(best, key):.2f} {unit}" if unit else ""
        lines.append(f"The least {what} on the Pareto front is design {best.number}'s{value}; it {short}.")
    tight = [one for one in found.designs if one.fate and one.margin < 0.0]
    if tight:
        near = max(tight, key=lambda one: one.margin)
        lines.append(f"{len(tight)} designs are too weak; the nearest lacks {-100 * near.margin:.0f} % of the largest force.")
    return lines


def _mm(value: float) -> float:
    return round(1e3 * value, 4)
