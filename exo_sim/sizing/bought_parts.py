"""What is known of the parts that a design buys: where their figures come from, which are estimates, how cold they may get."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from exo_sim.rig.catalogue import CatalogueCylinder
from exo_sim.rig.limits import FREEZING
from exo_sim.rig.own_catalogue import CatalogueValve

#: What designers call the keys of a catalogue file.
_CALLED = {
    "mass_0": "mass without stroke", "mass_per_metre": "mass by length", "pivot_length": "pivot length", "coldest": "coldest temperature",
    "C": "C", "b": "b",
}  # fmt: skip


@dataclass(frozen=True)
class BoughtParts:
    """The cylinder and the valve of one kind of joint, or of one group of cylinders."""

    name: str
    cylinder: CatalogueCylinder
    valve: CatalogueValve | None = None

    def _said(self) -> list[str]:
        out = []
        for called, part in ((self.cylinder.standard, self.cylinder), (self.valve.name if self.valve else "", self.valve)):
            if part is None or not (part.source or part.estimated):
                continue
            estimates = ", ".join(_CALLED.get(word, word) for word in part.estimated)
            said = [f"by {part.source}"] if part.source else []
            said += [f"estimates: {estimates}"] if estimates else ["no estimates"] if part.source else []
            out.append(f"{called} {'; '.join(said)}.")
        return out

    def numbers(self) -> dict[str, Any]:
        """Return the same as a record of the JSON object."""
        out = {"cylinder": self.cylinder.source or None, "cylinder_estimates": list(self.cylinder.estimated)}
        if self.valve is not None:
            out |= {"valve": self.valve.source or None, "valve_estimates": list(self.valve.estimated)}
        return out


def provenance(parts: Iterable[BoughtParts]) -> list[str]:
    """Return where the figures of each part come from and which are estimates, in lines of text; once for those that are alike."""
    names: dict[str, list[str]] = {}
    for one in parts:
        for said in one._said():
            names.setdefault(said, []).append(one.name)
    return [f"{', '.join(alike)}: {said}" for said, alike in names.items()]


def too_cold(parts: Iterable[BoughtParts], least: Mapping[str, float]) -> list[str]:
    """Return a line for each part whose gas gets colder than its maker allows.

    Args:
        parts: The design's.
        least: Temperature of the gas in their chambers [K], by name; those that are absent do not count.
    """
    lines = []
    for one in parts:
        allowed, reached = one.cylinder.coldest, least.get(one.name)
        if allowed is not None and reached is not None and reached < allowed:
            lines.append(
                f"{one.name}: its gas falls to {reached - FREEZING:.0f} C, {one.cylinder.standard} is made for {allowed - FREEZING:.0f} C "
                "and more: ask its maker, warm the supply, or let the wall's heat count ([effects] wall_heat_transfer)."
            )
    return lines

