"""Every declared effect: off is the paper, it shows where it says, its rig text comes back. Known limits stand beside, one file each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from physics.sliding import contact, slide

from exo_sim import signals
from exo_sim.physics import state
from exo_sim.physics.declaration import FAMILIES, Effect, Parameter, declared
from exo_sim.physics.nodes import exhaust_state, supply_state
from exo_sim.physics.plant_records import CYLINDER, JOINT
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world
from exo_sim.rig import EffectEntry, EffectSetting, improved, parse

NAMES = sorted(declared())
FRICTION = [name for name in NAMES if declared()[name].cut == "motion" and name != "return_spring"]

#: What takes the strength out of an effect whose other numbers stay as they are. Without an entry: all its numbers are zero.
OFF: Mapping[str, Mapping[str, float]] = {
    "critical_ratio": {"ratio": 0.0},
    "end_cushioning": {"length": 0.0},
    "exhaust_back_pressure": {"area": 0.0},
    "external_leakage": {"area_1": 0.0, "area_2": 0.0, "laminar_1": 0.0, "laminar_2": 0.0},
    "line_restriction": {"area": 0.0},
    "friction_smoothing": {},  # nothing dry to be smoothed
    "presliding": {},  # nothing dry to be elastic
    "return_spring": {"stiffness": 0.0},
    "pressure_dependent_friction": {"coefficient": 0.0, "difference": 0.0},
    "stribeck_friction": {"breakaway": 0.0},
    "supply_droop": {"volume": 0.0},
    "supply_regulator": {"droop": 0.0},
    "unknown": {"values": 0.0},
    "moving_wall_temperature": {},  # no heat that could move it
}

#: What must be on for an effect to have something to act upon.
ALONGSIDE: Mapping[str, Mapping[str, Mapping[str, float]]] = {
    "moving_wall_temperature": {"wall_heat_transfer": {"conductance": 1.0}},
    "heat_transfer_law": {"wall_heat_transfer": {"conductance": 1.0}},
    "friction_smoothing": {"coulomb_friction": {"force": 20.0}},
    "presliding": {"coulomb_friction": {"force": 20.0}},
}


def typical(parameter: Parameter) -> float | NDArray[np.float64]:
    """Return a number in the middle of what is met in practice."""
    low, high = parameter.typical
    if parameter.most:
        return np.linspace(low, high, parameter.most)
    if parameter.choices:
        return 0.0
    return math.sqrt(low * high) if low > 0.0 else 0.5 * (low + high) or high


def numbers(effect: Effect) -> dict[str, Any]:
    """Return typical numbers for all that an effect declares."""
    return {parameter.name: typical(parameter) for parameter in effect.parameters}


def run(settings: Mapping[str, Mapping[str, float]]) -> dict[str, NDArray[np.float64]]:
    """Fill, hold, vent and work a cylinder whose piston is moved along a path; return every signal, shape (n,)."""
    world, cylinder = paper_world(), paper_cylinder(0.032, 0.012, 0.1, 3e-6, 4e-6, 4e-6)
    cylinder["effective_mass"] = 10.0
    for name, entries in settings.items():
        where = cylinder if name in (CYLINDER.names or ()) else world
        for key, value in entries.items():
            where[name][key] = value
    gas = Pneumatics(world, cylinder, dt=1e-3)
    t = np.arange(1200) * 1e-3
    x = 0.05 + 0.046 * np.sin(2 * np.pi * 2.5 * t) * (t > 0.2)
    x[900:] = x[900]
    command = np.where(t < 0.1, 0.5, np.where(t < 0.2, 0.0, np.sin(2 * np.pi * 4 * t) * (t < 0.9)))
    gas.fill(x[:1], 3e5, 4e5)
    out = {key: np.empty(len(t)) for key in ("pressure_1", "pressure_2", "force", "supply.pressure", "exhaust.pressure")}
    for i in range(len(t)):
        if i:
            gas.advance(x[i - 1 : i], x[i : i + 1], command[i - 1 : i])
        v = np.array([(x[i] - x[i - 1]) / 1e-3 if i else 0.0])
        shared = gas.vector[len(gas.integrated[0]) :]
        held = shared[state.SHARED + state.REMEMBERED + state.HELD]
        out["pressure_1"][i], out["pressure_2"][i] = gas.pressures(x[i : i + 1])[0]
        out["force"][i] = gas.forces(x[i : i + 1], v)[0]
        out["supply.pressure"][i] = supply_state(gas.world[0], gas.vector, len(gas.integrated[0]), held)[0]
        out["exhaust.pressure"][i] = exhaust_state(gas.world[0], gas.vector, len(gas.integrated[0]))[0]
    books = gas.books()
    assert books.mass_residual < 1e-9 and books.energy_residual < 1e-9
    return out


@pytest.fixture(scope="module")
def paper() -> dict[str, NDArray[np.float64]]:
    return run({})


def test_every_effect_of_the_contract_is_declared() -> None:
    listed = [
        "wall_heat_transfer", "piston_leakage", "external_leakage", "valve_null_leakage", "valve_deadband",
        "valve_offset", "valve_lag", "valve_hysteresis", "line_restriction", "exhaust_back_pressure", "supply_droop",
        "coulomb_friction", "viscous_friction", "stribeck_friction", "pressure_dependent_friction", "return_spring",
        "transmission_compliance", "backlash", "quadratic_drag", "critical_ratio", "presliding",
        "asymmetric_friction", "spool_rate_limit", "moving_wall_temperature", "end_cushioning", "supply_regulator",
        "sensor_delay", "sensor_bias", "sensor_scale", "unknown",
    ]  # fmt: skip
    assert set(listed) <= set(NAMES)


def test_every_effect_has_known_limits(repository: Path) -> None:
    folder = repository / "tests" / "physics" / "effects"
    assert {path.stem.removeprefix("test_") for path in folder.glob("test_*.py")} - {"every_effect"} == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_declaration_is_complete(name: str) -> None:
    effect = declared()[name]
    known = {signal.name for signal in signals.TABLE} | {f"{signal.part}.{signal.name}" for signal in signals.TABLE}
    calibrations = {"flow_capacity", "dead_volume", "payload_mass"}
    assert effect.question.endswith("?") and effect.says.endswith(".")
    assert effect.signature and effect.experiment and effect.parameters
    assert effect.family in FAMILIES and effect.valid.endswith(".")
    assert set(effect.reveals) | set(effect.needs) <= known
    assert set(effect.mistaken_for) <= set(NAMES) | calibrations
    assert effect.requires in ("", *NAMES)
    for parameter in effect.parameters:
        assert parameter.low <= parameter.typical[0] <= parameter.typical[1] <= parameter.high
        assert parameter.source


@pytest.mark.parametrize("name", NAMES)
def test_off_is_the_paper_bit_for_bit(name: str, paper: dict[str, NDArray[np.float64]]) -> None:
    effect = declared()[name]
    if effect.cut == "sensor":
        values = np.random.default_rng(0).normal(size=50)
        module = __import__(f"exo_sim.physics.effects.{name}", fromlist=["read"])
        assert (module.read(values, np.arange(50.0), 1.0 if name == "sensor_scale" else 0.0) == values).all()
        return
    off = {**numbers(effect), **OFF[name]} if name in OFF else dict.fromkeys(numbers(effect), 0.0)
    found = run({name: off})
    for key, values in paper.items():
        assert (found[key] == values).all(), key


@pytest.mark.parametrize("name", [name for name in NAMES if declared()[name].cut != "sensor"])
def test_shows_in_the_signals_that_it_names_and_nowhere_else(name: str, paper: dict[str, NDArray[np.float64]]) -> None:
    """The piston's path and the command are given: what then differs must be named, or follow from what is named."""
    effect = declared()[name]
    beside = ALONGSIDE.get(name, {})
    off = run(beside) if beside else paper
    on = run({**beside, name: numbers(effect)})
    changed = {key for key in paper if np.abs(on[key] - off[key]).max() > 1e-6 * np.abs(off[key]).max()}
    assert changed, "the effect shows nowhere"
    named = set(effect.reveals) | set(effect.needs)
    if {"pressure_1", "pressure_2"} & named and effect.cut in ("gas", "any"):
        named |= {"pressure_1", "pressure_2", "force"}  # the rod force follows from the pressures
    assert changed <= named
    if effect.cut == "motion":
        assert changed == {"force"}, "what resists the motion leaves the gas alone where the motion is given"


@pytest.mark.parametrize("name", [name for name in FRICTION if "joint" in declared()[name].places])
def test_friction_takes_work_and_never_gives_it(name: str) -> None:
    effect = declared()[name]
    settings = {**ALONGSIDE.get(name, {}), name: numbers(effect)}
    found = slide(contact(**settings), 5.0, 0.0, lambda t, q: 80.0 * math.sin(9 * t), 1.5, 1e-3)
    free = slide(contact(), 5.0, 0.0, lambda t, q: 80.0 * math.sin(9 * t), 1.5, 1e-3)
    assert np.abs(found[:, 1]).max() < np.abs(free[:, 1]).max()
    coasting = slide(contact(**settings), 5.0, 0.03, lambda t, q: 0.0, 1.0, 1e-3)
    energy = coasting[:, 1] ** 2
    assert energy[-1] < energy[0]
    if "presliding" not in settings:  # what a bent contact gives back is little
        assert (energy[1:] < np.minimum.accumulate(energy)[:-1] + 0.05 * energy[0]).all()


STUCK = {
    "coulomb": {"coulomb_friction": {"force": 20.0}},
    "stribeck": {"coulomb_friction": {"force": 12.0}, "stribeck_friction": {"breakaway": 20.0, "velocity": 0.01}},
    "presliding": {"coulomb_friction": {"force": 20.0}, "presliding": {"stiffness": 1e5, "damping": 300.0}},
    "asymmetric": {"asymmetric_friction": {"forward": 20.0, "backward": 5.0}},
}


@pytest.mark.parametrize("kind", STUCK)
def test_stuck_under_less_than_breakaway_does_not_creep_in_a_minute(kind: str) -> None:
    found = slide(contact(**STUCK[kind]), 5.0, 0.0, lambda t, q: 19.0 * min(t, 1.0), 60.0, 2e-3)
    settled = found[len(found) // 20 :, 0]
    assert np.ptp(settled) < 1e-9
    assert abs(settled[-1]) < 1e-3
    moving = slide(contact(**STUCK[kind]), 5.0, 0.0, lambda t, q: 21.0 * min(t, 1.0), 2.0, 1e-3)
    assert moving[-1, 0] > 0.05


@pytest.mark.parametrize("kind", STUCK)
def test_stick_slip_does_not_depend_on_the_time_step(kind: str) -> None:
    def pull(t: float, q: float) -> float:
        return 2000.0 * (0.04 * t - q)

    ends = [slide(contact(**STUCK[kind]), 5.0, 0.0, pull, 2.0, dt) for dt in (1e-3, 2.5e-4)]
    coarse, fine = ends[0][:, 0], ends[1][::4, 0]
    assert np.abs(coarse - fine).max() < 0.03 * np.ptp(fine)
    assert coarse[-1] == pytest.approx(fine[-1], abs=5e-4)


BENCH = """
name = "bench"
model = "bench.xml"
[supply]
pressure = "7 bar"
[cylinders.piston]
actuator = "piston"
bore = "32 mm"
rod = "12 mm"
stroke = "160 mm"
[cylinders.piston.valve]
area = "5 mm^2"
"""


@pytest.mark.parametrize(
    ("name", "where", "turning"),
    [
        (name, {"cylinder": "piston", "joint": "knee", "column": "piston.pressure_1"}.get(place, place), turning)
        for name in NAMES
        for place in declared()[name].places
        for turning in ((False, True) if place == "joint" else (False,))
    ]
    + [("sensor_bias", "knee.position", True), ("sensor_bias", "slide.position", False)],
)
def test_rig_text_round_trips(name: str, where: str, turning: bool, repository: Path) -> None:
    path = repository / "assets" / "bench.toml"
    effect = declared()[name]
    single = {p.name: float(f"{typical(p):.7g}") for p in effect.parameters if not p.most}
    curves = {p.name: tuple(float(f"{v:.7g}") for v in np.atleast_1d(typical(p))) for p in effect.parameters if p.most}
    setting = EffectSetting(name, where, single, turning, curves)
    settings = [setting]
    if effect.requires:
        settings.append(EffectSetting(effect.requires, where, {"conductance": 1.0}))
    intervals = {key: (0.9 * value, 1.1 * value) for key, value in single.items()}
    text = improved(parse(BENCH, path), [EffectEntry(s, intervals if s is setting else {}, "Found.") for s in settings], [], path.parent)
    again = parse(text, path)
    assert again.effect(name, where) == setting
    assert improved(again, [EffectEntry(setting)], [], path.parent) == text


def test_a_joint_record_knows_every_effect_of_joints() -> None:
    for name, effect in declared().items():
        assert (name in (JOINT.names or ())) == ("joint" in effect.places)
