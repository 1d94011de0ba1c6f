"""A controller that a machine could run: nothing of the wearer is known but what encoders and load cells showed so far.

Signals are the machine's own: joint encoders, the pitch of its torso (an inertial unit), and load cells in the straps, all with noise.
A calibration walk on the mean stride gives a demand over the phase, what encoders show and which strap forces belong to it. From then on

- the phase is estimated from the encoders (`gait_phase.py`), and corrected from stride to stride by strap forces
  (`phase_correction.py`),
- the demand of the calibration is read at that phase,
- strap forces that do not belong to the phase are answered at once (`strap_feedback.py`) and change the demand from stride to stride
  (`stride_learning.py`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.force_signals import ENCODER
from exo_sim.control.gait_phase import PhaseObserver
from exo_sim.control.least_load import LeastLoad
from exo_sim.control.phase_correction import PhaseCorrection
from exo_sim.control.strap_feedback import SHARE, StrapFeedback
from exo_sim.control.stride_learning import StrideLearning
from exo_sim.control.user_controller import Context
from exo_sim.gait.motion import SAMPLES
from exo_sim.machine.straps import StrapSet

#: Standard deviation of a load cell's noise [N].
LOAD_CELL = 2.0
#: The demand grows from zero at the start [s], and strides that are looked at before learning begins.
_RAMP = 0.5
_HIPS_AND_KNEES = ("hip_l", "hip_r", "knee_l", "knee_r")


@dataclass(frozen=True)
class Calibration:
    """What a walk on the mean stride showed.

    Attributes:
        plan: The demand that was rehearsed, and how strap forces follow from torques.
        straps: Where load cells are.
        period: Of its strides [s].
        encoders: Angles of left and right hip, left and right knee over the phase [rad], shape (n, 4).
        forces: Strap forces on the machine, across and along its segment, at PHASES phases [N], shape (PHASES, 2 straps).
    """

    plan: LeastLoad
    straps: StrapSet
    period: float
    encoders: NDArray[np.float64]
    forces: NDArray[np.float64]


@dataclass
class Causal:
    """Torques of the joints from what the machine measures; a controller as `control.user_controller` has them.

    Attributes:
        calibration: Known beforehand.
        first_phase: Where it thinks the stride begins, in cycles.
        late: An error of the phase that encoders give, in cycles: for showing what it does.
        feedback: Share of the regulator's gains that answers strap forces at once; 0 for none.
        learns: Whether the demand changes from stride to stride.
        corrects: Whether strap forces correct the phase.
        period: Seconds between two calls of `act`.
    """

    calibration: Calibration
    first_phase: float = 0.0
    late: float = 0.0
    feedback: float = SHARE
    learns: bool = True
    corrects: bool = True
    period: float = 0.002
    phase: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        it = self.calibration
        self._observer = PhaseObserver(it.encoders, it.period)
        self._learning = StrideLearning(it.plan, it.forces)
        self._correction = PhaseCorrection(it.plan, it.forces)
        along = it.plan.response
        self._regulator = StrapFeedback(it.plan.yielding, along, it.period, it.forces, self.feedback) if self.feedback and along else None
        self._driven = list(it.plan.yielding.driven)

    def reset(self, context: Context) -> None:
        """Begin anew, with the demand of the calibration."""
        # a command counts from one step after what was measured, until the next
        self._lead = context.step + 0.5 * (context.period - context.step)
        self._dt, self._names = context.period, [f"{name}.torque" for name in context.joints]
        self._noise = np.random.default_rng(context.seed)
        self._observer.start(self.first_phase)
        self._learning.forget()
        self._correction.forget()
        if self._regulator is not None:
            self._regulator.start()

    def act(self, observation: Mapping[str, float]) -> dict[str, float]:
        """Return the torque of each joint [N m]."""
        encoders = np.array([observation[f"{name}.position"] for name in _HIPS_AND_KNEES])
        encoders = ENCODER * np.round(encoders / ENCODER)
        self.phase = self._observer.step(encoders, self._dt) - self.late + self._correction.added
        phase = self.phase + self._observer.cadence * self._lead
        forces = strap_forces(observation, self.calibration.straps)
        forces = forces + LOAD_CELL * self._noise.standard_normal(len(forces))
        if self.learns:
            self._learning.take(self.phase, forces)
        at = (phase % 1.0) * SAMPLES
        i = int(at) % SAMPLES
        table, u = self._learning.table, at - int(at)
        torque = (1.0 - u) * table[i] + u * table[(i + 1) % SAMPLES]
        if self._regulator is not None:
            torque[self._driven] += self._regulator.step(self.phase, forces, self._dt)
        torque *= min(observation["time"] / _RAMP, 1.0)
        if self.corrects:
            self._correction.take(self.phase, forces, torque[self._driven])
        return dict(zip(self._names, torque.tolist()))


def strap_forces(observation: Mapping[str, Any], straps: StrapSet) -> NDArray[np.float64]:
    """Return what load cells in the machine's segments show: forces on it across and along them [N], shape (2 straps, ...)."""
    angle = [observation["torso_pitch.position"]]
    for side in "lr":
        turned = angle[0]
        for joint in ("hip", "knee", "ankle"):
            turned = turned + observation[f"{joint}_{side}.position"]
            angle.append(turned)
    of = np.array(angle)[straps.segment]
    x = np.array([observation[f"{name}.strap_force_x"] for name in straps.names])
    z = np.array([observation[f"{name}.strap_force_z"] for name in straps.names])
    cosine, sine = np.cos(of), np.sin(of)
    return np.stack([cosine * x + sine * z, cosine * z - sine * x], axis=1).reshape(2 * len(x), *x.shape[1:])
