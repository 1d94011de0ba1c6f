"""Errors on held-out time, before and after, and what each finding gains there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.correlation import correlation_time, rms
from exo_sim.diagnosis.findings import Series, SignalFit, Subsystem, held_out_key
from exo_sim.diagnosis.policy import validation
from exo_sim.diagnosis.selection.held_out_gain import HeldOutGain
from exo_sim.diagnosis.selection.left_out import LeftOut, left_out
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import UnknownEffect, effect_of
from exo_sim.diagnosis.subsystem_model import Comparison, SubsystemModel
from exo_sim.diagnosis.validation.held_out_errors import BalanceError, HeldOutErrors, finite
from exo_sim.recording.noise import by_chance

Array = NDArray[np.float64]


def held_out_errors(
    results: Sequence[SubsystemResult[SubsystemModel]], unknown: Sequence[UnknownEffect], split: Split, keep_series: bool = True
) -> HeldOutErrors:
    """Return the errors of the nominal machine and of the machine as it was found to be, predicted over the test time of a split.

    Args:
        results: Of all subsystems.
        unknown: Effects without a name, described.
        split: Its test time is predicted.
        keep_series: Whether the predictions themselves are kept: they are as long as the recordings.
    """
    signals: dict[str, SignalFit] = {}
    drops: dict[str, float] = {}
    gains: dict[str, HeldOutGain] = {}
    influence: dict[str, float] = {}
    left: dict[str, float] = {}
    where_acting: dict[str, float] = {}
    beyond_healthy: dict[str, float] = {}
    relief: dict[str, float] = {}
    costs: dict[str, float] = {}
    balances: dict[tuple[Subsystem, str], BalanceError] = {}
    series: list[Series] = []
    for one in results:
        if one.is_empty:
            continue
        effect = effect_of(unknown, one)
        model = one.model.on_test_time(split)
        found = model.with_unknown(one.final_plant, effect.discrepancy) if effect else one.final_plant
        compared = model.compared(one.model.nominal, found, effect.discrepancy.best if effect else None)
        if keep_series:
            series += [each.series for each in compared]
        own = _signals(compared)
        signals |= own
        if model.size == 0:
            continue
        residual = model.residual_of(found)
        error = rms(residual)
        rows = model.size / max(correlation_time(residual, model.blocks), 1.0)
        odds = 0.5 * rows * math.log10(max(error, 1.0) ** 2)
        balances[one.key] = BalanceError(error, rms(one.final.fit.residual), model.discrepancy_bound, odds)
        named = model.residual_of(one.final_plant)  # a curve for what has no name is not to a name's credit
        misfit = one.model.healthy_misfit() if one.findings else np.zeros(one.model.size)
        for key, (refitted, is_gone) in _left_out(one):
            other = model.residual_of(one.plant_of(refitted))
            with_it, lacking = rms(named), rms(other)
            differs = finite(rms(other - named))
            costs[key] = differs * _noise_share(one, compared)
            gain = _gain(named, other, model.blocks) if differs > validation.LEAST_INFLUENCE else None
            if not (is_gone or (gain is not None and gain.is_shown)):
                continue  # what a healthy machine has of it may be all that shows there
            drops[key] = finite(1.0 - with_it / lacking) if lacking > 0.0 else 0.0
            influence[key] = differs
            change = refitted.fit.residual - one.final.fit.residual
            if is_gone:
                left[key] = rms(refitted.fit.residual)
                relief[key] = refitted.fit.penalty - one.final.fit.penalty
                beyond = _beyond(change, misfit)
                if beyond is not None:
                    beyond_healthy[key] = beyond
            if gain is None:  # what changes nothing was not tested
                where_acting[key] = _missed_where_acting(refitted.fit.residual, change)
                continue
            where_acting[key] = _missed_where_acting(other, other - named)
            gains[key] = gain
        if effect is not None:
            drops[one.where] = _drop_with_unknown(model, one, error, own)
            costs[one.where] = rms(model.residual_of(one.final_plant)) * _noise_share(one, compared)
    return HeldOutErrors(
        signals, drops, influence, left, where_acting, beyond_healthy, costs, balances, tuple(series), split.test, gains, relief
    )


def _gain(named: Array, other: Array, blocks: NDArray[np.int64]) -> HeldOutGain:
    """Return what a finding gains on held-out time; residuals with it and without it, and the block of each row, shape (n,) each."""
    with_it, lacking = rms(named), rms(other)
    independent = other.size / max(correlation_time(other, blocks), 1.0)
    gained, missing = other.size * (lacking**2 - with_it**2), other.size * (lacking**2 - 1.0)
    there = _amplitude(named, other - named, blocks)
    return HeldOutGain(gained, missing, lacking**2 > max(by_chance(independent), 1.0), *there)


def _amplitude(named: Array, change: Array, blocks: NDArray[np.int64]) -> tuple[float, float, float]:
    """Return how much of a change is there by least squares, the standard error of that, neighbours counted once, and what that says.

    The last is by how much it changes the odds of all of the change against none of it (log10); more than all of it counts as all, less
    than none as none. Blocks of time say how far it varies, so many as share the change, and fewer where one block is off as the one before
    it. Too few do not say that: then independent rows count, whose number is known. Of one block nobody knows how far it is off: 0.

    Args:
        named: Residual with all of it, shape (n,).
        change: What leaving it out adds to that, shape (n,).
        blocks: Block of each row, shape (n,).
    """
    with np.errstate(over="ignore", invalid="ignore"):
        power = max(float(change @ change), 1e-300)
        lacking = float(named @ change) / power
        along = (named - lacking * change) * change  # of what that much of it leaves: a change that is not there is no scatter
        scatter = float(along @ along) * correlation_time(along, blocks)
        error = math.sqrt(max(scatter, power)) / power  # no less than the noise of the rows: of one that changes much there is no scatter
        found = 1.0 + lacking
        shares, away = (np.bincount(np.unique(blocks, return_inverse=True)[1], weights=one) / power for one in (change**2, along))
        many = 1.0 / max(float(shares @ shares), 1e-300)
        if not (math.isfinite(found) and math.isfinite(error)):
            return 0.0, 0.0, 0.0
        if not many > validation.FEWEST_SHARING:
            return found, error, 0.0
        longer = _lasting(away)
        spread = max(error, math.sqrt(float(away @ away) * longer * many / (many - 1.0)))
        if many < validation.BLOCKS_TELL:
            rows = 1.0 / max(float((change**2 / power) @ (change**2 / power)), 1e-300) / correlation_time(along, blocks)
            freedom = max(rows, many) - 1.0
        else:
            freedom = max(many / longer, validation.FEWEST_SHARING) - 1.0
    there = min(max(found, 0.0), 1.0)
    odds = (stats.t.logpdf((there - 1.0) / spread, freedom) - stats.t.logpdf(there / spread, freedom)) / math.log(10.0)
    return found, error, float(odds)


def _lasting(away: Array) -> float:
    """Return how many blocks of time in a row are off alike: by that the variance of a mean over them is larger, 1 where none are.

    Args:
        away: By how much each block is off, in the order of time, shape (blocks,); their sum is nil, which takes some of the likeness.
    """
    total = float(away @ away)
    if away.size < validation.BLOCKS_TELL or not total > 0.0:
        return 1.0
    like = float(away[1:] @ away[:-1]) / total + 1.0 / away.size
    like = min(max(like, 0.0), float(validation.MOST_LIKE))
    return (1.0 + like) / (1.0 - like)


def _missed_where_acting(error: Array, change: Array) -> float:
    """Return what an error is of the most that noise leaves, each row weighed by the square of a change; infinite where nothing changes.

    Args:
        error: Residual in units of the noise, shape (n,).
        change: How a prediction changes, in the same units, shape (n,).
    """
    with np.errstate(over="ignore", invalid="ignore"):
        weights = change**2
        total = float(weights.sum())
        if not 0.0 < total < math.inf:
            return math.inf
        independent = total**2 / float(weights @ weights)
        square = float(weights @ error**2) / total
    return math.sqrt(square / by_chance(independent)) if math.isfinite(square) else math.inf


def _beyond(change: Array, misfit: Array) -> float | None:
    """Return how large a change is in units of a misfit, both by row, shape (n,), each row weighed by the square of the change.

    What changes in fewer rows than `FEWEST_CHANGED` counts as if it were spread over so many. None where nothing changes, or nobody knows
    the misfit of what does.
    """
    known = misfit > 0.0
    scale = float(np.abs(change[known]).max(initial=0.0))
    if not 0.0 < scale < math.inf:
        return None
    squares = (change[known] / scale) ** 2
    spread = min(float(squares.sum()) ** 2 / float(squares @ squares) / validation.FEWEST_CHANGED, 1.0)
    return scale * math.sqrt(spread * float(squares @ squares) / float(squares @ misfit[known] ** 2))


def _signals(compared: Sequence[Comparison]) -> dict[str, SignalFit]:
    """Return the errors of each signal over all recordings."""
    by_signal: dict[str, list[Comparison]] = {}
    for one in compared:
        by_signal.setdefault(one.series.signal, []).append(one)
    return {
        key: SignalFit(
            parts[0].series.unit,
            finite(rms(np.concatenate([one.error_before for one in parts]))),
            finite(rms(np.concatenate([one.error_after for one in parts]))),
            max(one.series.noise for one in parts),
        )
        for key, parts in by_signal.items()
        if any(one.error_before.size for one in parts)
    }


def _noise_share(one: SubsystemResult[SubsystemModel], compared: Sequence[Comparison]) -> float:
    """Return the noise as a share of what the predicted signals vary: it turns units of the noise into what a prediction is off by."""
    if one.model.is_input_of_others:
        return 0.0
    shares = [each.series.noise / spread for each in compared if (spread := float(np.nanstd(each.series.recorded))) > 0.0]
    return finite(float(np.median(shares))) if shares else 0.0


def _left_out(one: SubsystemResult[SubsystemModel]) -> list[tuple[str, LeftOut]]:
    """Return, for each finding, its key and the model without it."""
    reported = {finding.at for finding in one.findings}
    asked = [candidate for candidate in one.named if candidate.at in reported]
    return [(held_out_key(*candidate.at), left_out(candidate, one.final, one.fits)) for candidate in asked]


def _drop_with_unknown(
    model: SubsystemModel, one: SubsystemResult[SubsystemModel], error: float, signals: Mapping[str, SignalFit]
) -> float:
    """Return the share by which the error falls with the curve of an unknown effect, beside all else that was found.

    Where no plant can hold the curve, it is that of the signal.

    Args:
        model: On the time that is judged.
        one: The result that it belongs to.
        error: With the curve [units of the noise].
        signals: With the curve.
    """
    if model.plant_holds_curves:
        plain = rms(model.residual_of(one.final_plant))
        return finite(1.0 - error / plain) if plain > 0.0 else 0.0
    without = next(iter(_signals(model.compared(one.model.nominal, one.final_plant)).values())).after
    return finite(1.0 - next(iter(signals.values())).after / without) if without > 0.0 else 0.0
