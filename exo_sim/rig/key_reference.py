"""Every key of `rig.toml` with unit, default and bounds: what the reader asks for while it reads a rig that has all tables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from exo_sim import units
from exo_sim.inputs import toml
from exo_sim.physics.effects.valve_edges import EDGES
from exo_sim.rig.reading import parse_table
from exo_sim.rig.table import Table

#: What the reference says of the name, whose default is not a text but that of the file.
_OF_THE_FILE = "of the file"
#: A rig that has every table; `model` names a file of the package.
_WHOLE = """
name = "all"
model = "bench.xml"
[environment]
[gas]
heat_capacity_ratio = 1.4
[supply]
pressure = "7 bar"
[cylinders.NAME]
actuator = "piston"
bore = "32 mm"
stroke = "160 mm"
[cylinders.NAME.valve]
area = "5 mm^2"
[cylinders.NAME.attachment]
from = ["1 mm", "2 mm"]
to = ["1 mm", "2 mm"]
[bodies.NAME]
mass = "1 kg"
[joints.NAME]
damping_factor = 1.0
[wearer]
[ankle]
"""
#: Other ways to say what a valve is: four edges of their own, each by its area or by ISO 6358.
_VALVES = (
    'kind = "independent"\n' + "".join(f'area_{edge} = "5 mm^2"\noverlap_{edge} = 0.01\n' for edge in EDGES) + "b = 0.3\n",
    'C = "1 dm^3/(s bar)"\n' + "".join(f"b_{edge} = 0.3\n" for edge in EDGES),
    "".join(f'C_{edge} = "1 dm^3/(s bar)"\n' for edge in EDGES),
)
_EDGE_WORDS = {
    "supply_1": "from the supply to chamber 1",
    "exhaust_1": "from chamber 1 to the exhaust",
    "supply_2": "from the supply to chamber 2",
    "exhaust_2": "from chamber 2 to the exhaust",
}
#: What each key means, with its sign.
MEANINGS = {
    "name": "what the machine is called; the file's name when absent",
    "model": "MJCF file, relative to the rig file",
    "environment.pressure": "of the atmosphere, absolute",
    "environment.temperature": "of the atmosphere",
    "gas.specific_gas_constant": "R of the gas; dry air",
    "gas.heat_capacity_ratio": "cp/cv of the gas",
    "supply.pressure": "upstream of every valve, absolute; not below the atmosphere",
    "supply.temperature": "upstream of every valve; the atmosphere's when absent",
    "recovery.volume": "of a tank between exhaust and supply that chambers give gas to and take it from",
    "recovery.pressure": "of that tank at the start, absolute; the law of the valves keeps it near this",
    "cylinders.NAME.actuator": "MJCF motor whose control takes the rod force; + pushes the rod out",
    "cylinders.NAME.bore": "diameter of the piston",
    "cylinders.NAME.rod": "diameter of the rod, on the side of chamber 2; 0 where there is none. Of a rod through both ends say 0, and "
    "sqrt(bore^2 - rod^2) as the bore",
    "cylinders.NAME.stroke": "from the far left end (X = 0) to the other",
    "cylinders.NAME.retracted_length": "length of the actuator's transmission at X = 0; + is longer",
    "cylinders.NAME.dead_volume_1": "volume left in chamber 1 at X = 0, hose included",
    "cylinders.NAME.dead_volume_2": "volume left in chamber 2 at X = stroke, hose included",
    "cylinders.NAME.acting": "single: chamber 2 is open to the atmosphere",
    "cylinders.NAME.rating": "largest pressure that the cylinder is made for, absolute; beyond it `run` and `inspect` warn",
    "cylinders.NAME.valve.area": "effective throat area of each path at full command; command +1 opens supply to chamber 1",
    "cylinders.NAME.valve.kind": "independent: each chamber has a command of its own, +1 opens it to the supply, -1 to the exhaust",
    "cylinders.NAME.valve.C": "sonic conductance of ISO 6358 of each path, in place of the area; in dm^3/(s bar) about a catalogue's "
    "nominal flow in l/min (6 to 5 bar gauge) over 255 where b is 0.3 (240 at 0.2, 272 at 0.4), or 4.5 times Kv in m^3/h, to 10 %",
    "cylinders.NAME.valve.b": "critical pressure ratio of ISO 6358 of every path; a nozzle when absent",
    **{f"cylinders.NAME.valve.area_{edge}": f"effective throat area {words}; `area` when absent" for edge, words in _EDGE_WORDS.items()},
    **{f"cylinders.NAME.valve.C_{edge}": f"sonic conductance {words}, in place of its area" for edge, words in _EDGE_WORDS.items()},
    **{f"cylinders.NAME.valve.b_{edge}": f"as b, {words}: all edges share one" for edge, words in _EDGE_WORDS.items()},
    **{
        f"cylinders.NAME.valve.overlap_{edge}": f"command at which the path {words} begins to open, a dead band of this edge: "
        "[effects.valve_deadband] comes on top; below zero it is open at rest"
        for edge, words in _EDGE_WORDS.items()
    },
    "cylinders.NAME.attachment.from": "x forward and z up of the first end, from the joint's axis, all joints at zero",
    "cylinders.NAME.attachment.to": "x forward and z up of the rod's end",
    "bodies.NAME.mass": "replaces the mass of that body of the MJCF; of the body `payload`, what `run` carries when `--payload` is absent",
    "joints.NAME.inertia_factor": "on what that joint has to accelerate; gravity stays",
    "joints.NAME.range": "stops of that joint, inside the MJCF's own; a cylinder's stroke must cover what is between them",
    "joints.NAME.damping_factor": "on the MJCF's damping of that joint",
    "wearer.height": "of who wears it",
    "wearer.mass": "of who wears it",
    "ankle.mode": "free, with a spring, or with a motor",
    "ankle.stiffness": "of a sprung ankle",
    "ankle.torque": "largest of a powered ankle",
}


@dataclass(frozen=True)
class Key:
    """One key: dotted name, SI unit ("text" where it is none), default ("required" where there is none), bounds or choices, meaning."""

    name: str
    unit: str
    default: str
    bounds: str
    meaning: str


class _Noting(Table):
    """A table that notes what is asked of it."""

    noted: list[Key]

    def table(self, key: str, required: bool = True) -> Table | None:
        found = super().table(key, required)
        if found is None:
            return None
        inner = _Noting(found.path, found.key, found.values)
        inner.noted = self.noted
        return inner

    def text(self, key: str, default: str | None = None, choices: Iterable[str] = ()) -> str:
        known = tuple(choices)
        self._note(key, "text", None if default is None else f'"{default}"', " or ".join(f'"{each}"' for each in known))
        return super().text(key, default, known)

    def quantity(
        self, key: str, si_unit: str, default: float | None = None, above: float | None = None, at_least: float | None = None,
        most: float | None = None,
    ) -> float:  # fmt: skip
        low = f"above {above:g}" if above is not None else f"from {at_least:g}" if at_least is not None else ""
        bounds = " ".join(part for part in (low, f"to {most:g}" if most is not None else "") if part)
        shown = None if default is None else str(units.write(default, si_unit)).replace(".0 ", " ")
        self._note(key, si_unit, shown, bounds)
        return super().quantity(key, si_unit, default, above, at_least, most)

    def quantities(self, key: str, si_unit: str, names: tuple[str, str]) -> tuple[float, float]:
        self._note(key, si_unit, None, f"a pair: {names[0]}, {names[1]}")
        return super().quantities(key, si_unit, names)

    def _note(self, key: str, unit: str, default: str | None, bounds: str) -> None:
        name = self.name(key)
        if name not in [known.name for known in self.noted]:
            self.noted.append(Key(name, unit, default or "required", bounds, MEANINGS.get(name, "")))


def every_key() -> list[Key]:
    """Return every key in the order in which the reader asks for it; `[effects]` are declared elsewhere (`rig.pages`)."""
    noted: list[Key] = []
    others = [_WHOLE.replace('area = "5 mm^2"\n', valve) for valve in _VALVES]
    others.append(_WHOLE.replace("[cylinders.NAME.valve]", 'rating = "11 bar"\n[cylinders.NAME.valve]'))
    independent = '[recovery]\nvolume = "2 l"\npressure = "3 bar"\n[cylinders.NAME.valve]\nkind = "independent"\n'
    others.append(_WHOLE.replace("[cylinders.NAME.valve]\n", independent))
    others.append(_WHOLE.replace("damping_factor = 1.0", 'range = ["-1 deg", "1 deg"]'))
    for text in (_WHOLE, *others):
        table = _Noting(Path(__file__).resolve().parents[1] / "assets" / "all.toml", "", toml(text))
        table.noted = noted
        parse_table(table, text)
        if text is _WHOLE:
            usual = len(noted)
    noted[usual:] = [replace(key, default="absent") if key.default == "required" else key for key in noted[usual:]]
    noted = [replace(key, default=_OF_THE_FILE) if key.name == "name" else key for key in noted]
    order = {name: i for i, name in enumerate(MEANINGS)}
    return sorted(noted, key=lambda key: order.get(key.name, len(order)))
