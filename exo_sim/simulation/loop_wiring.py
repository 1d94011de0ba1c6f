"""What the compiled loop works on, collected from model, gas, wearer and request."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control import wearer_torques
from exo_sim.control.force_signals import gauges
from exo_sim.control.valve_control import CONTROLLERS, controller_code
from exo_sim.errors import ModelError
from exo_sim.machine import wearer_body
from exo_sim.machine.fitting import ground_sensors
from exo_sim.machine.person import SEGMENTS
from exo_sim.machine.straps import StrapSet
from exo_sim.simulation import loop, pressure_plans, views
from exo_sim.simulation.valve_loop import Drives
from exo_sim.simulation.walk import STRAPPED

if TYPE_CHECKING:
    from exo_sim.simulation.walk import Request
    from exo_sim.simulation.worn import Simulation

#: Time over which the demand grows from zero at the start [s].
RAMP = 0.5


def groups(straps: StrapSet) -> NDArray[np.int64]:
    """Return the place of each strap's part of the body in `walk.STRAPPED`, shape (n,)."""
    parts = [SEGMENTS[int(s)].split("_")[0] for s in straps.segment]
    return np.array([STRAPPED.index("shoe" if part == "foot" else part) for part in parts], dtype=np.int64)


def _damping(model: mujoco.MjModel) -> NDArray[np.float64]:
    """Return the linear damping of each degree of freedom, shape (9,)."""
    damping = model.dof_damping
    return np.ascontiguousarray(damping if damping.ndim == 1 else damping[:, 0])


def wire(it: Simulation) -> tuple[loop.Settings, views.Mechanics, views.Plant, loop.Bodies, loop.Wearer, Drives]:
    """Return the arguments of `loop.run`: views into MuJoCo's and the gas's own arrays, and what the loop remembers.

    Raises:
        ModelError: the MJCF lacks a motor for a powered ankle, or the person's bodies are not as they must be.
    """
    model, data, n = it.model, it.data, len(it.plugin.links)
    position, slope = it.motion.tables()
    names = [model.actuator(i).name for i in range(model.nu)]
    powered = it.rig.ankle.mode == "powered" and it.request.assist == "on"
    motors = [f"ankle_{s}" if powered and f"ankle_{s}" not in {link.joint for link in it.plugin.links} else "" for s in "lr"]
    if any(name and name not in names for name in motors):
        raise ModelError(f"{it.rig.model}: a powered ankle needs a cylinder, or the actuators ankle_l and ankle_r")
    ankles = [names.index(name) if name else -1 for name in motors]
    numbers = np.zeros(10)
    numbers[loop.PERIOD], numbers[loop.ADVANCE], numbers[loop.CLIMB] = it.motion.period, it.motion.advance, it.motion.climb
    numbers[loop.PREVIEW], numbers[loop.RAMP], numbers[loop.DT] = it.request.gains.preview, RAMP, it.dt
    payload_body = int(model.geom("payload").bodyid[0])
    if it.added:
        numbers[loop.ADDED], numbers[loop.ADDED_OVER] = it.added.mass, it.added.over
        numbers[loop.ADDED_AT] = it.added_at
        numbers[loop.PAYLOAD] = model.body_mass[payload_body]
    code = controller_code(_valves(it.request))
    asked = loop.TORQUES if it.request.driven == "torques" else loop.TABLES
    share = np.ascontiguousarray(np.concatenate([it.motion.share, it.motion.share[:1]]))
    person_body = [model.body(f"person_{segment}").id for segment in SEGMENTS]
    mocap = [int(model.body_mocapid[i]) for i in person_body]
    if it.torques is None and mocap != list(range(len(SEGMENTS))):
        raise ModelError(f"{it.rig.model}: the person's bodies must be mocap, in the order {', '.join(SEGMENTS)}")
    feet = np.array([model.body(f"foot_{side}").id for side in "lr"])
    soles = np.array([model.site(f"foot_{side}").id for side in "lr"])
    straps = it.straps
    moving = _moving(it)
    plan, plan_added = (it.plan, it.plan_added) if it.planned else (pressure_plans.nothing(n), pressure_plans.nothing(n))
    return (
        loop.Settings(
            numbers, loop.IDEAL if it.request.ideal else loop.GAS, code, asked, model.body("torso").id, payload_body
        ),
        views.mechanics(model, data),
        it.plugin.plant,
        loop.Bodies(
            data.xpos, data.xmat, data.xipos, data.cvel, data.subtree_com, data.mocap_pos, data.mocap_quat, data.xfrc_applied,
            data.sensordata, model.body_mass, model.body_inertia, model.body_subtreemass,
            data.qfrc_constraint, data.qfrc_passive, _damping(model), data.site_xpos,
            np.array(ground_sensors(model, it.rig.model)), soles, feet,
        ),
        loop.Wearer(
            position, slope, it.person.lengths(), model.body_pos[person_body, 1].copy(), it.demand,
            it.demand_added, share, straps.body, straps.local, straps.segment, straps.anchor, straps.stiffness,
            straps.damping, straps.least, np.zeros(9), np.zeros(9), np.zeros((7, 6)), np.zeros((len(straps.names), 2)),
            np.zeros((len(straps.names), 2)), np.zeros(len(straps.names)), groups(straps),
            np.zeros((7, 3)), np.zeros(6), np.zeros(6), np.zeros(2), *moving,
        ),
        Drives(np.array(ankles, dtype=np.int64), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n),
                    np.zeros(min(it.plugin.pneumatics.commands, 2 * n)), np.zeros(6), plan, plan_added,
                    np.zeros(2 * n), np.zeros(2 * n), np.zeros(2 * n), _gains(it), gauges(n, it.request.signals, it.seed)),
    )  # fmt: skip


def _gains(it: Simulation) -> NDArray[np.float64]:
    """Return the gains of each cylinder's force loop, columns as `valve_loop` has them, shape (n, 3)."""
    of = [it.request.tuned.get(name, it.request.gains) for name in it.rig.cylinders]
    return np.array([(one.closing_time, one.proportional, one.integral) for one in of]).reshape(len(of), 3)


def _moving(it: Simulation) -> tuple[NDArray[np.int64], wearer_torques.Mover]:
    """Return where the ground's forces on a torque-driven wearer are among the sensors, and what moves him; where he is none, nothing."""
    if it.torques is None:
        return np.empty(0, np.int64), wearer_torques.mover(it.person)
    where = wearer_body.find(it.model)
    mover = wearer_torques.mover(it.person, it.request.payload, it.torques, where.dofs)
    wearer_torques.dampen(it.model, mover)
    return where.ground, mover


def _valves(request: Request) -> str:
    """Return which controller moves the valves."""
    if request.assist != "on":
        return "off"
    if request.driven == "valves":
        return "given"
    return request.controller if request.controller in CONTROLLERS else "model"
