"""The step with every declared effect switched on, against the step with none."""

from __future__ import annotations

import mujoco

from benchmarks.figure import Asked, Figure, Said
from benchmarks.walking_machine import ROOT, Machine, quickest
from exo_sim import rig
from exo_sim.machine.rig_model import load
from exo_sim.physics.declaration import Effect, Parameter, declared
from exo_sim.rig import Rig

#: A curve has no typical value: a leak that follows the place of the piston.
CURVE = """
[effects.unknown.{where}]
acts = "flow_2"
depends_on = "position"
at = ["0 m", "60 mm", "120 mm"]
values = ["0 kg/s", "1e-6 kg/s", "-1e-6 kg/s"]
"""


def _number(parameter: Parameter, turning: bool) -> str:
    """Return a typical value as a rig file has it: the middle of the decades, or of what is above zero."""
    low, high = parameter.typical
    value = (low * high) ** 0.5 if low > 0.0 else 0.5 * high
    unit = parameter.unit_at(turning)
    return f"{value:.6g}" if unit == "1" else f'"{value:.6g} {unit}"'


def _table(effect: Effect, where: str, turning: bool = False) -> str:
    if effect.name == "unknown":
        return CURVE.format(where=where)
    lines = [f"[effects.{effect.name}.{where}]"]
    for parameter in effect.parameters:
        number = f'"{parameter.choices[0]}"' if parameter.choices else _number(parameter, turning)
        name = "torque" if turning and parameter.name == "force" else parameter.name
        lines.append(f"{name} = {number}")
    return "\n" + "\n".join(lines) + "\n"


def everything_on(machine: Rig) -> str:
    """Return the text of every effect that the simulator has, with typical values, at every part that can have it.

    What another effect at the same part says already goes to a joint of its own name, or is left out. So are the sensors' effects: they
    act on a recording, not on a step.
    """
    effects = [effect for effect in declared().values() if effect.places != ("column",)]
    absorbed = {name for effect in effects for name, _ in effect.absorbs}
    model = load(machine)
    every = [model.joint(i) for i in range(model.njnt)]
    joints = {joint.name: bool(joint.type[0] == mujoco.mjtJoint.mjJNT_HINGE) for joint in every if joint.name not in machine.cylinders}
    text = ""
    for effect in effects:
        if "cylinder" in effect.places and effect.name not in absorbed:
            text += "".join(_table(effect, name) for name in machine.cylinders)
        elif "joint" in effect.places:
            text += "".join(_table(effect, name, turning) for name, turning in joints.items())
        elif "cylinder" not in effect.places:
            text += _table(effect, effect.places[0])
    return text


def ratio(name: str, start: float | None = None) -> tuple[float, int]:
    """Return how much longer the step takes with everything on, and how many effects that are."""
    path = ROOT / "assets" / name
    plain = rig.read(path)
    full = rig.parse(path.read_text() + everything_on(plain), path)
    machines = {"none": Machine(plain, start), "all": Machine(full, start)}
    for machine in machines.values():
        machine.record()
    taken = quickest({kind: machine.from_python for kind, machine in machines.items()})
    return taken["all"] / taken["none"], len({effect.name for effect in full.effects})


def measure(asked: Asked) -> Said:
    """Measure the step of the walking machine and of the bench, whose bare step costs next to nothing."""
    walking, count = ratio("exo.toml")
    bench, _ = ratio("bench.toml", 0.08)
    return [
        Figure("effects_on", "effects switched on", count, "{:.0f}"),
        Figure("all_effects_ratio", "step with all of them, walking machine", walking, "{:.2f} times none", below=2.0),
        Figure("all_effects_ratio_bench", "step with all of them, bench", bench, "{:.2f} times none", below=2.0),
    ]
