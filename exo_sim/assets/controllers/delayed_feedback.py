"""Delayed output feedback: the hips are helped by where they were a quarter of a second ago.

The output is the difference of the sines of both thigh angles; delayed, it is ahead of the next swing by just as much as a push takes
(Lim et al. 2019, "Delayed output feedback control for gait assistance with a robotic hip exoskeleton", IEEE Transactions on
Robotics 35(4)).
It needs no gait phase and no model. Run it with `exo-sim run level_walk --controller delayed_feedback.py:DelayedFeedback`.
"""

from __future__ import annotations

import math
from collections import deque

GAIN, DELAY = 10.0, 0.25  # N m, s


class DelayedFeedback:
    """torque of the right hip = -gain y(t - delay), of the left +gain y(t - delay); y = sin(right thigh) - sin(left thigh)."""

    period = 0.005  # s

    def reset(self, context):
        """Begin with an empty memory."""
        self.samples = max(1, round(DELAY / context.period))
        self.memory: deque[float] = deque(maxlen=self.samples)

    def act(self, observation):
        """Return the torque of both hips; the built-in force loop makes it."""
        pitch = observation["torso_pitch.position"]
        right, left = (pitch + observation[f"hip_{side}.position"] for side in "rl")
        self.memory.append(math.sin(right) - math.sin(left))
        if len(self.memory) < self.samples:
            return {"hip_r.torque": 0.0, "hip_l.torque": 0.0}
        push = GAIN * self.memory[0]
        return {"hip_r.torque": -push, "hip_l.torque": push}
