"""A design as a rig file: the owner's text with the chosen numbers in it."""

from __future__ import annotations

import math
from pathlib import Path

import tomlkit

from exo_sim import units
from exo_sim.rig import Correction, EffectEntry, EffectSetting, Rig, improved
from exo_sim.sizing.design import Design, fitted, valve_effects
from exo_sim.sizing.joint_kinds import JointKind


def sized_text(rig: Rig, kinds: tuple[JointKind, ...], design: Design, folder: Path) -> str:
    """Return the text of `sized.toml` for a file in `folder`; the owner's comments, units, effects and order stay.

    Args:
        rig: The owner's.
        kinds: Joints that were sized.
        design: What was chosen.
        folder: Where the file will be; the path to the MJCF is counted from there.
    """
    chosen = fitted(rig, kinds, design)
    numbers: list[tuple[tuple[str, ...], float, float, str]] = [(("supply", "pressure"), rig.supply.pressure, design.supply, "Pa")]
    ratings = []
    for kind in kinds:
        for name in kind.cylinders:
            old, new, key = rig.cylinders[name], chosen.cylinders[name], ("cylinders", name)
            for word in ("bore", "rod", "stroke", "retracted_length"):
                numbers.append(((*key, word), getattr(old, word), getattr(new, word), "m"))
            for word in ("dead_volume_1", "dead_volume_2"):
                numbers.append(((*key, word), getattr(old, word), getattr(new, word), "m^3"))
            if new.rating is not None and old.rating != new.rating:
                ratings.append(Correction((*key, "rating"), new.rating, "Pa"))
            numbers.append(((*key, "valve", "area"), old.valve_area, new.valve_area, "m^2"))
    if rig.recovery is not None and design.recovery is not None:
        for word, unit in (("volume", "m^3"), ("pressure", "Pa")):
            if "recovery" in tomlkit.parse(rig.text):
                numbers.append((("recovery", word), getattr(rig.recovery, word), getattr(design.recovery, word), unit))
    said = tomlkit.parse(rig.text).get("bodies", {})
    for name, mass in rig.body_masses.items():  # with the cylinders' own
        owners = units.parse(str(said[name]["mass"]), "kg") if name in said else 0.0
        numbers.append((("bodies", name, "mass"), owners, mass, "kg"))
    corrections = [
        Correction(key, new, unit) for key, old, new, unit in numbers if not math.isclose(old, new, rel_tol=1e-7)
    ] + ratings
    effects = [
        EffectEntry(EffectSetting(name, cylinder, {parameter: value}), says=f"Of {valve.name}.")
        for kind in kinds
        if (valve := design.joints[kind.name].valve) is not None
        for name, parameter, value in valve_effects(valve)
        for cylinder in kind.cylinders
    ]
    effects += [
        EffectEntry(EffectSetting("return_spring", cylinder, {"stiffness": spring[0], "rest": spring[1]}), says="A spring beside the rod.")
        for kind in kinds
        if (spring := design.joints[kind.name].spring) is not None
        for cylinder in kind.cylinders
    ]
    document = tomlkit.parse(improved(rig, effects, corrections, folder))
    _with_edges_and_tank(document, rig, design)
    for kind in kinds:
        _with_stops(document, rig, kind)
    cylinders = document["cylinders"]
    for kind in kinds:
        points = design.joints[kind.name].attachment
        for name in kind.cylinders:
            before, table = rig.cylinders[name].attachment, tomlkit.table()
            if before == points:
                continue
            for word, end, own in (("from", points.base, kind.own.base), ("to", points.rod, kind.own.rod)):
                item = tomlkit.array()
                item.extend([f"{1e3 * end[0]:.7g} mm", f"{1e3 * end[1]:.7g} mm"])
                item.comment(f"was {1e3 * own[0]:.4g}, {1e3 * own[1]:.4g} mm; x, z from the axis of the {kind.name}")
                table[word] = item
            table.add(tomlkit.nl())
            cylinders[name]["attachment"] = table  # type: ignore[index]
    return tomlkit.dumps(document)


def _with_edges_and_tank(document: tomlkit.TOMLDocument, rig: Rig, design: Design) -> None:
    """Write valves that a sizing took to have edges of their own, and a recovery tank that the owner's file does not have."""
    cylinders = document["cylinders"]
    for name, cylinder in rig.cylinders.items():
        valve = cylinders[name].get("valve")  # type: ignore[index, union-attr]
        if cylinder.valve.independent and valve is not None and valve.get("kind") != "independent":
            valve["kind"] = "independent"
    if design.recovery is not None and "recovery" not in document:
        table = tomlkit.table()
        table["volume"] = f"{1e3 * design.recovery.volume:.4g} l"
        table["pressure"] = f"{1e-5 * design.recovery.pressure:.4g} bar"
        table["pressure"].comment("absolute; chambers give gas to this tank and take it from it")
        document["recovery"] = table


def _with_stops(document: tomlkit.TOMLDocument, rig: Rig, kind: JointKind) -> None:
    """Write the stops that a sizing set inside the joints' own range."""
    for joint in kind.joints:
        stops = rig.joint_factors[joint].range if joint in rig.joint_factors else None
        if stops is None:
            continue
        joints = document.setdefault("joints", tomlkit.table(is_super_table=True))
        table = joints.setdefault(joint, tomlkit.table())
        if "range" not in table:
            table["range"] = [f"{math.degrees(end):.6g} deg" for end in stops]
