"""How fast a valve controller makes a cylinder follow a force: frequency response, piston held still."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.valve_control import MODEL, PI, ValveGains, invert, pi
from exo_sim.physics import nodes, state
from exo_sim.physics.compiled import kernel
from exo_sim.physics.forces import rod_forces
from exo_sim.physics.plant import FOLLOWED, step
from exo_sim.physics.pneumatics import Pneumatics
from exo_sim.physics.transmission import gives
from exo_sim.rig import Rig, assembly

_PERIODS, _SETTLING = 12, 4


def response(
    rig: Rig,
    cylinder: str,
    controller: int,
    frequency: NDArray[np.float64],
    amplitude: float,
    gains: ValveGains | None = None,
    dt: float = 1e-3,
) -> NDArray[np.complex128]:
    """Return force over demanded force at each frequency, the piston held at mid-stroke.

    Args:
        rig: The machine.
        cylinder: Which of its cylinders.
        controller: `PI` or `MODEL`.
        frequency: Of the demand, a sine about zero force [Hz], shape (n,).
        amplitude: Of the demand [N].
        gains: Of the controllers.
        dt: Sample time of the controller [s].
    """
    gains = gains or ValveGains()
    index = list(rig.cylinders).index(cylinder)
    records = assembly.cylinders(rig)[index : index + 1]
    world = assembly.world(rig)
    world["tank_volume"] = 0.0  # one cylinder by itself
    c, w = records[0], world[0]
    x = np.array([0.5 * c["stroke"]])
    scale = float((w["supply_pressure"] - w["atmosphere"]) * c["area_1"])
    half = 0.5 * float(w["supply_pressure"] + w["atmosphere"])
    on_rod = float(w["atmosphere"] * (c["area_1"] - c["area_2"]))
    how = (controller, scale, gains.proportional, gains.integral, gains.closing_time)
    out = np.empty(len(frequency), dtype=np.complex128)
    for i, f in enumerate(frequency):
        gas = Pneumatics(world, records, dt=dt)
        balanced = (half * float(c["area_1"]) - on_rod) / float(c["area_2"])
        gas.fill(x, half, min(balanced, float(w["supply_pressure"])))
        steps = round(_PERIODS / f / dt)
        time = np.arange(steps) * dt
        wanted, force, command = amplitude * np.sin(2 * np.pi * f * time), np.empty(steps), np.zeros(1)
        code = _follow(
            gas.world, gas.cylinders, gas.joints, gas.vector, gas.history, x, wanted, how, dt, gas._work, gas._scratch, command, force,
        )  # fmt: skip
        if code != FOLLOWED:
            raise gas.refused(code, x, x, command)
        use = time >= _SETTLING / f
        turn = np.exp(-2j * np.pi * f * time[use])
        out[i] = (force[use] @ turn) / (wanted[use] @ turn)
    return out


@kernel
def _follow(world, cylinders, joints, vector, history, x, wanted, how, dt, work, scratch, command, force):
    """Let a controller follow a force with the piston held at x, shape (1,).

    Args:
        world, cylinders, joints, vector, history, dt, work, scratch: As of `plant.step`, of one cylinder.
        wanted: Force at each step [N], shape (n,).
        how: Which controller, the largest force of the cylinder [N], and its gains.
        command: Written: the last command, shape (1,).
        force: Written: of the rod at the beginning of each step [N], shape (n,).

    Returns:
        `FOLLOWED`, or why a step was refused.
    """
    controller, scale, proportional, integral_gain, closing_time = how
    c, w = cylinders[0], world[0]
    still, none, found = np.zeros(1), np.zeros(0), np.zeros(1)
    integral, before = 0.0, 0.0
    for k in range(len(wanted)):
        found[0] = 0.0
        rod_forces(w, cylinders, vector, x, still, found)
        force[k] = found[0]
        error = wanted[k] - force[k]
        if controller == PI:
            command[0], integral = pi(error, scale, integral, proportional, integral_gain, dt)
        elif controller == MODEL:
            total = len(cylinders) * state.INTEGRATED + state.SHARED
            at = vector[total + state.PISTON] if gives(c) else x[0]
            p_1, p_2 = nodes.pressures(w, c, vector, 0, at)
            t_1, t_2 = nodes.temperatures(w, vector, 0)
            v_1, v_2 = nodes.volumes(c, x[0])
            opening = invert(
                (wanted[k] - before) / dt + error / closing_time, 0.0, p_1, t_1, p_2, t_2, v_1, v_2,
                c.area_1, c.area_2, c.valve_area, w.supply_pressure, w.supply_temperature, w.exhaust_pressure, w.ambient, w.k, w.r,
            )  # fmt: skip
            command[0] = min(max(opening, -1.0), 1.0)
        before = wanted[k]
        code = step(w, cylinders, joints, vector, history, x, x, none, none, command, dt, work, scratch)
        if code != FOLLOWED:
            return code
    return FOLLOWED


def bandwidth(frequency: NDArray[np.float64], values: NDArray[np.complex128]) -> float:
    """Return the lowest frequency [Hz] at which the gain is 3 dB down or the phase 90 degrees late, interpolated.

    NaN where neither happens within the frequencies given.
    """
    gain = np.abs(values)
    late = -np.degrees(np.unwrap(np.angle(values)))
    beyond = np.maximum(np.sqrt(0.5) / np.maximum(gain, 1e-9), late / 90.0)
    over = np.flatnonzero(beyond >= 1.0)
    if len(over) == 0:
        return float("nan")
    if over[0] == 0:
        return float(frequency[0])
    i = int(over[0])
    part = (1.0 - beyond[i - 1]) / (beyond[i] - beyond[i - 1])
    return float(frequency[i - 1] * (frequency[i] / frequency[i - 1]) ** part)
