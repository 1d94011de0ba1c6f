"""An ideal device on one joint of the wearer: without mass, as strong as it must be, in one direction of turning or in both.

As in Dembia, Silder, Uchida, Hicks and Delp 2017 (PLoS ONE 12:e0180320), the wearer walks as before, and the device takes from the joint
what moment it gives in the device's direction. They let it go beyond that where muscles over two joints are relieved elsewhere; a wearer
of joint moments has none, so that beyond it there is nothing to gain.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ScenarioError
from exo_sim.simulation.wearer_inverse_dynamics import Held

#: Devices by name: which of hip, knee and ankle they drive, and the signs of the moments [N m] that they can give.
DEVICES: dict[str, tuple[int, tuple[int, ...]]] = {
    "hip flexion": (0, (1,)), "hip extension": (0, (-1,)), "hip, both ways": (0, (1, -1)),
    "knee flexion": (1, (-1,)), "knee extension": (1, (1,)), "knee, both ways": (1, (1, -1)),
    "ankle plantarflexion": (2, (-1,)), "ankle dorsiflexion": (2, (1,)), "ankle, both ways": (2, (1, -1)),
}  # fmt: skip


@dataclass(frozen=True)
class Assisted:
    """A wearer with a device on the same joint of both legs.

    Attributes:
        wearer: What is left for him to give.
        torque: Of the device on left and right leg [N m], flexion of hips, extension of knees and dorsiflexion positive, shape (n, 2).
        power: What it gives there [W], shape (n, 2).
    """

    wearer: Held
    torque: NDArray[np.float64]
    power: NDArray[np.float64]


def assisted(wearer: Held, device: str) -> Assisted:
    """Return a wearer who walks as before with an ideal device on one joint of both legs.

    Args:
        wearer: Who gives all moments himself.
        device: One of `DEVICES`.

    Raises:
        ScenarioError: there is no such device.
    """
    if device not in DEVICES:
        raise ScenarioError(f'no device "{device}"; write one of {", ".join(DEVICES)}')
    joint, signs = DEVICES[device]
    asked = wearer.moments[:, joint::3]
    torque = sum((np.maximum(sign * asked, 0.0) * sign for sign in signs), np.zeros_like(asked))
    moments = wearer.moments.copy()
    moments[:, joint::3] -= torque
    return Assisted(replace(wearer, moments=moments), torque, torque * wearer.rates[:, joint::3])
