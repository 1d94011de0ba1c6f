"""Conditions around those asked for: other wearers, cadences and payloads that the same machine must do as well.

Corners, not a grid: each adds a walk to every design that is scored. A short wearer steps fast, a tall one has long segments and a heavy
body, and without payload the loads turn their sign.
"""

from __future__ import annotations

from exo_sim.sizing.loads import Condition

#: Wearers [m] and cadences at the corners: with the largest payload a short one that walks fast and a tall one that walks slowly.
SHORT, TALL, FAST, SLOW = 1.60, 1.90, 1.15, 0.85


def around(asked: tuple[Condition, ...]) -> tuple[Condition, ...]:
    """Return what was asked for, and for each of its scenarios the corners around it; none twice."""
    found = list(asked)
    for name in dict.fromkeys(one.scenario for one in asked):
        most = max(one.payload for one in asked if one.scenario == name)
        found += [Condition(name, most, FAST, SHORT), Condition(name, most, SLOW, TALL), Condition(name, 0.0)]
    return tuple(dict.fromkeys(found))
