"""A step of a walk, wearer, straps, demand, valves, gas and log in it, against bare MuJoCo steps of the same model on the same path."""

from __future__ import annotations

import time
from collections.abc import Callable

import mujoco
import mujoco.rollout
import numpy as np

from benchmarks.figure import Asked, Figure, Said
from exo_sim import rig as rigs
from exo_sim.simulation import loop
from exo_sim.simulation.loop_wiring import wire
from exo_sim.simulation.walk import Request, default_rig
from exo_sim.simulation.worn import Simulation
from exo_sim.simulation.worn_log import keys_of

STEPS, REPEATS = 1500, 200
#: What comes from outside at every step.
_DRIVEN = (
    mujoco.mjtState.mjSTATE_CTRL, mujoco.mjtState.mjSTATE_QFRC_APPLIED, mujoco.mjtState.mjSTATE_XFRC_APPLIED,
    mujoco.mjtState.mjSTATE_MOCAP_POS, mujoco.mjtState.mjSTATE_MOCAP_QUAT,
)  # fmt: skip


def ratio(wearer: str) -> tuple[float, float]:
    """Return microseconds of a bare step, and how many of these a step of the walk takes, in processor time: the least of many turns."""
    it = Simulation(rigs.read(default_rig()), Request("level_walk", cycles=3, wearer=wearer, rehearsals=2))
    model, columns = it.model, 1 + len(keys_of(it))

    def walked() -> float:
        it.reset()
        wired, log = wire(it), np.empty((STEPS, columns))
        begun = time.process_time()
        loop.run(0, STEPS, *wired, log)
        return time.process_time() - begun

    walked()
    it.reset()
    wired, row = wire(it), np.empty((1, columns))
    start = np.zeros((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    mujoco.mj_getState(model, it.data, start[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
    kinds = sum(int(kind) for kind in _DRIVEN)
    driven = np.zeros((1, STEPS, mujoco.mj_stateSize(model, kinds)))
    for i in range(STEPS):
        loop.run(i, 1, *wired, row)
        mujoco.mj_getState(model, it.data, driven[0, i], kinds)
    end = it.data.qpos.copy()

    def bare() -> float:
        data = mujoco.MjData(model)
        with mujoco.rollout.Rollout(nthread=0) as rollout:
            begun = time.process_time()
            states, _ = rollout.rollout(model, data, start, driven, control_spec=kinds)
            taken = time.process_time() - begun
        assert np.array_equal(states[0, -1, 1 : 1 + model.nq], end), "the bare path is another one"
        return taken

    least = _least(walked, bare)
    return 1e6 * least[1] / STEPS, least[0] / least[1]


def _least(*ways: Callable[[], float]) -> list[float]:
    taken = [float("inf")] * len(ways)
    for _ in range(REPEATS):
        for place, way in enumerate(ways):
            taken[place] = min(taken[place], way())
    return taken


def measure(asked: Asked) -> Said:
    """Measure the step with a wearer whose motion is prescribed, and with one who is a body in the model."""
    (plain_us, plain), (body_us, body) = ratio("prescribed"), ratio("torques")
    return [
        Figure("walk_step_bare_us", "bare step, wearer prescribed", plain_us, "{:.2f} us"),
        Figure("walk_step_ratio", "step of a walk, wearer prescribed", plain, "{:.2f} times bare", below=1.3),
        Figure("body_step_bare_us", "bare step, wearer a body", body_us, "{:.2f} us"),
        Figure("body_step_ratio", "step of a walk, wearer a body", body, "{:.2f} times bare", below=1.3),
    ]
