"""A design as a rig file: the owner's text with the chosen numbers in it."""

from __future__ import annotations

from pathlib import Path

import tomlkit

from exo_sim.rig import Correction, Rig, improved
from exo_sim.sizing.design import Design, JointKind, fitted


def sized_text(rig: Rig, kinds: tuple[JointKind, ...], design: Design, folder: Path) -> str:
    """Return the text of `sized.toml` for a file in `folder`; the owner's comments, units, effects and order stay.

    Args:
        rig: The owner's.
        kinds: Joints that were sized.
        design: What was chosen.
        folder: Where the file will be; the path to the MJCF is counted from there.
    """
    chosen = fitted(rig, kinds, design)
    corrections = [Correction(("supply", "pressure"), design.supply, "Pa")]
    for kind in kinds:
        for name in kind.cylinders:
            cylinder = chosen.cylinders[name]
            key = ("cylinders", name)
            corrections += [
                Correction((*key, "bore"), cylinder.bore, "m"),
                Correction((*key, "rod"), cylinder.rod, "m"),
                Correction((*key, "stroke"), cylinder.stroke, "m"),
                Correction((*key, "retracted_length"), cylinder.retracted_length, "m"),
                Correction((*key, "dead_volume_1"), cylinder.dead_volume_1, "m^3"),
                Correction((*key, "dead_volume_2"), cylinder.dead_volume_2, "m^3"),
                Correction((*key, "valve", "area"), cylinder.valve_area, "m^2"),
            ]
    document = tomlkit.parse(improved(rig, [], corrections, folder))
    cylinders = document["cylinders"]
    for kind in kinds:
        points = design.joints[kind.name].attachment
        for name in kind.cylinders:
            table = tomlkit.table()
            for key, end, own in (("from", points.base, kind.own.base), ("to", points.rod, kind.own.rod)):
                item = tomlkit.array()
                item.extend([f"{1e3 * end[0]:.7g} mm", f"{1e3 * end[1]:.7g} mm"])
                item.comment(f"was {1e3 * own[0]:.4g}, {1e3 * own[1]:.4g} mm; x, z from the axis of the {kind.name}")
                table[key] = item
            cylinders[name]["attachment"] = table  # type: ignore[index]
    return tomlkit.dumps(document)
