"""Whether the command at which each edge of a valve opens is free: only where that explains the gas, for it costs many predictions."""

from __future__ import annotations

import math
from collections.abc import Sequence

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.policy.acceptance import FELT_LAPS
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.declaration import identification_of

#: Gauss-Newton steps of each of the two fits.
_STEPS = 8


def with_felt_laps(
    model: SubsystemModel, nuisances: Sequence[FreeParameter], threads: Threads = SERIAL, is_spent: IsSpent = never
) -> tuple[FreeParameter, ...]:
    """Return the nuisance parameters, without what a healthy valve's edges open at one by one where that explains nothing.

    It stays where a machine with nothing hidden leaves no more with it than healthy ones do, and where it explains most of what is missing
    without it. Beside a large error of another kind it would only bend, and every fit would take a fifth more predictions.

    Args:
        model: The gas.
        nuisances: All nuisance parameters.
        threads: Threads.
        is_spent: Whether the time is up.
    """
    laps = frozenset(q for q in nuisances if _is_lap(q))
    rest = tuple(q for q in nuisances if q not in laps)
    if not laps or not model.size or is_spent():
        return rest if laps and is_spent() else tuple(nuisances)

    def left(free: Sequence[FreeParameter]) -> float:
        found = fit(model.residual, free, {q: q.start for q in free}, threads, max_iterations=_STEPS, is_spent=is_spent)
        return math.sqrt(found.sse / model.size)

    with_them = left(nuisances)
    is_felt = with_them < model.discrepancy_bound or with_them < FELT_LAPS * left(rest)
    return tuple(nuisances) if is_felt else rest


def _is_lap(parameter: FreeParameter) -> bool:
    """Return whether a nuisance parameter is one of several that a dead band has in common, of a valve whose owner says nothing of it."""
    says_nothing = parameter.prior is not None and parameter.prior[0] == 0.0
    return says_nothing and parameter.parameter in identification_of(parameter.effect).common[1]
