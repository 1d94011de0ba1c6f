"""An impedance about the wearer's motion: each joint is a spring and a damper to where the reference has it.

Run it with `exo-sim run level_walk --controller impedance.py:Impedance`.
"""

from __future__ import annotations

import math

# N m/rad and N m s/rad of each kind of joint; what is not named gets nothing
STIFFNESS = {"hip": 150.0, "knee": 150.0}
DAMPING = {"hip": 5.0, "knee": 5.0}
LIMIT = 120.0  # N m


class Impedance:
    """torque = stiffness (reference - position) + damping (its rate - velocity), within a limit."""

    period = 0.005  # s

    def reset(self, context):
        """Keep what is needed of the context."""
        self.reference = context.reference
        self.joints = [name for name in context.joints if name.split("_")[0] in STIFFNESS]

    def act(self, observation):
        """Return the torque of each joint; the built-in force loop makes it."""
        wanted = self.reference(observation["time"])
        out = {}
        for joint in self.joints:
            kind = joint.split("_")[0]
            position, velocity = wanted[joint]
            torque = STIFFNESS[kind] * (position - observation[f"{joint}.position"])
            torque += DAMPING[kind] * (velocity - observation[f"{joint}.velocity"])
            out[f"{joint}.torque"] = math.copysign(min(abs(torque), LIMIT), torque)
        return out
