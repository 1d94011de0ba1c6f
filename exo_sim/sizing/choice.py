"""Which design of a front to recommend, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.sizing.evaluation import Task
from exo_sim.sizing.loads import JointLoads
from exo_sim.sizing.screening import CONSTRAINTS
from exo_sim.sizing.search import Found, Outcome

#: Torque to keep in hand, as a share of the joint's peak: friction, wear and a stumble are not in the loads.
ENOUGH_MARGIN = 0.25
#: Largest torque error, as a share of the largest torque wanted.
ENOUGH_TRACKING = 0.03


@dataclass(frozen=True)
class Choice:
    """The recommended design and the reason in words."""

    found: Found
    why: str


def recommended(front: tuple[Found, ...], loads: tuple[JointLoads, ...], joints: tuple[str, ...]) -> Choice:
    """Return the design of a front that keeps torque in hand, tracks well, and of these costs least.

    Cost is gas and mass, each relative to the least among the candidates, added.

    Args:
        front: Not empty.
        loads: What the joints must carry.
        joints: Those that have cylinders.
    """
    peak = max(float(np.abs(one.column(joint)[2]).max()) for one in loads for joint in joints)
    most_error = ENOUGH_TRACKING * peak
    strong = [one for one in front if one.score.margin >= ENOUGH_MARGIN]
    good = [one for one in strong if one.score.error <= most_error]
    if good:
        words = (
            f"of {len(front)} designs on the front, {len(good)} keep at least {100 * ENOUGH_MARGIN:.0f} % of peak torque in hand and "
            f"follow the torque within {most_error:.1f} N m rms ({100 * ENOUGH_TRACKING:.0f} % of the peak)"
        )
    elif strong:
        good = sorted(strong, key=lambda one: one.score.error)[:1]
        words = (
            f"{len(strong)} designs keep {100 * ENOUGH_MARGIN:.0f} % of peak torque in hand, but none follows the torque within "
            f"{most_error:.1f} N m rms; this one follows best"
        )
    else:
        good = list(front[:1])
        words = (
            f"no design found keeps {100 * ENOUGH_MARGIN:.0f} % of peak torque in hand; this one keeps most. Allow more pressure "
            "(--pressure-limit), more room (--reach) or more trials"
        )
    least_gas, least_mass = min(one.score.gas for one in good), min(one.score.mass for one in good)
    best = min(good, key=lambda one: (one.score.gas / least_gas + one.score.mass / least_mass, one.design.number))
    if len(good) > 1:
        words += (
            f"; of these it has the least gas and mass together: {1e3 * best.score.gas:.1f} g a cycle "
            f"(least {1e3 * least_gas:.1f}) and {best.score.mass:.1f} kg (least {least_mass:.1f})"
        )
    place = best.score.thinnest
    if place is not None:
        words += f". Its margin, {100 * best.score.margin:.0f} %, is thinnest at {place[0]}, phase {place[2]:.2f} of {place[1]}"
    return Choice(best, words)


def nothing_found(outcome: Outcome, task: Task) -> ScenarioError:
    """Return the error that says what kept every design out."""
    violated = np.array([one.score.violations for one in outcome.trials]) > 0.0
    names = [f"{kind.name}: {words}" for kind in task.space.kinds for words in CONSTRAINTS]
    worst = int(np.argmax(violated.mean(axis=0)))
    fell = sum(one.score.simulated and not one.score.finished for one in outcome.trials)
    what = f'"{names[worst]}" keeps {100 * violated[:, worst].mean():.0f} % of them out'
    if fell and not violated[:, worst].any():
        what = f"{fell} of them lose the wearer in the coupled cycle"
    return ScenarioError(
        f"none of {len(outcome.trials)} designs carries {'; '.join(map(str, task.conditions))}: {what}; allow more pressure "
        "(--pressure-limit), more room (--reach), more trials, or less payload"
    )
