"""A scenario, simulated: a person moves as recorded and wears the machine."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim import progress
from exo_sim.control import demand as law_of_demand
from exo_sim.control import machine_dynamics
from exo_sim.control.least_load import LeastLoad
from exo_sim.control.valve_control import CONTROLLERS, ValveGains, controller_code, largest_forces
from exo_sim.errors import Diverged, ModelError, ScenarioError, nearest
from exo_sim.gait import scenario as scenarios
from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.machine.build import PAYLOAD_LIMIT, build
from exo_sim.machine.linkage import check_strokes, moment_row
from exo_sim.machine.person import COORDINATES, SEGMENTS, Person, segment_poses
from exo_sim.machine.straps import StrapSet, fasten
from exo_sim.physics.pneumatics import Books
from exo_sim.rig import Rig
from exo_sim.simulation import loop
from exo_sim.simulation.native import address
from exo_sim.simulation.plugin import PneumaticPlugin

ASSIST = ("on", "off", "vented")
#: Time over which the demand grows from zero at the start [s].
RAMP = 0.5
_CHUNK = 100
#: A rehearsal leaves out so many cycles or so much time [s] at its start, and looks at so much time after that [s].
_SETTLING, _SETTLING_TIME, _LOOKED_AT = 2, 2.0, 1.5
JOINTS = COORDINATES[3:]
#: How far the machine may leave its wearer before the run counts as a fall.
_FALLEN_PITCH, _FALLEN_DISTANCE = 0.7, 0.35


@dataclass(frozen=True)
class Request:
    """What to simulate.

    Attributes:
        scenario: Its name.
        payload: On the back [kg].
        speed: Factor on the recorded cadence.
        cycles: How many strides or repetitions; None for the scenario's own number.
        assist: "on"; "off": valves closed, gas trapped; "vented": both chambers open to the atmosphere.
        controller: How valves get forces, one of `CONTROLLERS`.
        law: What is demanded, one of `control.demand.LAWS`.
        rehearsals: How often the least-load demand is bettered before the run.
        gains: Of the valve controllers.
        ideal: Forces come as demanded, without gas.

    Raises:
        ScenarioError: a name that does not exist or a number out of range.
    """

    scenario: str
    payload: float = 34.0
    speed: float = 1.0
    cycles: int | None = None
    assist: str = "on"
    controller: str = "model"
    law: str = law_of_demand.DEFAULT_LAW
    rehearsals: int = 5
    gains: ValveGains = field(default_factory=ValveGains)
    ideal: bool = False

    def __post_init__(self) -> None:
        scenarios.find(self.scenario)
        for name, value, choices in (
            ("assist", self.assist, ASSIST),
            ("controller", self.controller, CONTROLLERS),
            ("law", self.law, law_of_demand.LAWS),
        ):
            if value not in choices:
                raise ScenarioError(f'{name} "{value}"{nearest(value, choices)}')
        if self.cycles is not None and not 1 <= self.cycles <= 10000:
            raise ScenarioError(f"{self.cycles} cycles: ask for 1 to 10000")


@dataclass(frozen=True)
class Walk:
    """What was simulated.

    Attributes:
        request: What was asked for.
        rig: The machine.
        person: Who wore it.
        motion: The reference.
        straps: Between them.
        time: [s], shape (n,).
        columns: `"<part>.<signal>"` to values in SI, shape (n,).
        units: The same keys to SI units.
        poses: The person's segments at each row, shape (n, 7, 6).
        wrench: What the straps do to each of them, shape (n, 7, 3).
        weight: Of frame and payload at each row [N], shape (n,).
        payload: On the back at each row [kg], shape (n,).
        books: Of the gas, or None where there is none.
        step: Of the simulation [s].
        interrupted: True where Ctrl-C ended it early.
        model: The MuJoCo model, for drawing.
    """

    request: Request
    rig: Rig
    person: Person
    motion: Motion
    straps: StrapSet
    time: NDArray[np.float64]
    columns: dict[str, NDArray[np.float64]]
    units: dict[str, str]
    poses: NDArray[np.float64]
    wrench: NDArray[np.float64]
    weight: NDArray[np.float64]
    payload: NDArray[np.float64]
    books: Books | None
    step: float
    interrupted: bool
    model: mujoco.MjModel


def layout(rig: Rig, straps: StrapSet, gas: bool) -> list[tuple[str, str]]:
    """Return key and unit of every number that the loop logs behind the time, in its order."""
    names = ("torso_x", "torso_z", *COORDINATES[2:])
    kind = ["m", "m", *["rad"] * 7]
    out = [(f"{name}.position", unit) for name, unit in zip(names, kind)]
    out += [(f"{name}.velocity", f"{unit}/s") for name, unit in zip(names, kind)]
    out += [(f"{name}.torque", "N*m") for name in JOINTS] + [(f"{name}.torque_demanded", "N*m") for name in JOINTS]
    out += [(f"{name}.strap_force_{axis}", "N") for name in straps.names for axis in "xz"]
    out += [(f"foot_{side}.ground_force_{axis}", "N") for side in "lr" for axis in "xz"]
    out += [("gait.phase", "1"), ("gait.stance_l", "1"), ("gait.stance_r", "1")]
    out += [(f"wearer.{segment}_{axis}", "1") for segment in SEGMENTS for axis in ("x", "z", "moment")]
    for name in rig.cylinders:
        out += [(f"{name}.force_demanded", "N"), (f"{name}.force", "N"), (f"{name}.length", "m")]
    if gas:
        for name in rig.cylinders:
            out += [(f"{name}.valve_command", "1"), (f"{name}.pressure_1", "Pa"), (f"{name}.pressure_2", "Pa")]
            out += [(f"{name}.temperature_1", "K"), (f"{name}.temperature_2", "K")]
            out += [(f"{name}.choked", "1"), (f"{name}.gas_used", "kg")]
    return out


class Simulation:
    """Person, machine, gas and controller put together; `run` moves them.

    Args:
        rig: A worn machine; its wearer and ankle settings are used.
        request: What to simulate.

    Raises:
        ModelError, RigError, ScenarioError: the machine cannot be built, or cannot do this.
    """

    def __init__(self, rig: Rig, request: Request):
        self.rig, self.request = rig, request
        self.person = Person(rig.wearer.height, rig.wearer.mass)
        scenario = scenarios.find(request.scenario)
        self.motion = scenarios.motion(request.scenario, self.person, request.speed)
        self.cycles = request.cycles if request.cycles is not None else scenario.cycles
        self.model = build(rig.model, self.person, request.payload, rig.ankle)
        self.added = scenario.added
        if self.added and request.payload + self.added.mass > PAYLOAD_LIMIT + 20.0:
            raise ScenarioError(f"payload {request.payload:g} kg and {self.added.mass:g} kg more: too much to carry")
        check_strokes(rig, self.model)
        self.data = mujoco.MjData(self.model)
        self.straps = fasten(self.model, self.person)
        self.plugin = PneumaticPlugin(self.model, rig)
        self.dt = float(self.model.opt.timestep)
        self._demand = self._demand_added = np.zeros((SAMPLES + 1, 6))
        self._demand = self._demands(request.payload)
        self._demand_added = self._demands(request.payload + self.added.mass) if self.added else self._demand
        self._reset()

    def _demands(self, payload: float) -> NDArray[np.float64]:
        """Return the demand over the cycle for a payload, the first row repeated behind the last, (SAMPLES + 1, 6)."""
        if self.request.assist != "on":
            return np.zeros((SAMPLES + 1, 6))
        model = self.model
        if payload != self.request.payload:
            model = build(self.rig.model, self.person, min(payload, PAYLOAD_LIMIT), self.rig.ankle)
            _carry(model, payload)
        dynamics = machine_dynamics.along(model, self.motion, self.person, self.straps)
        if self.request.law != "least_load":
            return _closed(law_of_demand.demand(self.request.law, dynamics, self.motion, self.straps, self.rig.ankle))
        plan = LeastLoad(dynamics, self.motion, self.person, self.straps, self.rig.ankle, self._reach())
        return _closed(self._rehearse(plan, payload))

    def _reach(self) -> NDArray[np.float64]:
        """Return least and largest torque that cylinders and ankle motors can hold along the cycle, (PHASES, 6, 2)."""
        data, cylinders = mujoco.MjData(self.model), self.plugin.pneumatics.cylinders
        supply, atmosphere = self.rig.supply.pressure, self.rig.environment.pressure
        forces = largest_forces(cylinders["area_1"], cylinders["area_2"], supply, atmosphere, atmosphere)
        out = np.zeros((machine_dynamics.PHASES, 6, 2))
        if self.rig.ankle.mode == "powered":
            out[:, [2, 5]] = [-self.rig.ankle.torque, self.rig.ankle.torque]
        for i, position in enumerate(self.motion.position[machine_dynamics.PICK]):
            data.qpos[:] = position
            mujoco.mj_forward(self.model, data)
            for link, force in zip(self.plugin.links, forces):
                out[i, link.dof - 3] += np.sort(moment_row(self.model, data, link.actuator)[link.dof] * force)
        return out

    def _rehearse(self, plan: LeastLoad, payload: float) -> NDArray[np.float64]:
        """Walk a few cycles at a time and better the plan after each time; return the best of the torques tried."""
        from exo_sim.simulation.rehearsal import learn_from

        ankle = self.rig.ankle
        settling = min(_SETTLING, max(1, math.ceil(_SETTLING_TIME / self.motion.period)))
        usual = (self.added, self.cycles, self._demand)
        try:
            self.added, self.cycles = None, settling + max(1, math.ceil(_LOOKED_AT / self.motion.period))
            if payload != self.request.payload:
                _carry(self.model, payload)
            for _ in range(self.request.rehearsals):
                self._demand = self._demand_added = _closed(law_of_demand.limit(plan.torque(), ankle))
                self._reset()
                learn_from(plan, self.run(), settling)
        finally:
            self.added, self.cycles, self._demand = usual
            _carry(self.model, self.request.payload)
        return law_of_demand.limit(plan.torque(best=self.request.rehearsals > 0), ankle)

    def _reset(self) -> None:
        """Put the machine on the person at phase zero, moving with it, gas at rest at the pressures that hold it."""
        model, data = self.model, self.data
        mujoco.mj_resetData(model, data)
        data.qpos[:] = self.motion.position[0]
        data.qvel[:] = self.motion.slope[0] / self.motion.period
        vented = self.request.assist == "vented"
        self.plugin.pneumatics.cylinders["vented"] = float(vented)
        atmosphere = self.rig.environment.pressure
        self.plugin.reset(data, atmosphere, atmosphere)

    def run(self, quiet: bool = True) -> Walk:
        """Simulate; Ctrl-C ends the run early and leaves what was done.

        Raises:
            Diverged: numbers that mean nothing any more, a warning of MuJoCo, or a fall.
        """
        total = math.ceil(self.cycles * self.motion.period / self.dt - 1e-9) + 1
        gas = not self.request.ideal
        keys = layout(self.rig, self.straps, gas)
        log = np.empty((total, 1 + len(keys)))
        addresses, settings, world, wearer, drives, gas_state = self._wire()
        done, interrupted = 0, False
        duration = total * self.dt
        with progress.Bar(duration, self.request.scenario, unit="s", quiet=quiet) as bar:
            try:
                while done < total:
                    count = min(_CHUNK, total - done)
                    rows = log[done : done + count]
                    loop.run(done, count, addresses, settings, world, wearer, drives, gas_state, rows)
                    self._check(log, done, done + count)
                    done += count
                    bar.to(done * self.dt)
            except KeyboardInterrupt:
                interrupted = True
        return self._result(log[:done], keys, interrupted)

    def _wire(self) -> tuple:
        """Collect what the compiled loop works on."""
        model, data, plugin, gas = self.model, self.data, self.plugin, self.plugin.pneumatics
        n = len(plugin.links)
        position, slope = self.motion.tables()
        names = [model.actuator(i).name for i in range(model.nu)]
        powered = self.rig.ankle.mode == "powered" and self.request.assist == "on"
        ankles = [names.index(f"ankle_{s}") if powered and f"ankle_{s}" in names else -1 for s in "lr"]
        if powered and min(ankles) < 0:
            raise ModelError(f"{self.rig.model}: a powered ankle needs the actuators ankle_l and ankle_r")
        numbers = np.zeros(12)
        numbers[loop.PERIOD], numbers[loop.ADVANCE] = self.motion.period, self.motion.advance
        gains = self.request.gains
        numbers[loop.PREVIEW], numbers[loop.RAMP] = gains.preview, RAMP
        numbers[loop.CLOSING], numbers[loop.PROPORTIONAL] = gains.closing_time, gains.proportional
        numbers[loop.INTEGRAL], numbers[loop.DT] = gains.integral, self.dt
        payload_body = int(model.geom("payload").bodyid[0])
        if self.added:
            numbers[loop.ADDED], numbers[loop.ADDED_OVER] = self.added.mass, self.added.over
            numbers[loop.ADDED_AT] = self.added.at * self.motion.period * self.cycles / self._usual_cycles()
            numbers[loop.PAYLOAD] = model.body_mass[payload_body]
        code = controller_code(self.request.controller if self.request.assist == "on" else "off")
        share = np.ascontiguousarray(np.concatenate([self.motion.share, self.motion.share[:1]]))
        person_body = [model.body(f"person_{segment}").id for segment in SEGMENTS]
        mocap = [int(model.body_mocapid[i]) for i in person_body]
        if mocap != list(range(len(SEGMENTS))):
            raise ModelError(f"{self.rig.model}: the person's bodies must be mocap, in the order {', '.join(SEGMENTS)}")
        straps = self.straps
        return (
            loop.Addresses(address("mj_step1"), address("mj_step2"), model._address, data._address),
            loop.Settings(
                numbers, loop.IDEAL if self.request.ideal else loop.GAS, code, model.body("torso").id, payload_body
            ),
            loop.World(
                data.qpos, data.qvel, data.xpos, data.xmat, data.xipos, data.cvel, data.subtree_com,
                data.mocap_pos, data.mocap_quat, data.ctrl, data.xfrc_applied, data.qfrc_applied,
                data.actuator_length, data.actuator_velocity, data.actuator_moment, data.moment_rownnz,
                data.moment_rowadr, data.moment_colind, data.sensordata, model.body_mass, model.body_inertia,
                model.body_subtreemass,
            ),
            loop.Wearer(
                position, slope, self.person.lengths(), model.body_pos[person_body, 1].copy(), self._demand,
                self._demand_added, share, straps.body, straps.local, straps.segment, straps.anchor, straps.stiffness,
                straps.damping, np.zeros(9), np.zeros(9), np.zeros((7, 6)), np.zeros((len(straps.names), 2)),
                np.zeros((7, 3)), np.zeros(6), np.zeros(6), np.zeros(2),
            ),
            loop.Drives(
                plugin._actuators, np.array([link.dof for link in plugin.links], dtype=np.int64),
                np.array(ankles, dtype=np.int64), plugin._retracted, plugin.command, np.zeros(n), np.zeros(n),
                np.zeros(n),
                np.zeros(n), np.zeros(n),
            ),
            loop.Gas(
                gas.world, gas.cylinders, gas.joints, gas.vector, gas.history, plugin._x, plugin._x1, plugin._v,
                plugin._force, plugin._q, plugin._q1, plugin._qd, plugin._own, plugin._felt, plugin._dofs,
                plugin._addresses, gas._work, gas._scratch,
            ),
        )  # fmt: skip

    def _usual_cycles(self) -> int:
        return scenarios.find(self.request.scenario).cycles

    def _check(self, log: NDArray[np.float64], start: int, stop: int) -> None:
        """Refuse what cannot be: warnings of MuJoCo, numbers that are none, a machine that left its wearer."""
        rows = log[start:stop]
        when = f"at {start * self.dt:.3f} to {stop * self.dt:.3f} s"
        advice = "try a shorter timestep in the MJCF, a smaller payload, or --assist vented to find the cause"
        for kind, warning in zip(mujoco.mjtWarning.__members__, self.data.warning):
            if warning.number:
                raise Diverged(f"{self.request.scenario}: MuJoCo warns of {kind} {when}; {advice}")
        bad = ~np.isfinite(rows)
        if bad.any():
            column = int(np.argmax(bad.any(axis=0)))
            key = "time" if column == 0 else layout(self.rig, self.straps, not self.request.ideal)[column - 1][0]
            raise Diverged(f"{self.request.scenario}: {key} is not a number {when}; {advice}")
        cycles = np.arange(start, stop, dtype=np.float64) * (self.dt / self.motion.period)
        wanted = self.motion.at(cycles)
        far = np.hypot(rows[:, 1] - wanted[:, 0] - self.motion.advance * cycles, rows[:, 2] - wanted[:, 1])
        if far.max() > _FALLEN_DISTANCE or np.abs(rows[:, 3] - wanted[:, 2]).max() > _FALLEN_PITCH:
            raise Diverged(f"{self.request.scenario}: the machine falls away from its wearer {when}; {advice}")

    def _result(self, log: NDArray[np.float64], keys: list[tuple[str, str]], interrupted: bool) -> Walk:
        columns = {key: np.ascontiguousarray(log[:, 1 + i]) for i, (key, _) in enumerate(keys)}
        units = dict(keys)
        wrench = np.stack([columns.pop(key) for key, _ in keys if key.startswith("wearer.")], axis=1)
        units = {key: unit for key, unit in units.items() if key in columns}
        n = len(log)
        time = np.asarray(np.arange(n) * self.dt, dtype=np.float64)
        position, slope = self.motion.tables()
        poses, q, v = np.empty((n, 7, 6)), np.empty(9), np.empty(9)
        lengths = self.person.lengths()
        _poses(
            time / self.motion.period, self.motion.period, self.motion.advance, position, slope, lengths, q, v, poses
        )
        payload = np.full(n, self.request.payload)
        if self.added:
            at = self.added.at * self.motion.period * self.cycles / self._usual_cycles()
            payload += self.added.mass * np.clip((time - at) / self.added.over, 0.0, 1.0)
        gravity = float(-self.model.opt.gravity[2])
        frame = float(_frame_mass(self.rig, self.person))
        if self.added:
            body = int(self.model.geom("payload").bodyid[0])
            _carry(self.model, self.request.payload, body)
        return Walk(
            request=self.request,
            rig=self.rig,
            person=self.person,
            motion=self.motion,
            straps=self.straps,
            time=time,
            columns=columns,
            units=units,
            poses=poses,
            wrench=wrench.reshape(n, 7, 3),
            weight=(frame + payload) * gravity,
            payload=payload,
            books=None if self.request.ideal or n == 0 else self.plugin.books(),
            step=self.dt,
            interrupted=interrupted,
            model=self.model,
        )


@loop.kernel
def _poses(cycles, period, advance, position, slope, lengths, q, v, out):
    for i in range(cycles.size):
        loop.reference(cycles[i], period, advance, position, slope, q, v)
        segment_poses(q, v, lengths, out[i])


def _closed(table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a table with its first row repeated behind the last."""
    return np.ascontiguousarray(np.concatenate([table, table[:1]]))


def _carry(model: mujoco.MjModel, payload: float, body: int | None = None) -> None:
    """Set the mass on the back of a compiled model, inertia in proportion [kg]."""
    body = int(model.geom("payload").bodyid[0]) if body is None else body
    mass = max(payload, 1e-6)
    model.body_inertia[body] *= mass / model.body_mass[body]
    model.body_mass[body] = mass
    mujoco.mj_setConst(model, mujoco.MjData(model))


def _frame_mass(rig: Rig, person: Person) -> float:
    """Return the machine's mass without payload [kg]."""
    model = build(rig.model, person, 0.0, rig.ankle)
    return float(model.body_subtreemass[model.body("torso").id])


def simulate(rig: Rig, request: Request, quiet: bool = True) -> Walk:
    """Simulate a scenario; see `Simulation`."""
    return Simulation(rig, request).run(quiet=quiet)


def default_rig() -> Path:
    """Return the rig of the machine that comes with the package's checkout."""
    return Path(__file__).resolve().parents[2] / "assets" / "exo.toml"
