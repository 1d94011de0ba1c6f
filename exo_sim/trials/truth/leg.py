"""A walking leg: hip and knee led along recorded angles, a cylinder across each, its valve following a force.

Lengths come from plane geometry here; the MJCF that goes with the case says the same with tendons.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.trials.truth.bench import CYLINDER, Bench, quantity
from exo_sim.trials.truth.drive import Truth
from exo_sim.trials.truth.loop import run_led
from exo_sim.trials.truth.machine import Machine
from exo_sim.trials.truth.state import LOG, STATES, at_rest

Array = NDArray[np.float64]

JOINTS = ("hip_r", "knee_r")
#: Base on the upper body and rod end on the lower one, (forward, up) from the joint at joint angle 0 [m].
ATTACHMENTS = {
    "hip_r": ((-0.04, -0.06), (0.08, -0.36)),
    "knee_r": ((-0.06, 0.33), (-0.03, -0.06)),
}
THIGH, SHANK = 0.44, 0.369
#: Mean stride, A. Falisse, 3dpredictsim, subject 1 (MIT licence): mean, cosine and sine amplitudes [rad].
STRIDE = {
    "hip_r": (0.1766, (0.3813, -0.0661, -0.0160, 0.0031), (-0.0034, -0.0418, 0.0221, -0.0009)),
    "knee_r": (-0.5115, (-0.0295, 0.2843, 0.0383, 0.0011), (0.2909, -0.0608, -0.0763, -0.0089)),
}
PERIOD = 1.0466
#: bore, rod, stroke, length at X = 0 [m], force wanted (mean, amplitude) [N].
CYLINDERS = {
    "hip_r": (0.050, 0.020, 0.150, 0.293, (500.0, 350.0)),
    "knee_r": (0.040, 0.016, 0.125, 0.273, (350.0, 300.0)),
}


@dataclass(frozen=True)
class Leg:
    """Cylinders of one leg, by joint.

    Each is a `Bench` of which only the pneumatics count; its `zero` is minus the length at X = 0.
    """

    cylinders: Mapping[str, Bench]
    model_file = "leg.xml"

    def plain(self) -> dict[str, object]:
        """Return everything as plain numbers and text."""
        return {joint: bench.plain() for joint, bench in self.cylinders.items()}

    def rig(self) -> str:
        """Return rig.toml as the owner writes it."""
        first = next(iter(self.cylinders.values()))
        lines = [
            'name  = "leg"',
            'model = "leg.xml"',
            "",
            "[environment]",
            f'pressure    = "{first.ambient:.0f} Pa"',
            f'temperature = "{first.temperature:.2f} K"',
            "",
            "[supply]",
            f'pressure    = "{first.supply / 1e5:.6g} bar"',
            f'temperature = "{first.temperature:.2f} K"',
        ]
        effects = []
        for name, bench in self.cylinders.items():
            lines += [
                "",
                f"[cylinders.{name}]",
                f'actuator         = "{name}"',
                f'bore             = "{bench.bore * 1e3:.6g} mm"',
                f'rod              = "{bench.rod * 1e3:.6g} mm"',
                f'stroke           = "{bench.stroke * 1e3:.6g} mm"',
                f'retracted_length = "{-bench.zero * 1e3:.6g} mm"',
                f'dead_volume_1    = "{bench.dead_1 * 1e6:.5g} cm^3"',
                f'dead_volume_2    = "{bench.dead_2 * 1e6:.5g} cm^3"',
                'acting           = "double"',
                "",
                f"[cylinders.{name}.valve]",
                f'area = "{bench.valve_area * 1e6:.5g} mm^2"',
            ]
            for (effect, _), parameters in bench.known.items():
                effects += ["", f"[effects.{effect}.{name}]"]
                effects += [f"{key} = {quantity(value, _UNITS[effect])}" for key, value in parameters.items()]
        return "\n".join(lines + effects) + "\n"

    def model(self) -> str:
        """Return leg.xml: a leg on a fixed torso, its cylinders as tendons."""

        def site(name: str, place: tuple[float, float], drop: float = 0.0) -> str:
            return f'<site name="{name}" pos="{place[0]:.4g} 0 {place[1] + drop:.4g}"/>'

        hip, knee = ATTACHMENTS["hip_r"], ATTACHMENTS["knee_r"]
        return f"""<mujoco model="leg">
  <option timestep="0.001" integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/><joint axis="0 -1 0"/></default>
  <worldbody>
    <body name="torso" pos="0 0 0.95">
      <geom type="capsule" fromto="0 0 0 0 0 0.45" size="0.08" mass="8"/>
      {site("hip_r_base", hip[0])}
      <body name="thigh_r">
        <joint name="hip_r" range="-32 112"/>
        <geom type="capsule" fromto="0 0 0 0 0 {-THIGH}" size="0.04" mass="2.8"/>
        {site("hip_r_rod", hip[1])}
        {site("knee_r_base", knee[0], -THIGH)}
        <body name="shank_r" pos="0 0 {-THIGH}">
          <joint name="knee_r" range="-115 8"/>
          <geom type="capsule" fromto="0 0 0 0 0 {-SHANK}" size="0.03" mass="2.0"/>
          {site("knee_r_rod", knee[1])}
          <geom type="box" pos="0.045 0 {-SHANK - 0.04}" size="0.09 0.04 0.02" mass="1.2"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="hip_r"><site site="hip_r_base"/><site site="hip_r_rod"/></spatial>
    <spatial name="knee_r"><site site="knee_r_base"/><site site="knee_r_rod"/></spatial>
  </tendon>
  <actuator>
    <motor name="hip_r" tendon="hip_r"/>
    <motor name="knee_r" tendon="knee_r"/>
  </actuator>
</mujoco>
"""


_UNITS = {"wall_heat_transfer": "W/K", "coulomb_friction": "N", "viscous_friction": "N*s/m"}


def length(joint: str, angle: Array) -> Array:
    """Return the distance from base to rod end [m] at joint angles [rad], hip flexion and knee extension positive."""
    (bx, bz), (rx, rz) = ATTACHMENTS[joint]
    x = rx * np.cos(angle) - rz * np.sin(angle) - bx
    z = rx * np.sin(angle) + rz * np.cos(angle) - bz
    return np.hypot(x, z)


def gait(time: Array, rng: np.random.Generator) -> tuple[dict[str, Array], NDArray[np.int64]]:
    """Return joint angles [rad] and where the wearer stands still (1), shape (n,).

    Stands, walks, stands, walks at another cadence, stands; strides differ in length and amplitude as people's do.
    """
    span = time[-1] - time[0] + 1e-9
    share = (time - time[0]) / span
    edges = np.cumsum([0.08, 0.38, 0.12, 0.32, 0.10])
    standing = (share < edges[0]) | ((share >= edges[1]) & (share < edges[2])) | (share >= edges[3])
    steps = np.diff(time, append=time[-1])
    # the strength of walking comes and goes over 0.4 s
    strength, target = np.empty(len(time)), np.where(standing, 0.0, 1.0)
    state = np.zeros(2)
    for i, h in enumerate(steps):
        state += np.minimum(h / 0.12, 1.0) * np.array([target[i] - state[0], state[0] - state[1]])
        strength[i] = state[1]
    cadence = np.where(share < edges[1], rng.uniform(0.8, 1.05), rng.uniform(0.9, 1.2)) / PERIOD
    beats = np.arange(time[0], time[-1] + 2, 1.1)
    sway = np.interp(time, beats, rng.normal(0, 0.03, len(beats)))
    phase = 2 * np.pi * np.cumsum(cadence * (1 + sway) * steps)
    angles = {}
    for joint, (mean, cosine, sine) in STRIDE.items():
        wave = sum(c * np.cos(k * phase) + s * np.sin(k * phase) for k, (c, s) in enumerate(zip(cosine, sine), 1))
        rest = 0.1 * mean
        slow = rng.normal(0, 0.01) * np.sin(2 * np.pi * 0.21 * time + rng.uniform(0, 6))
        angles[joint] = rest + strength * (mean - rest + (1 + 2 * sway) * wave) + slow
    closed = (standing & (strength < 0.02)).astype(np.int64)
    return angles, closed


def draw_leg(rng: np.random.Generator, known: tuple[str, ...] = ()) -> Leg:
    """Draw a leg as built; `known` as in `bench.draw_bench`."""
    supply = round(rng.uniform(9e5, 14e5), -4)
    cylinders = {}
    for joint, (bore, rod, stroke, retracted, _) in CYLINDERS.items():
        area = math.pi / 4 * bore**2
        bench = Bench(
            bore,
            rod,
            stroke,
            round(float(rng.uniform(0.05, 0.12)) * area * stroke, 8),
            round(float(rng.uniform(0.05, 0.12)) * area * stroke, 8),
            valve_area=round(float(rng.uniform(3e-6, 6e-6)) * area / 1.26e-3, 9),
            supply=supply,
            ambient=101325.0,
            temperature=293.15,
            mass=6.0,
            upright=False,
            damping=60.0,
            zero=-retracted,
        )
        values = {
            "wall_heat_transfer": {"conductance": float(rng.uniform(0.5, 1.1)) * 0.5 * bench.volume / 7e-5},
            "coulomb_friction": {"force": float(rng.uniform(0.01, 0.02)) * bench.stall},
            "viscous_friction": {"coefficient": float(rng.uniform(30, 80))},
        }
        entries = {(name, CYLINDER): parameters for name, parameters in values.items() if name in known}
        cylinders[joint] = Bench(**{**vars(bench), "known": entries})
    return Leg(cylinders)


def walk(
    leg: Leg, machines: Mapping[str, Machine], duration: float, rate: float, rng: np.random.Generator
) -> tuple[dict[str, Array], dict[str, Truth]]:
    """Walk, and return joint angles [rad], shape (n,), and the truth of each cylinder.

    Args:
        leg: As built.
        machines: True cylinders by joint, hidden things included.
        duration, rate: Length [s], ticks a second [Hz].
        rng: Chance.

    Raises:
        TrialError: a cylinder left the range of numbers that mean anything, or its stroke.
    """
    n = round(duration * rate)
    time = np.arange(n + 1) / rate
    angles, closed = gait(time, rng)
    truths = {}
    for joint, bench in leg.cylinders.items():
        machine = machines[joint]
        x = length(joint, angles[joint]) + bench.zero
        if x.min() < 0.0 or x.max() > bench.stroke:
            raise TrialError(f"{joint}: the gait leaves the stroke")
        v = np.gradient(x, time)
        mean, amplitude = CYLINDERS[joint][4]
        scale = rng.uniform(0.7, 1.2)
        goal = scale * (mean + amplitude * np.tanh(3 * (angles[joint] - angles[joint].mean()))[:n])
        dt = machine.step()
        ticks = np.full(n, round(1 / rate / dt), np.int64)
        # command per newton: closes a force error in about 60 ms at mid-stroke
        stiff = bench.gas_stiffness * bench.full_speed
        gains = np.array([16.0 / stiff, 40.0 / stiff, 0.8 / bench.full_speed])
        p2 = 0.5 * bench.supply
        p1 = (goal[0] + p2 * bench.area_2 + bench.ambient * (bench.area_1 - bench.area_2)) / bench.area_1
        record = machine.packed()
        y = at_rest(x[0], p1, p2, record[0])
        log = np.empty((n, len(LOG)))
        run_led(record, y, np.zeros(4), ticks, dt, x, v, closed[:n], goal, gains, log)
        truth = Truth({name: log[:, i] for i, name in enumerate(LOG)}, ticks, dt, np.empty((0, STATES + 5)))
        if not np.isfinite(log).all():
            raise TrialError(f"{joint}: a drawn cylinder diverged; draw it again with another --seed")
        truths[joint] = truth
    return {joint: angle[:n] for joint, angle in angles.items()}, truths
