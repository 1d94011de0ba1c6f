"""Where the cylinders of a worn machine sit, and its MJCF."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.trials.whole_machines.draw import GRAVITY
from exo_sim.trials.whole_machines.owner_rig import Owner
from exo_sim.trials.whole_machines.walk.gait import JOINTS, RANGE

Array = NDArray[np.float64]

THIGH, SHANK = 0.42, 0.40
#: Base on the upper body and rod end on the lower one: forward and up from the joint at joint angle 0 [m].
ATTACHMENTS = {
    "hip": ((complex(-0.12, 0.02), complex(-0.08, -0.30)), (complex(-0.11, 0.10), complex(-0.07, -0.24))),
    "knee": ((complex(-0.05, 0.30), complex(-0.06, -0.05)), (complex(-0.07, 0.30), complex(-0.03, -0.09))),
}


@dataclass(frozen=True)
class Seat:
    """Where a cylinder sits.

    Attributes:
        base, rod: Places of its ends, forward + i up from the joint [m].
    """

    base: complex
    rod: complex

    def length(self, angle: Array) -> Array:
        """Return the distance between the ends [m] at joint angles [rad], shape (n,)."""
        return np.abs(self.rod * np.exp(1j * angle) - self.base)


def draw_seats(rng: np.random.Generator) -> dict[str, Seat]:
    """Return a seat for each joint, both legs alike."""
    seats = {}
    for joint, pairs in ATTACHMENTS.items():
        base, rod = pairs[int(rng.integers(len(pairs)))]
        base += complex(*rng.normal(0, 0.004, 2))
        rod += complex(*rng.normal(0, 0.004, 2))
        for name in JOINTS:
            if name.startswith(joint):
                seats[name] = Seat(base, rod)
    return seats


def reach(name: str, seat: Seat) -> tuple[float, float]:
    """Return the shortest and longest length that any gait asks of a seat [m]."""
    lengths = seat.length(np.linspace(*RANGE[name.partition("_")[0]], 200))
    return float(lengths.min()), float(lengths.max())


@dataclass(frozen=True)
class WornOwner:
    """A worn machine as somebody believes it to be.

    Attributes:
        cylinders: By joint.
        seats: By joint.
    """

    cylinders: Mapping[str, Owner]
    seats: Mapping[str, Seat]

    model_file = "legs.xml"

    def plain(self) -> dict[str, object]:
        """Return everything as plain numbers and text."""
        return {name: one.plain() for name, one in self.cylinders.items()}

    def rig(self) -> str:
        """Return rig.toml."""
        first = next(iter(self.cylinders.values()))
        lines = [line.replace(first.model_file, self.model_file) for line in first.surroundings("legs")]
        lines += [line for one in self.cylinders.values() for line in one.pneumatics()]
        lines += [line for one in self.cylinders.values() for line in one.listed()]
        return "\n".join(lines) + "\n"

    def model(self) -> str:
        """Return the MJCF: legs that hang from a fixed pelvis, cylinders as tendons."""
        legs = "".join(self._leg(side) for side in ("r", "l"))
        tendons = "".join(
            f'    <spatial name="{name}"><site site="{name}_base"/><site site="{name}_rod"/></spatial>\n' for name in self.cylinders
        )
        motors = "".join(f'    <motor name="{name}" tendon="{name}"/>\n' for name in self.cylinders)
        return f"""<mujoco model="legs">
  <option timestep="0.001" gravity="0 0 -{GRAVITY}" integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/><joint axis="0 -1 0"/></default>
  <worldbody>
    <body name="pelvis" pos="0 0 0.95">
      <geom type="box" size="0.06 0.15 0.05" mass="6"/>
{legs}    </body>
  </worldbody>
  <tendon>
{tendons}  </tendon>
  <actuator>
{motors}  </actuator>
</mujoco>
"""

    def _leg(self, side: str) -> str:
        y = -0.09 if side == "r" else 0.09
        hip, knee = f"hip_{side}", f"knee_{side}"
        return f"""      {self._site(hip, "base", y=y)}
      <body name="thigh_{side}" pos="0 {y} 0">
        <joint name="hip_{side}" range="-60 100"/>
        <geom type="capsule" fromto="0 0 0 0 0 {-THIGH}" size="0.05" mass="8"/>
        {self._site(hip, "rod")}
        {self._site(knee, "base", up=-THIGH)}
        <body name="shank_{side}" pos="0 0 {-THIGH}">
          <joint name="knee_{side}" range="-130 20"/>
          <geom type="capsule" fromto="0 0 0 0 0 {-SHANK}" size="0.04" mass="4.5"/>
          {self._site(knee, "rod")}
        </body>
      </body>
"""

    def _site(self, name: str, end: str, y: float = 0.0, up: float = 0.0) -> str:
        if name not in self.seats:
            return ""
        place = getattr(self.seats[name], end)
        return f'<site name="{name}_{end}" pos="{place.real:.8g} {y:.4g} {place.imag + up:.8g}"/>'
