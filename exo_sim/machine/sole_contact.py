"""What gives under a wearer's sole: heel pad, ball and tip of the toes on a shoe, soft at first and stiffer the deeper they are pressed.

A heel pad or a shoe takes the first millimetres of a step with little force and stops giving at about a centimetre (Aerts, Ker, De Clercq,
Ilsley and Alexander 1995, Journal of Biomechanics 28:1299, on heel pads); a contact of a constant spring and damper takes up its damper's
force at once, so that heel and ball chatter. MuJoCo's impedance that grows with depth does it: spring and damper grow with it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Radius of what touches [m], and friction.
RADIUS, FRICTION = 0.005, 0.9
#: Stiffness [N/m] and damping [N s/m] of sole and ground together under heel, ball or tip that are pressed by more than `FIRM` [m].
STIFFNESS, DAMPING, FIRM = 1.5e5, 1e4, 0.010
#: MuJoCo's impedance at the first touch, and from `FIRM` on: 1/63 of the stiffness and 1/21 of the damping are there from the first. With
#: 1/9 of the damping a ball that came down at 0.4 m/s met half the body's weight within 2 ms, and the first peak of the force was 1.25 of
#: the weight (recorded: 1.10), with the joints' springs of that day.
TOUCHING, PRESSED = 0.3, 0.9
#: The pad under the heel: from the rear of the heel so far ahead on a body of the reference height [m]; of the stiffness, each end has a
#: share so large.
PAD, PAD_SHARE = 0.06, 0.5
#: Deeper than any load presses [m], and halvings of the depth that is looked for.
_DEEPEST, _HALVINGS = 0.05, 32


def solimp() -> list[float]:
    """Return MuJoCo's `solimp` of such a contact."""
    return [TOUCHING, PRESSED, FIRM, 0.5, 1.0]


def solref(yields: float, share: float = 1.0) -> tuple[float, float]:
    """Return MuJoCo's `solref` of a contact of a body that yields so much [1/kg], which counts springs and dampers in accelerations."""
    resists = share * yields * (1.0 - PRESSED)
    return -STIFFNESS * resists, -DAMPING * resists


def force_at(depth: Array) -> Array:
    """Return what a contact at rest gives at a depth [m], any shape: [N]."""
    impedance = TOUCHING + (PRESSED - TOUCHING) * np.clip(depth / FIRM, 0.0, 1.0)
    firm = impedance**2 / (1.0 - impedance) * (1.0 - PRESSED) / PRESSED**2
    return np.asarray(STIFFNESS * firm * np.maximum(depth, 0.0))


def depth_under(load: Array) -> Array:
    """Return how deep a ball or a tip lies under a load [N], any shape: [m]."""
    return _deep(load, force_at)


def heel_depth(load: Array, tilt: Array, scale: float) -> Array:
    """Return how deep the rear of a heel lies [m], shape (n,), whose pad carries a load at rest.

    Args:
        load: [N], shape (n,).
        tilt: Of the foot to the ground, toes up positive [rad], shape (n,).
        scale: Lengths of the body over the reference body's.
    """
    apart = PAD * scale * np.sin(tilt)
    lower = _deep(load, lambda depth: PAD_SHARE * (force_at(depth) + force_at(depth - np.abs(apart))))
    return lower + np.minimum(apart, 0.0)


def _deep(load: Array, gives: Callable[[Array], Array]) -> Array:
    """Return how deep what gives a force [N] at a depth [m] lies under a load [N]: [m]."""
    low, high = np.zeros_like(load), np.full_like(load, _DEEPEST)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        short = gives(middle) < load
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return 0.5 * (low + high)
