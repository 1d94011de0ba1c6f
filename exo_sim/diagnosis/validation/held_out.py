"""Errors on held-out time, before and after, and what each finding is worth there."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.split import Spans, Split
from exo_sim.diagnosis.estimation.candidate import drop_orphans
from exo_sim.diagnosis.estimation.correlation import correlation_time, rms
from exo_sim.diagnosis.findings import Series, SignalFit, Subsystem, held_out_key
from exo_sim.diagnosis.policy import validation
from exo_sim.diagnosis.selection.fitted_model import FittedModel, remains
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import UnknownEffect, effect_of
from exo_sim.diagnosis.subsystem_model import Comparison, SubsystemModel
from exo_sim.recording.noise import by_chance

Array = NDArray[np.float64]
Key = TypeVar("Key")
Value = TypeVar("Value")


@dataclass(frozen=True)
class BalanceError:
    """The error of one balance on held-out time, in units of the noise.

    Attributes:
        error: Root mean square there.
        fitted: What the fit leaves on the training data.
        bound: Largest error of a healthy machine.
        log10_odds: That it is more than noise.
    """

    error: float
    fitted: float
    bound: float
    log10_odds: float

    @property
    def ratio(self) -> float:
        """The error in units of what the fit leaves, or of the noise where that is larger; 0 where it is not a number."""
        return _finite(self.error / max(self.fitted, 1.0))

    def exceeds_bound(self, times: float = 1.0) -> bool:
        """Return whether the error is more than so many times that of any healthy machine."""
        return self.error > times * self.bound

    def newly_exceeds_bound(self, times: float = 1.0) -> bool:
        """Return whether it is, while that of the fit is within the bound."""
        return self.exceeds_bound(times) and self.fitted < self.bound


@dataclass(frozen=True)
class Worth:
    """What a finding is worth on held-out time.

    Attributes:
        gained: By how much the sum of squared errors falls with it, in units of the noise.
        missing: By how much that sum exceeds the noise without it.
        is_plain: Whether that is more than noise does by chance.
        amplitude, error: How much of the change that it makes to predictions is there, by least squares, and the standard error of that:
            1 where the recording shows it as it was found, 0 where not at all.
    """

    gained: float
    missing: float
    is_plain: bool = True
    amplitude: float = 0.0
    error: float = 0.0

    @property
    def speaks_against(self) -> bool:
        """Whether a small share speaks against it: where more than noise is missing, and the change that it makes is surely not there.

        Beside something larger that is missing as well a true effect explains little, and held-out time may tell what was found neither
        from nothing nor from all of it.
        """
        reach = validation.TOLD_APART * self.error
        undecided = abs(self.amplitude) < reach and abs(self.amplitude - 1.0) < reach
        return self.is_plain and not undecided and self.amplitude + self.error <= validation.SHOWN

    @property
    def share(self) -> float:
        """What it explains of the squared error that is missing beyond the noise without it, 0 to 1."""
        return min(max(_finite(self.gained / max(self.missing, self.gained, 1e-12)), 0.0), 1.0)


@dataclass(frozen=True)
class HeldOutErrors:
    """Errors on held-out time.

    Attributes:
        signals: By column, before and after.
        drops: By `effect@where` (by place for an unknown effect), the share by which the error falls with it.
        influence: By the keys of `drops`, how much predictions change with it [units of the noise].
        left: By the keys of `drops`, the error of the time that was fitted when all the rest is fitted without it [units of the noise].
        where_acting: By the keys of `drops`, the error without it where predictions change with it, in units of the most that noise by
            itself leaves there but for chance: each row's square is weighed by that of the change; only where predictions change with it
            by `LEAST_INFLUENCE`.
        beyond_healthy: By the keys of `where_acting`, how much predictions of the time that was fitted change with it where they change,
            in units of what the laws of a healthy machine get wrong there; only where anybody knows that.
        costs: By the keys of `drops`, `influence` as a share of how much the predicted signals vary; 0 for a shared supply: it is measured.
        balances: By subsystem and name.
        series: For the report.
        spans: The held-out time, by recording.
        worth: By the keys of `drops`, what a finding is worth; only where predictions change with it by `LEAST_INFLUENCE` and something
            beyond the noise is missing without it: else it was not tested.
    """

    signals: Mapping[str, SignalFit] = field(default_factory=dict)
    drops: Mapping[str, float] = field(default_factory=dict)
    influence: Mapping[str, float] = field(default_factory=dict)
    left: Mapping[str, float] = field(default_factory=dict)
    where_acting: Mapping[str, float] = field(default_factory=dict)
    beyond_healthy: Mapping[str, float] = field(default_factory=dict)
    costs: Mapping[str, float] = field(default_factory=dict)
    balances: Mapping[tuple[Subsystem, str], BalanceError] = field(default_factory=dict)
    series: tuple[Series, ...] = ()
    spans: Spans = field(default_factory=dict)
    worth: Mapping[str, Worth] = field(default_factory=dict)

    @property
    def ratio(self) -> float:
        """The largest ratio of a balance; infinite where no signal could be compared."""
        return max((one.ratio for one in self.balances.values()), default=0.0) if self.signals else math.inf

    def updated(self, later: HeldOutErrors, gone: Collection[str]) -> HeldOutErrors:
        """Return these errors with those of a later look at some subsystems in the place of theirs.

        Args:
            later: The later ones.
            gone: Keys of `drops` that are no findings any more.
        """

        def both(mine: Mapping[Key, Value], theirs: Mapping[Key, Value]) -> dict[Key, Value]:
            return {key: value for key, value in {**mine, **theirs}.items() if key not in gone}

        seen = {(one.recording, one.signal): one for one in later.series}
        return replace(
            self,
            signals={**self.signals, **later.signals},
            drops=both(self.drops, later.drops), influence=both(self.influence, later.influence), costs=both(self.costs, later.costs),
            left=both(self.left, later.left), where_acting=both(self.where_acting, later.where_acting),
            beyond_healthy=both(self.beyond_healthy, later.beyond_healthy),
            worth={key: one for key, one in both(self.worth, later.worth).items() if key in later.worth or key not in later.drops},
            balances={**self.balances, **later.balances},
            series=tuple(seen.get((one.recording, one.signal), one) for one in self.series),
        )  # fmt: skip


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
    worth: dict[str, Worth] = {}
    influence: dict[str, float] = {}
    left: dict[str, float] = {}
    where_acting: dict[str, float] = {}
    beyond_healthy: dict[str, float] = {}
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
        for key, refitted in _left_out(one):
            other = model.residual_of(one.plant_of(refitted))
            left[key] = rms(refitted.fit.residual)
            with_it, lacking = rms(named), rms(other)
            drops[key] = _finite(1.0 - with_it / lacking) if lacking > 0.0 else 0.0
            influence[key] = _finite(rms(other - named))
            costs[key] = influence[key] * _noise_share(one, compared)
            if influence[key] <= validation.LEAST_INFLUENCE:  # what changes nothing was not tested
                continue
            where_acting[key] = _missed_where_acting(other, other - named)
            beyond = _beyond(refitted.fit.residual - one.final.fit.residual, misfit)
            if beyond is not None:
                beyond_healthy[key] = beyond
            if lacking > 1.0:
                independent = other.size / max(correlation_time(other, model.blocks), 1.0)
                gained, missing = other.size * (lacking**2 - with_it**2), other.size * (lacking**2 - 1.0)
                there = _amplitude(named, other - named, model.blocks)
                worth[key] = Worth(gained, missing, lacking**2 > by_chance(independent), *there)
        if effect is not None:
            drops[one.where] = _drop_with_unknown(model, one, error, own)
            costs[one.where] = rms(model.residual_of(one.final_plant)) * _noise_share(one, compared)
    return HeldOutErrors(signals, drops, influence, left, where_acting, beyond_healthy, costs, balances, tuple(series), split.test, worth)


def _amplitude(named: Array, change: Array, blocks: NDArray[np.int64]) -> tuple[float, float]:
    """Return how much of a change is there by least squares, and the standard error of that, neighbours counted once.

    Args:
        named: Residual with all of it, shape (n,).
        change: What leaving it out adds to that, shape (n,).
        blocks: Block of each row, shape (n,).
    """
    with np.errstate(over="ignore", invalid="ignore"):
        power = float(change @ change)
        along = named * change
        error = math.sqrt(float(along @ along) * correlation_time(along, blocks)) / max(power, 1e-300)
        found = 1.0 + float(along.sum()) / max(power, 1e-300)
    return (found, error) if math.isfinite(found) and math.isfinite(error) else (0.0, 0.0)


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
            _finite(rms(np.concatenate([one.error_before for one in parts]))),
            _finite(rms(np.concatenate([one.error_after for one in parts]))),
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
    return _finite(float(np.median(shares))) if shares else 0.0


def _left_out(one: SubsystemResult[SubsystemModel]) -> list[tuple[str, FittedModel]]:
    """Return, for each finding, its key and the model that is refitted without it and what comes on top of it.

    Not of one that is still there then: a lag and a delay of a valve that healthy valves have may together be more than a healthy one's.
    """
    reported = {finding.at for finding in one.findings}
    found = []
    for candidate in (candidate for candidate in one.named if candidate.at in reported):
        rest = drop_orphans([c for c in one.final.candidates if c.key != candidate.key])
        refitted = one.fits.fit(rest, one.final)
        if not remains(candidate, refitted):
            found.append((held_out_key(*candidate.at), refitted))
    return found


def _drop_with_unknown(
    model: SubsystemModel, one: SubsystemResult[SubsystemModel], error: float, signals: Mapping[str, SignalFit]
) -> float:
    """Return the share by which the error falls with an unknown effect; from the signal where no plant can hold its curve."""
    if model.plant_holds_curves:
        plain = rms(model.residual_of(one.final_plant))
        return _finite(1.0 - error / plain) if plain > 0.0 else 0.0
    first = next(iter(signals.values()))
    return _finite(1.0 - first.after / first.before) if first.before > 0.0 else 0.0


def _finite(value: float) -> float:
    """Return the value, or 0 where it is not a number."""
    return float(value) if np.isfinite(value) else 0.0
