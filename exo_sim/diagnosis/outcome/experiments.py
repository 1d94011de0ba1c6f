"""What to record next, by simulation: the experiment in which two explanations differ most beyond what either could adapt."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.candidate import drop_orphans
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters
from exo_sim.diagnosis.policy.budgets import AS_TELLING, RANKED
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel

Array = NDArray[np.float64]


def ranked_experiments(result: SubsystemResult[SubsystemModel], effect: str, rival: str) -> tuple[tuple[str, float], ...]:
    """Return the experiments of a subsystem's menu with the log10 of the odds that each is expected to give, the best first.

    Both explanations are fitted to what was recorded; what they predict of an experiment is compared after each number of the first has
    been allowed to move within its standard error: gain = d' (I + S S')^-1 d / 2, S the responses to one standard error each.

    Args:
        result: Of the subsystem in which the two look alike.
        effect, rival: Their names; the first is in the final model.
    """
    chosen = next((c for c in result.named if c.effect == effect), None)
    instead = next((r for c in result.named if c is chosen for r, _ in result.search.rivals.get(c.key, ()) if r.effect == rival), None)
    if chosen is None or instead is None:
        return ()
    final = result.final
    other = result.fits.fit(drop_orphans([*final.without(chosen), instead]), final, again=True)
    errors = result.fits.standard_errors(final)
    moved = [(q, error) for q, error in errors.items() if math.isfinite(error) and error > 0.0]
    plants = [result.plant_of(final), result.plant_of(other), *(shifted(result, final, q, error) for q, error in moved)]
    return ranked({do: expected_gain(predicted) for do, predicted in result.model.experiments(plants).items()})


def ranked(gains: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    """Return the experiments that tell most, the best first; of several that tell as much, the first.

    Args:
        gains: By experiment, the easiest first, the log10 of the odds that it is expected to give.
    """
    found: list[tuple[str, float]] = []
    left = {do: gain for do, gain in gains.items() if gain > 0.0}
    while left and len(found) < RANKED:
        most = max(left.values())
        alike = [do for do, gain in left.items() if gain >= (1.0 - AS_TELLING) * most]
        found.append((alike[0], left[alike[0]]))
        left = {do: gain for do, gain in left.items() if do not in alike}
    return tuple(found)


def shifted(result: SubsystemResult[SubsystemModel], final: FittedModel, parameter: FreeParameter, error: float) -> PlantParameters:
    """Return the plant of a fitted model with one number moved by its standard error, inwards at a bound."""
    value = final.fit.values[parameter]
    step = error if value + error <= parameter.high else -error
    return result.model.apply({**final.fit.values, parameter: value + step}, final.fixed)


def expected_gain(predicted: Array) -> float:
    """Return the log10 of the odds that an experiment is expected to give.

    Args:
        predicted: Whitened predictions of the first explanation, of the second, and of the first with each number moved by its standard
            error, shape (2 + numbers, rows).
    """
    if not np.isfinite(predicted).all():
        return 0.0
    apart, responses = predicted[1] - predicted[0], (predicted[2:] - predicted[0]).T
    inner = np.eye(responses.shape[1]) + responses.T @ responses
    left = apart - responses @ np.linalg.solve(inner, responses.T @ apart)
    return float(0.5 * apart @ left / math.log(10.0))


def in_which(results: Sequence[SubsystemResult[SubsystemModel]], effect: str, where: str) -> SubsystemResult[SubsystemModel] | None:
    """Return the result that names an effect at a place."""
    return next((one for one in results for f in one.findings if f.at == (effect, where)), None)
