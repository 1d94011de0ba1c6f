"""What counts as load on the wearer, and by how much."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Weights:
    """What counts as load.

    Attributes:
        hip, knee, ankle: Weight of a newton metre in the wearer's joint.
        residual: Of a newton metre that no sole can give. Of 0, 0.5, 0.7 and 1 a half left small residuals on the level and stairs at no
            price in the joints (14 walks: levels, slopes, stairs, speeds, three ankles, two machines).
        own: Share of the moments of the wearer's own body that count with those of the straps: 0 asks for a machine that is not felt,
            1 for one that makes the wearer's whole moments small.
        moving: By how much more a moment counts while its joint turns, where it costs work [s/rad]. With 1 for this and for `own` the
            wearer's joints did 119 J a stride, with 0.5 and 0.7 it was 122 J (level, 34 kg, `QUICK`, rehearsed from the same torques,
            by demands of that day and not the one that comes along).
        torso: Of a newton on the torso straps, up or down [m]. Of 0.5, 0.6, 0.65, 0.7 and 0.8 those of the lighter machine bore 78, 48, 45,
            44 and 32 N rms, a quarter of what they bear with valves open being 50 N; its wearer's power was 439, 464, 477, 475 and 484 W
            (level, 34 kg), and its knee was off his by 16 degrees at the most, with 0.7 and 0.8 by 18 and 20.
        torso_ahead: Of a newton on the torso straps, forward or back [m].
        push: Of a newton that all straps together push the machine ahead [m]: the wearer holds it against the ground, about a metre below.
        steady: The mean of that push, a sledge that is pulled all the way, counts as if it were so many times as large.
        pressed: Of a newton metre that a chamber holds with pressure near its rating (`simulation/chamber_limits.py`). Of 0, 2, 10, 20
            and 40 the largest chamber saw 11.2, 11.4, 11.0, 10.8 and 10.7 bar on the level, and of 0, 10, 20 and 40 it saw 12.8, 11.8, 11.6
            and 11.2 bar in walking fast, for 729, 761, 744 and 756 W (34 kg, 9 bar).
        effort: Of a newton metre demanded, steady.
        smoothness: Of a newton metre demanded, for each harmonic.
    """

    hip: float = 1.0
    knee: float = 1.0
    ankle: float = 0.7
    residual: float = 0.5
    own: float = 1.0
    moving: float = 1.0
    torso: float = 0.65
    torso_ahead: float = 0.1
    push: float = 1.0
    steady: float = 2.0
    pressed: float = 20.0
    effort: float = 0.05
    smoothness: float = 0.05

    def of_loads(self, rate: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what each load counts at each phase, shape (n, 10).

        These are hip, knee, ankle on both sides, the residual, torso straps ahead and up, and the push.

        Args:
            rate: Of the joints [rad/s], shape (n, 6).
        """
        joints = np.array([self.hip, self.knee, self.ankle] * 2) * np.hypot(1.0, self.moving * rate)
        others = np.array([self.residual, self.torso_ahead, self.torso, self.push])
        return np.concatenate([joints, np.broadcast_to(others, (len(rate), 4))], axis=1)


#: Where both pressures of the cylinders are planned, gas goes with what the torques change by: smoother ones draw a quarter less, and the
#: wearer hardly feels it (docs/sizing.md).
SPARING = Weights(smoothness=0.15)
#: For one who is a body. Of 0.05, 0.1, 0.15, 0.2 and 0.3 for `smoothness` he spent 471, 456, 436, 444 and 465 W, his pelvis held by 21,
#: 8, 22, 17 and 18 N at most (`exo`, 34 kg; with the steps that he took on commit d0ff05c1).
SMOOTH = Weights(smoothness=0.1)
#: Where causal control is for one who is a body, or for what does not come again as strides do.
THOUGHT = Weights(smoothness=0.15, own=0.7, moving=0.5, torso=0.5)
#: From rest, where the machine leans on its wearer before it has a foot ahead. Of 0.5, 1 and 2 for `residual` 138, 79 and 67 N m were left
#: at the most, for 329, 331 and 332 W (`exo`, 34 kg).
FROM_REST = Weights(smoothness=0.15, own=0.7, moving=0.5, torso=0.5, residual=2.0)
#: Who is a body walks off and stops to a demand that was not rehearsed with him: with faster torques he falls in his fifth walk.
CALM = Weights(smoothness=0.3, own=0.7, moving=0.5, torso=0.5)
#: Where straps are felt and learnt from, torques may change faster: what the gas does not follow is answered.
#: Shoulders count less: with 1 for `torso` causal control cost up to a tenth of the backpack more where straps were half as stiff.
QUICK = Weights(smoothness=0.02, torso=0.5)
#: In place: with fewer than two rehearsals the plan stands, and where own moments count whole it throws over who squats with 45 kg.
IN_PLACE = Weights(own=0.7, moving=0.5, torso=0.5)
