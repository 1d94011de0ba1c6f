"""What the owner of a machine writes down: rig.toml and the MJCF."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from exo_sim.trials.whole_machines.draw import GRAVITY, Built

#: (name of the effect, where) to parameters: (value, unit).
Effects = Mapping[tuple[str, str], Mapping[str, tuple[float, str]]]


@dataclass(frozen=True)
class Owner:
    """A machine as somebody believes it to be. SI; geometry of a lever as in `machine.FIELDS`.

    Attributes:
        cylinder, joint, build: Names, and "slide", "upright" or "lever".
        bore, rod, stroke, dead_1, dead_2, valve_area, supply, ambient, room: The pneumatics.
        mass: What moves on a slide, or the lever's mass.
        inertia: Of the lever about its joint.
        centre, arm, base, angle, length: The lever.
        damping, zero: Of the joint; piston position at joint position 0.
        armature: What piston and rod add to the lever's inertia.
        single: Chamber 2 is open to the room.
        effects: Listed in the rig.
    """

    cylinder: str
    joint: str
    build: str
    bore: float
    rod: float
    stroke: float
    dead_1: float
    dead_2: float
    valve_area: float
    supply: float
    ambient: float
    room: float
    mass: float
    inertia: float
    centre: float
    arm: float
    base: float
    angle: float
    length: float
    damping: float
    zero: float
    armature: float = 0.0
    single: bool = False
    effects: Effects = field(default_factory=dict)

    model_file = "bench.xml"

    def plain(self) -> dict[str, object]:
        """Return everything as plain numbers and text."""
        entries = {key: value for key, value in vars(self).items() if key != "effects"}
        return {**entries, "effects": {f"{name}.{where}": {k: v for k, (v, _) in p.items()} for (name, where), p in self.effects.items()}}

    def rig(self) -> str:
        """Return rig.toml."""
        return "\n".join([*self.surroundings(f"{self.cylinder} rig"), *self.pneumatics(), *self.listed()]) + "\n"

    def surroundings(self, name: str) -> list[str]:
        """Return the lines before the cylinders."""
        return [
            f'name  = "{name}"',
            f'model = "{self.model_file}"',
            "",
            "[environment]",
            f'pressure    = "{self.ambient:.0f} Pa"',
            f'temperature = "{self.room:.2f} K"',
            "",
            "[supply]",
            f'pressure    = "{self.supply / 1e5:.6g} bar"',
            f'temperature = "{self.room:.2f} K"',
        ]

    def pneumatics(self) -> list[str]:
        """Return the lines of the cylinder and its valve."""
        retracted = self.length if self.build in ("lever", "legs") else -self.zero
        return [
            "",
            f"[cylinders.{self.cylinder}]",
            f'actuator         = "{self.cylinder}"',
            f'bore             = "{self.bore * 1e3:.6g} mm"',
            f'rod              = "{self.rod * 1e3:.6g} mm"',
            f'stroke           = "{self.stroke * 1e3:.6g} mm"',
            f'retracted_length = "{retracted:.6g} m"',
            f'dead_volume_1    = "{self.dead_1 * 1e6:.5g} cm^3"',
            f'dead_volume_2    = "{self.dead_2 * 1e6:.5g} cm^3"',
            f'acting           = "{"single" if self.single else "double"}"',
            "",
            f"[cylinders.{self.cylinder}.valve]",
            f'area = "{self.valve_area * 1e6:.5g} mm^2"',
        ]

    def listed(self) -> list[str]:
        """Return the lines of the effects."""
        lines = []
        for (name, where), parameters in self.effects.items():
            lines += ["", f"[effects.{name}.{where}]"]
            lines += [f"{key} = {quantity(value, unit)}" for key, (value, unit) in parameters.items()]
        return lines

    def model(self) -> str:
        """Return the MJCF of the load."""
        return self._lever() if self.build == "lever" else self._slide()

    def _slide(self) -> str:
        axis = "0 0 1" if self.build == "upright" else "1 0 0"
        return f"""<mujoco model="{self.joint}">
  <option timestep="0.0005" gravity="0 0 -{GRAVITY}" integrator="implicitfast"/>
  <worldbody>
    <geom name="bed" type="box" size="0.4 0.05 0.01" pos="0 0 -0.1" contype="0" conaffinity="0"/>
    <body name="load">
      <joint name="{self.joint}" type="slide" axis="{axis}" range="{-self.zero:.6g} {self.stroke - self.zero:.6g}" limited="true"
             damping="{self.damping:.6g}"/>
      <geom name="block" type="box" size="0.05 0.04 0.04" mass="{self.mass:.6g}" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
  <actuator><motor name="{self.cylinder}" joint="{self.joint}"/></actuator>
</mujoco>
"""

    def _lever(self) -> str:
        own = max(self.inertia - self.mass * self.centre**2, 1e-9)
        low, high = (math.degrees(self._angle_at(x)) for x in (0.0, self.stroke))
        bx, bz = self.base * math.cos(self.angle), -self.base * math.sin(self.angle)
        return f"""<mujoco model="{self.joint}">
  <option timestep="0.0005" gravity="0 0 -{GRAVITY}" integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <site name="base" pos="{bx:.8g} 0 {bz:.8g}"/>
    <body name="lever">
      <joint name="{self.joint}" type="hinge" axis="0 -1 0" range="{low:.5g} {high:.5g}" limited="true"
             damping="{self.damping:.6g}" armature="{self.armature:.6g}"/>
      <inertial pos="{self.centre:.6g} 0 0" mass="{self.mass:.6g}" diaginertia="{own:.6g} {own:.6g} {own:.6g}"/>
      <geom type="capsule" fromto="0 0 0 {1.2 * self.centre:.4g} 0 0" size="0.01"/>
      <site name="rod" pos="{self.arm:.8g} 0 0"/>
    </body>
  </worldbody>
  <tendon><spatial name="{self.cylinder}"><site site="base"/><site site="rod"/></spatial></tendon>
  <actuator><motor name="{self.cylinder}" tendon="{self.cylinder}"/></actuator>
</mujoco>
"""

    def _angle_at(self, x: float) -> float:
        """Return the lever's angle at a piston position, by the law of cosines."""
        length = self.length + x
        cosine = (self.arm**2 + self.base**2 - length**2) / (2 * self.arm * self.base)
        return math.acos(min(max(cosine, -1.0), 1.0)) - self.angle


def quantity(value: float, unit: str) -> str:
    """Return a value as TOML text with its unit."""
    return f"{value:.6g}" if unit == "1" else f'"{value:.6g} {unit}"'


def as_built(built: Built) -> Owner:
    """Return what an owner would write who knew every number and no effect."""
    m, make = built.machine, built.make
    bore = math.sqrt(4 * m["area_1"] / math.pi)
    hose = m["hose_volume"] if m["hose_kind"] == 1 else 0.25 * math.pi * m["hose_bore"] ** 2 * m["hose_length"]
    extra = hose if make.dead_with_hose and "hose" in built.hidden else 0.0
    return Owner(
        make.cylinder, make.joint, make.build, bore, math.sqrt(bore**2 - 4 * m["area_2"] / math.pi), m["stroke"],
        m["dead_1"] + extra, m["dead_2"] + extra, m["valve_area"], m["supply"], m["ambient"], m["room"],
        built.mass, m["inertia"], built.lever_centre, m["lever_arm"], m["lever_base"], m["lever_angle"], m["lever_length"],
        m["damping"], m["zero"], m["piston_mass"] * (0.95 * m["lever_arm"]) ** 2, m["single_acting"] > 0,
    )  # fmt: skip


def believed(built: Built, true: Owner, known: Effects, rng: np.random.Generator) -> Owner:
    """Return the machine as its owner believes it: data-sheet bore and rod, other numbers a few percent off."""

    def off(value: float, share: float) -> float:
        return value * (1 + share * float(np.clip(rng.standard_normal(), -2, 2)))

    weight = off(1.0, 0.015)
    effects = {
        where: {key: (off(value, 0.03) if key != "rest" else value, unit) for key, (value, unit) in parameters.items()}
        for where, parameters in known.items()
    }
    return replace(
        true,
        bore=built.bore,
        rod=built.rod,
        dead_1=off(true.dead_1, 0.08),
        dead_2=off(true.dead_2, 0.08),
        valve_area=off(true.valve_area, 0.04),
        supply=off(true.supply, 0.01),
        ambient=101325.0,
        mass=true.mass * weight,
        inertia=true.inertia * weight,
        effects=effects,
    )
