"""A cylinder in Cantera: chambers and hoses are ideal-gas reactors, what passes between them flow devices, pistons and walls `Wall`s.

Air is O2, N2 and Ar with NASA's polynomials, so its heat capacity depends on temperature. Piston and spool are states of the first
chamber (`ExtensibleIdealGasReactor`), so that CVODES integrates gas, piston and valve as one system with its own error control. The
command is a continuous function of time, as an analogue controller makes it: nothing is ever set between two steps, so that the
integrator starts once and not at each sample.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.trials.whole_machines.gas_laws import ELLIPSE, NOZZLE, orifice
from exo_sim.trials.whole_machines.loop import LOG
from exo_sim.trials.whole_machines.machine import FIELDS, Machine
from exo_sim.trials.whole_machines.plant import opening

Array = NDArray[np.float64]
AIR = "O2:0.2095, N2:0.7812, AR:0.0093"
#: Error control of CVODES, and its longest step [s].
_RELATIVE, _ABSOLUTE, _LONGEST = 1e-7, 1e-12, 4e-3
_X, _V, _SPOOL = range(3)
#: Critical ratio of a sharp edge.
CRITICAL = 0.5282817877171742
#: The law itself, uncompiled: to hand a record to compiled code costs more than the law.
_passes: Callable[..., float] = orifice.py_func  # type: ignore[attr-defined]


def library() -> Any:
    """Return the module `cantera`.

    Raises:
        TrialError: it is not installed.
    """
    try:
        import cantera
    except ImportError:
        raise TrialError("--truth cantera needs the package cantera; pip install 'exo-sim-pneumatic[truths]'") from None
    return cantera


def _signed(sign: float, flow: Callable[[Any, Any], float], left: Any, right: Any, time: float) -> float:
    """Return what passes one way [kg/s]; a controller takes less than nothing for nothing."""
    return sign * flow(left, right)


class Cylinder:
    """One cylinder, its valve and load.

    Args:
        machine: Numbers. Of friction it has Coulomb's (as a tanh of speed) and viscous, of hoses those of one volume each; spools are of
            first order, leaks sharp edges, heat goes through a constant conductance.
        steer: (time [s], piston position [m]) to the valve's command, -1 to 1.
        start: Piston position [m] and pressures [Pa] at rest.
    """

    def __init__(self, machine: Machine, steer: Callable[[float, float], float], start: tuple[float, float, float]) -> None:
        self._ct = library()
        self._m = m = {name: machine[name] for name in FIELDS}
        self._gas_numbers = SimpleNamespace(sonic=m["sonic"], heat_ratio=m["heat_ratio"])
        self._mass = machine.moved_mass
        self._steer = steer
        self.motion = np.array([start[0], 0.0, steer(0.0, start[0])])
        self.time = 0.0
        species = [one for one in self._ct.Species.list_from_file("air.yaml") if one.name in ("O2", "N2", "AR")]
        self._species = species
        supply, room = self._reservoir(m["supply"]), self._reservoir(m["ambient"])
        volumes = (m["dead_1"] + m["area_1"] * start[0], m["dead_2"] + m["area_2"] * (m["stroke"] - start[0]))
        self.chambers = (self._first(volumes[0], start[1]), self._reactor(volumes[1], start[2]))
        hose = m["hose_kind"] == 1.0
        self.ends = tuple(self._reactor(m["hose_volume"], p) for p in start[1:]) if hose else self.chambers
        self._keep: list[Any] = []  # flow devices and walls live as long as somebody holds them
        for i, (chamber, end, sign) in enumerate(zip(self.chambers, self.ends, (1.0, -1.0)), 1):
            area = m[f"area_{i}"]
            wall = self._ct.Wall(chamber, room, A=area, U=m["heat_conductance"] / area)
            wall.velocity = self._speed(sign)
            self._keep.append(wall)
            self._link(supply, end, self._path(f"lap_s{i}", sign))
            self._link(end, room, self._path(f"lap_e{i}", -sign))
            if hose:
                self._link(end, chamber, self._orifice(m["hose_area"], m["hose_b"]))
            if m[f"leak_{i}"] > 0:
                self._link(chamber, room, self._edge(m[f"leak_{i}"]))
        if m["leak_piston"] > 0:
            self._link(*self.chambers, self._edge(m["leak_piston"]))
        self._net = self._ct.ReactorNet(list(dict.fromkeys([*self.chambers, *self.ends])))
        self._net.rtol, self._net.atol, self._net.max_time_step = _RELATIVE, _ABSOLUTE, _LONGEST

    def run(self, times: Array) -> dict[str, Array]:
        """Return the log at times [s] that grow from 0, shape (n,): the columns of `whole_machines.loop.LOG`.

        Raises:
            TrialError: the integrator gave up.
        """
        log = np.zeros((len(times), len(LOG)))
        for row, time in enumerate(times):
            if time > 0.0:
                try:
                    self._net.advance(float(time))
                except self._ct.CanteraError as error:
                    raise TrialError(f"Cantera's integrator gave up at {time:.4g} s: {error}") from None
            log[row] = self._said(float(time))
        return {name: log[:, i] for i, name in enumerate(LOG)}

    def _said(self, time: float) -> list[float]:
        m, (x, v, _) = self._m, self.motion
        (p1, t1), (p2, t2) = ((one.phase.P, one.phase.T) for one in self.chambers)
        gas = p1 * m["area_1"] - p2 * m["area_2"] - m["ambient"] * (m["area_1"] - m["area_2"])
        position = x - m["zero"]
        rod = gas - self._friction(v)
        values = {
            "time": time, "position": position, "velocity": v, "command": self._steer(time, x), "pressure_1": p1, "pressure_2": p2,
            "valve_1": self.ends[0].phase.P, "valve_2": self.ends[1].phase.P, "supply": m["supply"], "exhaust": m["ambient"],
            "force": rod, "temperature_1": t1, "temperature_2": t2, "piston": x, "piston_speed": v, "gas_force": gas,
        }  # fmt: skip
        return [values[name] for name in LOG]

    def _friction(self, speed: float) -> float:
        m = self._m
        dry = m["coulomb"] * math.tanh(speed / m["smooth_speed"]) if m["coulomb"] > 0 else 0.0
        return dry + m["viscous"] * speed

    def _rates(self, time: float) -> tuple[float, float, float]:
        """Return the rates of position, speed and spool."""
        m, (x, v, spool) = self._m, self.motion
        p1, p2 = (one.phase.P for one in self.chambers)
        force = p1 * m["area_1"] - p2 * m["area_2"] - m["ambient"] * (m["area_1"] - m["area_2"])
        force -= self._friction(v) + m["damping"] * v + m["spring"] * (x - m["spring_rest"]) + m["gravity"]
        if x < 0.0:
            force += max(-m["stop_stiffness"] * x - m["stop_damping"] * v, 0.0)
        elif x > m["stroke"]:
            force -= max(m["stop_stiffness"] * (x - m["stroke"]) + m["stop_damping"] * v, 0.0)
        # a spool without a lag that counts follows within a twentieth of a millisecond: the equations stay ordinary ones
        return v, force / self._mass, (self._steer(time, x) - spool) / max(m["lag"], 5e-5)

    def _gas(self, pressure: float) -> Any:
        gas = self._ct.Solution(thermo="ideal-gas", species=self._species)
        gas.TPX = self._m["room"], pressure, AIR
        return gas

    def _reservoir(self, pressure: float) -> Any:
        return self._ct.Reservoir(self._gas(pressure), clone=False)

    def _reactor(self, volume: float, pressure: float) -> Any:
        return self._ct.IdealGasReactor(self._gas(pressure), volume=volume, energy="on", clone=False)

    def _first(self, volume: float, pressure: float) -> Any:
        """Return the first chamber, whose state ends with position, speed and spool."""
        cylinder = self

        class First(self._ct.ExtensibleIdealGasReactor):  # type: ignore[misc, name-defined]
            def after_initialize(self, t0: float) -> None:
                self.n_vars += 3

            def after_get_state(self, y: Array) -> None:
                np.asarray(y)[-3:] = cylinder.motion

            def before_update_state(self, y: Array) -> None:
                cylinder.motion = np.array(np.asarray(y)[-3:])

            def after_eval(self, t: float, lhs: Array, rhs: Array) -> None:
                np.asarray(rhs)[-3:] = cylinder._rates(t)

        return First(self._gas(pressure), volume=volume, energy="on", clone=False)

    def _link(self, left: Any, right: Any, flow: Callable[[Any, Any], float]) -> None:
        """Let gas pass both ways: two controllers, of which one stands still."""
        for a, b, sign in ((left, right, 1.0), (right, left, -1.0)):
            device = self._ct.MassFlowController(a, b)
            device.mass_flow_rate = partial(_signed, sign, flow, left.phase, right.phase)
            self._keep.append(device)

    def _speed(self, sign: float) -> Callable[[float], float]:
        return lambda time: sign * self.motion[_V]

    def _path(self, lap: str, sign: float) -> Callable[[Any, Any], float]:
        m = self._m

        def flow(a: Any, b: Any) -> float:
            area = m["valve_area"] * opening(sign * (self.motion[_SPOOL] + m["shift"]), m[lap], 1.0) + m["null_area"]
            return _passes(area, a.P, a.T, b.P, b.T, m["flow_law"], m["flow_b"], m["flow_m"], m["crack"], self._gas_numbers)

        return flow

    def _orifice(self, area: float, ratio: float) -> Callable[[Any, Any], float]:
        return lambda a, b: _passes(area, a.P, a.T, b.P, b.T, ELLIPSE, ratio, 0.5, 0.0, self._gas_numbers)

    def _edge(self, area: float) -> Callable[[Any, Any], float]:
        return lambda a, b: _passes(area, a.P, a.T, b.P, b.T, NOZZLE, CRITICAL, 0.5, 0.0, self._gas_numbers)
