"""What may be chosen of a machine that nobody wears: bores, valves and supply, cylinders of both sides alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from exo_sim.errors import RigError, ScenarioError, nearest
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import Rig
from exo_sim.rig.own_catalogue import Catalogue
from exo_sim.sizing.design_space import LEAST_SUPPLY


@dataclass(frozen=True)
class RodSpace:
    """What may be chosen.

    Attributes:
        groups: Cylinders that are sized alike, by name: those of both sides of a machine are one group.
        supply: Least and largest, absolute [Pa].
        catalogue: What may be bought.
        fixed: Numbers that are not chosen: "supply", "GROUP.bore", "GROUP.valve".
    """

    groups: Mapping[str, tuple[str, ...]]
    supply: tuple[float, float]
    catalogue: Catalogue
    fixed: Mapping[str, float]


def rod_space(
    rig: Rig, pressure_limit: float | None, joints: tuple[str, ...], catalogue: Catalogue | None, fixed: Mapping[str, float]
) -> RodSpace:
    """Return what may be chosen; arguments as of `study.space_of`, joints by their names.

    Raises:
        RigError, ScenarioError: a limit, joint, bore or number that is not to be had.
    """
    links = linkages(rig, load(rig))
    driven = [link.joint for link in links]
    for joint in joints:
        if joint not in driven:
            raise ScenarioError(f'--joints: no cylinder of {rig.path} drives "{joint}"{nearest(joint, driven)}')
    groups: dict[str, tuple[str, ...]] = {}
    for link in links:
        if not joints or link.joint in joints:
            name = link.cylinder
            stem = name[:-2] if name.endswith(("_l", "_r")) else name
            groups[stem] = (*groups.get(stem, ()), name)
    catalogue, atmosphere = catalogue or Catalogue(), rig.environment.pressure
    kinds = {"independent" if rig.cylinders[name].valve.independent else "4-way" for names in groups.values() for name in names}
    if catalogue.valves:
        catalogue = replace(catalogue, valves=tuple(one for one in catalogue.valves if one.kind in kinds))
        if not catalogue.valves:
            raise RigError(f'{rig.path}: its valves are of kind = "{", ".join(sorted(kinds))}", of which the catalogue has none')
    most = pressure_limit if pressure_limit is not None else max(max(one.rating for one in catalogue.cylinders), fixed.get("supply", 0.0))
    if most < atmosphere + LEAST_SUPPLY:
        least = (atmosphere + LEAST_SUPPLY) / 1e5
        raise RigError(f"a pressure limit of {most / 1e5:g} bar leaves nothing to choose; allow {least:.2f} bar, absolute")
    known = ["supply", *(f"{name}.{word}" for name in groups for word in ("bore", "valve"))]
    for name, value in fixed.items():
        if name not in known:
            raise ScenarioError(f"--fix {name}: there is no such number to choose{nearest(name, known)}")
        if name.endswith(".bore") and not any(abs(one.bore - value) < 1e-6 for one in catalogue.cylinders):
            raise ScenarioError(f"--fix {name}: the catalogue has no bore of {1e3 * value:g} mm")
    return RodSpace(groups, (atmosphere + LEAST_SUPPLY, most), catalogue, fixed)
