"""A bench on paper: the cylinder, load and supply as built, and the rig and MJCF its owner writes down."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from exo_sim.trials.truth.machine import GRAVITY, Machine

#: bore, rod, stroke [m] of catalogue cylinders (ISO 6432 and ISO 15552 sizes).
CATALOGUE = (
    (0.025, 0.010, 0.100),
    (0.025, 0.010, 0.160),
    (0.032, 0.012, 0.160),
    (0.032, 0.012, 0.200),
    (0.040, 0.016, 0.160),
)
CYLINDER, JOINT = "piston", "slide"


@dataclass(frozen=True)
class Bench:
    """One cylinder on one slide. SI.

    Attributes:
        bore, rod, stroke, dead_1, dead_2: Cylinder.
        valve_area: Throat area of each path at full command.
        supply, ambient, temperature: Supply and ambient pressure (absolute), temperature of both.
        mass: Everything that moves.
        upright: True where the rod pushes the load up.
        damping: Viscous damping that the MJCF holds.
        spring, spring_rest: Known spring on the slide and its rest position, in piston coordinates.
        zero: Piston position at joint position 0.
        known: Effects that the owner has already put into the rig: (name, where) to parameters.
    """

    bore: float
    rod: float
    stroke: float
    dead_1: float
    dead_2: float
    valve_area: float
    supply: float
    ambient: float
    temperature: float
    mass: float
    upright: bool
    damping: float
    spring: float = 0.0
    spring_rest: float = 0.0
    zero: float = 0.0
    known: Mapping[tuple[str, str], Mapping[str, float]] = field(default_factory=dict)

    model_file = "bench.xml"

    def plain(self) -> dict[str, object]:
        """Return everything as plain numbers and text."""
        entries = {key: value for key, value in vars(self).items() if key != "known"}
        return {**entries, "known": {f"{name}.{where}": dict(p) for (name, where), p in self.known.items()}}

    @property
    def area_1(self) -> float:
        """Piston area of chamber 1 [m^2]."""
        return math.pi / 4 * self.bore**2

    @property
    def area_2(self) -> float:
        """Piston area of chamber 2 [m^2]."""
        return math.pi / 4 * (self.bore**2 - self.rod**2)

    @property
    def volume(self) -> float:
        """Volume of one chamber at half stroke [m^3]."""
        return 0.5 * (self.dead_1 + self.dead_2 + self.area_1 * self.stroke)

    @property
    def stall(self) -> float:
        """Supply pressure times piston area [N], a scale for forces."""
        return self.supply * self.area_1

    @property
    def full_speed(self) -> float:
        """About how fast the load moves at full command [m/s]."""
        return self.valve_area * 0.0404 * 287.0 * math.sqrt(self.temperature) / (0.75 * self.area_1)

    @property
    def gas_stiffness(self) -> float:
        """About how stiff the gas is at half stroke [N/m]."""
        return 1.4 * 0.6 * self.supply * (self.area_1**2 + self.area_2**2) / self.volume

    def machine(self) -> Machine:
        """Return the true machine with nothing hidden: the bench and the effects its owner knows."""
        values = {
            "ambient_pressure": self.ambient,
            "ambient_temperature": self.temperature,
            "supply_pressure": self.supply,
            "supply_temperature": self.temperature,
            "area_1": self.area_1,
            "area_2": self.area_2,
            "stroke": self.stroke,
            "dead_1": self.dead_1,
            "dead_2": self.dead_2,
            "valve_area": self.valve_area,
            "load_mass": self.mass,
            "gravity": GRAVITY if self.upright else 0.0,
            "spring_stiffness": self.spring,
            "spring_rest": self.spring_rest,
            "damping": self.damping,
            "piston_mass": 0.03 * self.mass,
        }
        machine = Machine(values)
        for (name, _), parameters in self.known.items():
            machine = machine.with_(**KNOWN[name](parameters))
        return machine

    def rig(self) -> str:
        """Return rig.toml as the owner of this bench writes it."""
        lines = [
            'name  = "bench"',
            'model = "bench.xml"',
            "",
            "[environment]",
            f'pressure    = "{self.ambient:.0f} Pa"',
            f'temperature = "{self.temperature:.2f} K"',
            "",
            "[supply]",
            f'pressure    = "{self.supply / 1e5:.6g} bar"',
            f'temperature = "{self.temperature:.2f} K"',
            "",
            f"[cylinders.{CYLINDER}]",
            f'actuator         = "{CYLINDER}"',
            f'bore             = "{self.bore * 1e3:.6g} mm"',
            f'rod              = "{self.rod * 1e3:.6g} mm"',
            f'stroke           = "{self.stroke * 1e3:.6g} mm"',
            f'retracted_length = "{-self.zero:.6g} m"',
            f'dead_volume_1    = "{self.dead_1 * 1e6:.5g} cm^3"',
            f'dead_volume_2    = "{self.dead_2 * 1e6:.5g} cm^3"',
            'acting           = "double"',
            "",
            f"[cylinders.{CYLINDER}.valve]",
            f'area = "{self.valve_area * 1e6:.5g} mm^2"',
        ]
        for (name, where), parameters in self.known.items():
            lines += ["", f"[effects.{name}.{where}]"]
            lines += [f"{key} = {quantity(value, KNOWN_UNITS[name, key])}" for key, value in parameters.items()]
        return "\n".join(lines) + "\n"

    def model(self) -> str:
        """Return bench.xml, the MJCF of the load."""
        axis = "0 0 1" if self.upright else "1 0 0"
        low, high = -self.zero, self.stroke - self.zero
        spring = f' stiffness="{self.spring:.6g}" springref="{self.spring_rest - self.zero:.6g}"' if self.spring else ""
        return f"""<mujoco model="bench">
  <option timestep="0.001" gravity="0 0 -{GRAVITY}" integrator="implicitfast"/>
  <worldbody>
    <geom name="bed" type="box" size="0.4 0.05 0.01" pos="0 0 -0.1" contype="0" conaffinity="0"/>
    <body name="carriage">

            <joint name="{JOINT}" type="slide" axis="{axis}" range="{low:.6g} {high:.6g}" limited="true"
             damping="{self.damping:.6g}"{spring}/>
      <geom name="payload" type="box" size="0.05 0.04 0.04" mass="{self.mass:.6g}" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="{CYLINDER}" joint="{JOINT}"/>
  </actuator>
</mujoco>
"""


#: What a known effect means for the true machine.
KNOWN = {
    "wall_heat_transfer": lambda p: {"heat_conductance": p["conductance"]},
    "coulomb_friction": lambda p: {"coulomb": p["force"]},
    "viscous_friction": lambda p: {"viscous": p["coefficient"]},
}
KNOWN_UNITS = {
    ("wall_heat_transfer", "conductance"): "W/K",
    ("coulomb_friction", "force"): "N",
    ("viscous_friction", "coefficient"): "N*s/m",
}


def quantity(value: float, unit: str) -> str:
    """Return a value as TOML text with its unit."""
    return f"{value:.6g}" if unit == "1" else f'"{value:.6g} {unit}"'


def draw_bench(rng: np.random.Generator, known: tuple[str, ...] = ()) -> Bench:
    """Draw a bench as built.

    Args:
        rng: Chance.
        known: Effects that it has and that its owner knows: any of `KNOWN`.
    """
    bore, rod, stroke = CATALOGUE[rng.integers(len(CATALOGUE))]
    area = math.pi / 4 * bore**2
    scale = area / 8.04e-4
    supply = round(rng.uniform(5.5e5, 8e5), -4)
    mass = round(rng.uniform(5.0, 14.0) * scale, 2)
    kind = rng.choice(["horizontal", "vertical", "spring"])
    speed = rng.uniform(0.5, 1.1)
    dead_1, dead_2 = rng.uniform(0.08, 0.2, 2) * area * stroke
    bench = Bench(
        bore,
        rod,
        stroke,
        round(dead_1, 8),
        round(dead_2, 8),
        valve_area=round(speed * 0.75 * area / (0.0404 * 287.0 * math.sqrt(293.15)), 9),
        supply=supply,
        ambient=101325.0,
        temperature=293.15,
        mass=mass,
        upright=kind == "vertical",
        damping=0.0,
        spring=round(rng.uniform(0.03, 0.1) * supply * area / stroke * 4, 0) if kind == "spring" else 0.0,
        spring_rest=round(rng.uniform(0.3, 0.6) * stroke, 3),
        zero=float(rng.choice([0.0, 0.5])) * stroke,
    )
    natural = math.sqrt(bench.gas_stiffness / mass)
    bench = replace(bench, damping=round(2 * rng.uniform(0.04, 0.1) * natural * mass, 1))
    values = {
        ("wall_heat_transfer", CYLINDER): {"conductance": rng.uniform(0.5, 1.1) * 0.5 * bench.volume / 7e-5},
        ("coulomb_friction", CYLINDER): {"force": rng.uniform(0.02, 0.035) * bench.stall},
        ("viscous_friction", CYLINDER): {"coefficient": rng.uniform(0.3, 0.8) * bench.damping},
    }
    return replace(bench, known={key: value for key, value in values.items() if key[0] in known})


def believed(
    bench: Bench,
    rng: np.random.Generator,
    area: float = 0.02,
    dead: float = 0.05,
    mass: float = 0.005,
    effects: float = 0.01,
) -> Bench:
    """Return the bench as a careful laboratory believes it: relative errors drawn with these standard deviations."""
    errors = np.clip(rng.standard_normal(4), -2.2, 2.2)
    known = {
        key: {
            name: value * (1 + effects * float(np.clip(rng.standard_normal(), -2.2, 2.2)))
            for name, value in entry.items()
        }
        for key, entry in bench.known.items()
    }
    return replace(
        bench,
        valve_area=bench.valve_area * (1 + area * errors[0]),
        dead_1=bench.dead_1 * (1 + dead * errors[1]),
        dead_2=bench.dead_2 * (1 + dead * errors[2]),
        mass=bench.mass * (1 + mass * errors[3]),
        known=known,
    )
