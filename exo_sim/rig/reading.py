"""Read `rig.toml` and refuse what cannot be a machine."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from exo_sim import units
from exo_sim.errors import RigError, misspelt
from exo_sim.inputs import refusing, text_of, toml
from exo_sim.rig.effect_tables import read_effects
from exo_sim.rig.schema import (
    COLDEST,
    LARGEST_HEAT_CAPACITY_RATIO,
    LARGEST_PRESSURE,
    Ankle,
    Attachment,
    Cylinder,
    EffectSetting,
    Environment,
    JointFactors,
    Recovery,
    Rig,
    Supply,
    Wearer,
)
from exo_sim.rig.table import Table
from exo_sim.rig.valve import check_edges, read_valve, with_valves

#: What stands at the top of a rig file. Asked first: under a misspelt heading everything else looks missing.
SECTIONS = (
    "name", "model", "environment", "gas", "supply", "recovery", "cylinders", "bodies", "joints", "wearer", "ankle", "effects",
)  # fmt: skip
ANKLE_MODES = ("free", "sprung", "powered")


def read(path: str | Path) -> Rig:
    """Read a rig file.

    Raises:
        RigError: one line that names the file, the key, the value and what to do.
    """
    path = Path(path)
    with refusing(lambda says: RigError(f"{path}: {says}"), "no such rig file"):
        text = text_of(path)
    return parse(text, path)


def parse(text: str, path: Path) -> Rig:
    """Read a rig from its text; `path` is where its MJCF is looked for, and what errors name."""
    with refusing(lambda says: RigError(f"{path}: {says}")):
        values = toml(text)
    return parse_table(Table(path, "", values), text)


def parse_table(table: Table, text: str) -> Rig:
    """Read a rig from the table that its text holds.

    Raises:
        RigError: as `read`.
    """
    path = table.path
    table.only(SECTIONS)
    name = table.text("name", default=path.stem)
    model = path.parent / table.text("model")
    if not _is_file(model):
        raise RigError(f'{path}: model = "{table.values["model"]}": no such MJCF file beside the rig{misspelt(model)}')
    environment = _environment(table)
    gas = table.table("gas", required=False)
    r, k = 287.05, 1.4
    if gas:
        r = gas.quantity("specific_gas_constant", "J/(kg K)", default=r, above=0.0, most=1e4)
        k = gas.quantity("heat_capacity_ratio", "1", default=k, above=1.0, most=LARGEST_HEAT_CAPACITY_RATIO)
        gas.done()
    cylinders: dict[str, Cylinder] = {}
    valves: list[EffectSetting] = []
    if (group := table.table("cylinders", required=False)) is not None:
        for key in group.values:
            part = group.table(key)
            assert part is not None
            cylinders[key], of_valve = _cylinder(key, part)
            valves += of_valve
    driven: dict[str, str] = {}
    for cylinder in cylinders.values():
        if cylinder.actuator in driven:
            raise RigError(
                f'{path}: cylinders.{cylinder.name}.actuator = "{cylinder.actuator}": already driven by cylinder '
                f'"{driven[cylinder.actuator]}"; give each cylinder an actuator of its own'
            )
        driven[cylinder.actuator] = cylinder.name
    masses = {name: part.quantity("mass", "kg", above=0.0, most=1e6) for name, part in _parts_of(table, "bodies")}
    factors = {name: _factors(part) for name, part in _parts_of(table, "joints")}
    supply = _supply(table, environment, needed=any(c.valve_area > 0.0 for c in cylinders.values()))
    wearer, ankle = _worn(table)
    effects = with_valves(read_effects(table.table("effects", required=False), cylinders), valves)
    recovery = _recovery(table, environment, supply, cylinders)
    return Rig(name, model, environment, supply, r, k, cylinders, effects, masses, factors, wearer, ankle, text, path, recovery)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that no file can have
        return False


def _parts_of(table: Table, group: str) -> Iterator[tuple[str, Table]]:
    """Yield name and table of every part of a group, e.g. of `[bodies.NAME]`; what is left in one when it was read is refused."""
    parts = table.table(group, required=False)
    for name in parts.values if parts is not None else ():
        part = parts.table(name) if parts is not None else None
        assert part is not None
        yield name, part
        part.done()


def _factors(part: Table) -> JointFactors:
    """Return what a rig says of a joint; there must be something."""
    inertia = part.quantity("inertia_factor", "1", default=1.0, above=0.0, most=1e6)
    other = part.has("inertia_factor") or part.has("range")
    damping = part.quantity("damping_factor", "1", default=1.0 if other else None, above=0.0, most=1e6)
    return JointFactors(damping, inertia, _range(part) if part.has("range") else None)


def _range(part: Table) -> tuple[float, float]:
    """Return the stops of a joint [rad, or m where it slides]."""
    held = part.values["range"]
    slides = isinstance(held, list) and held and units.is_of(held[0], "m")
    low, high = part.quantities("range", "m" if slides else "rad", ("least", "most"))
    if not low < high:
        raise part.fail("range", "must rise from its first end to its second")
    return low, high


def _environment(table: Table) -> Environment:
    part = table.table("environment", required=False)
    if part is None:
        return Environment()
    found = Environment(
        part.quantity("pressure", "Pa", default=101325.0, above=0.0, most=1e7),
        part.quantity("temperature", "K", default=293.15, above=COLDEST, most=2000.0),
    )
    part.done()
    return found


def _supply(table: Table, environment: Environment, needed: bool) -> Supply:
    part = table.table("supply", required=needed)
    if part is None:
        return Supply(environment.pressure, environment.temperature)
    found = Supply(
        part.quantity("pressure", "Pa", above=0.0, most=LARGEST_PRESSURE),
        part.quantity("temperature", "K", default=environment.temperature, above=COLDEST, most=2000.0),
    )
    part.done()
    if found.pressure < environment.pressure:
        raise part.fail(
            "pressure", f"is below the atmosphere ({environment.pressure:g} Pa); pressures are absolute, not gauge"
        )
    return found


def _recovery(table: Table, environment: Environment, supply: Supply, cylinders: dict[str, Cylinder]) -> Recovery | None:
    """Return the recovery tank; only chambers with edges of their own can use one."""
    part = table.table("recovery", required=False)
    if part is None:
        return None
    found = Recovery(
        part.quantity("volume", "m^3", above=0.0, most=10.0),
        part.quantity("pressure", "Pa", above=0.0, most=1e9),
    )
    part.done()
    if not environment.pressure < found.pressure < supply.pressure:
        raise part.fail("pressure", f"must lie between atmosphere ({environment.pressure:g} Pa) and supply ({supply.pressure:g} Pa)")
    check_edges(table.path, cylinders)
    return found


def _cylinder(name: str, part: Table) -> tuple[Cylinder, list[EffectSetting]]:
    """Return a cylinder, and the effects that say how its valve's edges differ."""
    bore = part.quantity("bore", "m", above=0.0, most=10.0)
    rod = part.quantity("rod", "m", default=0.0, at_least=0.0)
    if rod >= bore:
        raise part.fail("rod", f"must be thinner than the bore ({bore:g} m)")
    area, valve, of_valve = read_valve(name, part.table("valve", required=False), bore)
    cylinder = Cylinder(
        name,
        part.text("actuator"),
        bore,
        rod,
        part.quantity("stroke", "m", above=0.0, most=100.0),
        part.quantity("retracted_length", "m", default=0.0, at_least=-1000.0, most=1000.0),
        part.quantity("dead_volume_1", "m^3", default=0.0, at_least=0.0, most=1e4),
        part.quantity("dead_volume_2", "m^3", default=0.0, at_least=0.0, most=1e4),
        part.text("acting", default="double", choices=("double", "single")) == "single",
        area,
        _attachment(part.table("attachment", required=False)),
        valve,
        part.quantity("rating", "Pa", above=0.0, most=1e9) if part.has("rating") else None,
    )
    part.done()
    return cylinder, of_valve


def _attachment(part: Table | None) -> Attachment | None:
    if part is None:
        return None
    found = Attachment(*(part.quantities(key, "m", ("x", "z")) for key in ("from", "to")))
    part.done()
    return found


def _worn(table: Table) -> tuple[Wearer, Ankle]:
    wearer, ankle = Wearer(), Ankle()
    if (part := table.table("wearer", required=False)) is not None:
        wearer = Wearer(
            part.quantity("height", "m", wearer.height, above=0.5, most=3.0),
            part.quantity("mass", "kg", wearer.mass, above=10.0, most=500.0),
        )
        part.done()
    if (part := table.table("ankle", required=False)) is not None:
        ankle = Ankle(
            part.text("mode", ankle.mode, ANKLE_MODES),
            part.quantity("stiffness", "N*m/rad", ankle.stiffness, at_least=0.0, most=1e6),
            part.quantity("torque", "N*m", ankle.torque, at_least=0.0, most=1e5),
        )
        part.done()
    return wearer, ankle
