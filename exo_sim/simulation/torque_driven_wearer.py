"""From a wearer whose motion is prescribed to one who is a body in the same model."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control import wearer_plan
from exo_sim.errors import ScenarioError
from exo_sim.machine.attachment import attach
from exo_sim.machine.straps import fasten
from exo_sim.machine.worn_model import build
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.rehearsal import expected_load

if TYPE_CHECKING:
    from exo_sim.simulation.worn import Simulation


def embody(it: Simulation, looked_at: float) -> None:
    """Make the wearer a body: he goes by what the straps do to one whose motion is prescribed.

    Args:
        it: Changed: model, straps, cylinders, motion and torques are those of the body.
        looked_at: How much of the walk with a prescribed motion tells him what to expect [s].

    Raises:
        ScenarioError: he would sit, or walk on ground that is not level.
    """
    name = it.request.scenario
    if float(it.motion.support.min()) < 1.0:
        raise ScenarioError(f'{name}: the wearer sits, and there is no chair for one with wearer "torques"')
    if not it.motion.ground.level:
        raise ScenarioError(f'{name}: a wearer with wearer "torques" stands on level ground only; leave it out for a prescribed one')
    it.expected, it.intended = _felt(it, looked_at), it.motion
    step = it.model.opt.timestep
    it.model = build(it.rig.model, it.person, it.request.payload, it.rig.ankle, it.masses, it.rig.joint_factors, embodied=True)
    attach(it.model, it.rig)
    it.model.opt.timestep = step
    it.data = mujoco.MjData(it.model)
    it.straps = fasten(it.model, it.person, one_sided=True)
    it.plugin = PneumaticPlugin(it.model, it.rig)
    _plan(it)


def expect(it: Simulation, strides: NDArray[np.float64]) -> None:
    """Let a wearer who is a body expect of his straps what another walk's did.

    Args:
        it: Changed: the torques that he plans for the motion that he means to do, and how deep that has his soles.
        strides: Loads on the segments over the mean stride, about their upper joints, shape (SAMPLES, 7, 3).
    """
    trial = it.intended.trial
    it.expected = strides if trial is None else trial.of_segments(strides)
    _plan(it)


def _plan(it: Simulation) -> None:
    plan = wearer_plan.plan(it.intended, it.person, it.expected)
    it.motion, it.torques = plan.motion, plan.torque


def _felt(it: Simulation, looked_at: float) -> NDArray[np.float64]:
    """Return what the straps do to the wearer over some time [s] of the walk as it is now."""
    usual = it.added, it.cycles
    settling = it.settling if it.motion.trial is None else 0
    try:
        it.added, it.cycles = None, settling + max(1, math.ceil(looked_at / it.motion.period))
        it.reset()
        return expected_load(it.run(), settling)
    finally:
        it.added, it.cycles = usual
