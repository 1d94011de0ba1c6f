"""A learnt policy: torques of hip and knee over the gait phase, found by CMA-ES in `exo_sim.environments`.

`scripts/learn_policy` learnt `learnt_policy.json`: mean, cosines and sines of each joint's torque over the phase of its own leg.
Run it with `exo-sim run level_walk --rig exo_250_psi --controller learnt_policy.py:LearntPolicy`, the machine that it was learnt on.
"""

from __future__ import annotations

import json
import math
from pathlib import Path


class LearntPolicy:
    """torque of a joint = series(phase of its leg)."""

    period = 0.02  # s, as it was learnt

    def reset(self, context):
        """Read what was learnt."""
        learnt = json.loads((Path(__file__).parent / "learnt_policy.json").read_text())
        self.series = learnt["torque_nm"]

    def act(self, observation):
        """Return the torques of both hips and knees; the built-in force loop makes them."""
        right = observation["gait.phase"]
        out = {}
        for side, phase in (("r", right), ("l", right + 0.5)):
            for joint, (mean, *waves) in self.series.items():
                torque = mean
                for i in range(len(waves) // 2):
                    angle = 2.0 * math.pi * (i + 1) * phase
                    torque += waves[2 * i] * math.cos(angle) + waves[2 * i + 1] * math.sin(angle)
                out[f"{joint}_{side}.torque"] = torque
        return out
