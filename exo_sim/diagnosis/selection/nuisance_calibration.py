"""Nuisance parameters that a fit found to be off: which are reported as calibrations, which are only refitted, and in what words."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.prior_terms import as_counted
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH, bounded_interval, interval
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME, INITIAL_TEMPERATURE
from exo_sim.diagnosis.policy.off_nominal import BEYOND_SHEET, GAIN_SHARE, LAW_SHARE, MOVED, OPEN_LAW_SHARE, SURE, WORTH
from exo_sim.diagnosis.policy.probability import CALIBRATED, UNTESTED
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.nuisances_beyond_prior import is_beyond_data_sheet
from exo_sim.physics.declaration import declared, identification_of


@dataclass(frozen=True)
class Deviation:
    """A nominal number that is off.

    Attributes:
        parameter: The number.
        factor, error: By which factor it is off, and its standard error.
        stands_for: Effects that explain nearly as much in its place.
        twins: Effects that nothing in the recordings could tell from it.
        counted_in: An effect of the model that its owner seems to have counted in, ...
        with_it: ... and the factor with that.
    """

    parameter: FreeParameter
    factor: float
    error: float
    stands_for: tuple[str, ...] = ()
    twins: tuple[str, ...] = ()
    counted_in: str = ""
    with_it: float = math.nan

    @property
    def is_beyond_data_sheet(self) -> bool:
        """Whether it is surely further off than any data sheet leaves open, with what was counted in."""
        return is_beyond_data_sheet(self.parameter, self.with_it if self.counted_in else self.factor, self.error)


def error_of_law(parameter: FreeParameter, value: float, error: float) -> float:
    """Return the standard error of a number of an effect that the rig has, as a number of the machine.

    A law is never quite the machine's: what its form makes of the number counts as an error, and what is open before any data: of a time
    what clocks leave open, of others what a healthy machine shows beside them.

    Args:
        parameter, value: The number, as fitted.
        error: Its standard error by the fit.
    """
    declares = identification_of(parameter.effect)
    share = OPEN_LAW_SHARE if declares.known else LAW_SHARE
    clocks = parameter.prior[1] if parameter.prior and parameter.unit == "s" else 0.0
    return math.hypot(error, clocks or declares.beside(parameter.parameter), share * abs(value))


def deviations(
    model: FittedModel, errors: Mapping[FreeParameter, float], by_fit: Mapping[FreeParameter, float] | None = None
) -> tuple[Deviation, ...]:
    """Return the nominal numbers that are surely off, and by enough to be worth correcting.

    What a law is taken to be where nobody gave it is no nominal number.

    Args:
        model: The fit.
        errors: Standard errors, with what the form of the equations leaves open: the 95 % interval by them does not hold what was believed.
        by_fit: Standard errors by the fit alone, by which it is surely off; the same where absent.
    """
    found, effects = [], model.effect_parameters
    plain = errors if by_fit is None else by_fit
    for parameter, value in model.fit.values.items():
        whole = parameter.prior[0] if parameter.prior and parameter.effect in declared() else 1.0
        if whole == 0.0 or (parameter.effect not in WORTH and parameter.effect not in declared()) or parameter in effects:
            continue
        declares = identification_of(parameter.effect)
        if parameter.effect in declared() and declares.known.get(parameter.parameter) == parameter.prior:
            continue
        factor, error = value / whole, errors.get(parameter, math.inf) / abs(whole)
        if parameter.effect in declared():
            error = error_of_law(parameter, value, errors.get(parameter, math.inf)) / abs(whole)
            is_off = abs(math.log(factor)) * factor > SURE * error if factor > 0.0 else 1.0 - factor > SURE * error
        else:
            far = parameter.prior is not None and abs(factor - 1.0) > BEYOND_SHEET.get(parameter.effect, math.inf) * parameter.prior[1]
            surely = max(SURE * plain.get(parameter, math.inf), HALF_WIDTH * max(error, GAIN_SHARE), WORTH[parameter.effect])
            is_off = far or abs(factor - 1.0) > surely
        if is_off:
            with_it = as_counted(parameter, model.fit.values)
            owner = next((q.effect for q in effects if parameter.key in dict(q.displaces)), "") if with_it != value else ""
            found.append(Deviation(parameter, factor, error, counted_in=owner, with_it=with_it / whole))
    return tuple(found)


def counted_back(found: Sequence[Deviation], gone: Collection[tuple[str, str]]) -> tuple[Deviation, ...]:
    """Return deviations beside which effects are not named any more: what an owner counted of them in a number stays in it.

    Args:
        found: As found beside all effects.
        gone: Effect and place of those that are not named.
    """
    kept = []
    for one in found:
        if (one.counted_in, one.parameter.where) not in gone:
            kept.append(one)
            continue
        whole = replace(one, factor=one.with_it, counted_in="", with_it=math.nan)
        if abs(whole.factor - 1.0) > max(HALF_WIDTH * whole.error, WORTH[whole.parameter.effect]):
            kept.append(whole)
    return tuple(kept)


def refitted_besides(
    model: FittedModel, errors: Mapping[FreeParameter, float], reported: Collection[FreeParameter], named: bool
) -> tuple[tuple[FreeParameter, float], ...]:
    """Return nuisance parameters that the improved rig should hold as fitted and that are no finding, with their standard errors.

    Those that are surely off; and beside anything that is written, all that the rig holds: numbers of one fit predict well together only.
    How warm the gas was at the start is the recording's, not the rig's. What they are worth in a machine of another form is not asked: with
    them the recording is predicted best.

    Args:
        model: The fit.
        errors: Standard errors by the fit.
        reported: Parameters that are written as calibrations.
        named: Whether effects, or laws of them, are written.
    """
    effects = model.effect_parameters
    moved = []
    for parameter, value in model.fit.values.items():
        error = errors.get(parameter, math.inf)
        if parameter.effect == INITIAL_TEMPERATURE:
            continue
        if parameter.prior and parameter not in reported and parameter not in effects and math.isfinite(error):
            moved.append((parameter, error, abs(value - parameter.prior[0])))
    surely = {parameter for parameter, error, by in moved if by > SURE * error}
    beside = named or bool(reported) or bool(surely)
    return tuple(
        (q, error) for q, error, by in moved if q in surely or (beside and q.prior and by > MOVED * (abs(q.prior[0]) or q.prior[1]))
    )


def calibration_findings(found: Sequence[Deviation]) -> list[Finding]:
    """Return a finding for every nominal number that is off; the two dead volumes of a cylinder are one finding.

    One that is further off than any data sheet allows says what it may stand for.
    """
    kinds: dict[tuple[str, str], list[Deviation]] = {}
    for one in found:
        kinds.setdefault((one.parameter.effect, one.parameter.where), []).append(one)
    return [_calibration(name, where, parts) for (name, where), parts in kinds.items()]


def _calibration(name: str, where: str, parts: Sequence[Deviation]) -> Finding:
    weights = [1.0 / max(one.error, 1e-9) ** 2 for one in parts]
    mean = sum(w * one.factor for w, one in zip(weights, parts, strict=True)) / sum(weights)
    apart = max(abs(one.factor - mean) for one in parts)
    spread = max(math.sqrt(1.0 / sum(weights)), apart, GAIN_SHARE)
    low, high = interval(mean, spread) if is_declared(name) else bounded_interval(parts[0].parameter, mean, spread)
    estimates = {"factor": Estimate(mean, "1", low, high)}
    if name == DEAD_VOLUME:
        for one in parts:
            ends = bounded_interval(one.parameter, one.factor, max(one.error, GAIN_SHARE))
            estimates[one.parameter.parameter] = Estimate(one.factor, "1", *ends)
    if is_declared(name):
        estimates = {
            q.parameter: Estimate(
                one.factor * q.prior[0],
                q.unit,
                *sorted(q.prior[0] * end for end in interval(one.factor, max(one.error, GAIN_SHARE))),
            )
            for one in parts
            if (q := one.parameter).prior
        }
    says = " ".join(wording.calibration(name, one.parameter.parameter, one.factor) for one in parts)
    beyond = name in wording.STANDS_FOR and any(one.is_beyond_data_sheet for one in parts)
    rivals = tuple(dict.fromkeys(rival for one in parts for rival in one.stands_for)) if beyond else ()
    if beyond:
        says += " " + wording.beyond_data_sheet(name, rivals)
    elif all(one.counted_in for one in parts):
        says += " " + wording.counted_in(parts[0].counted_in)
    elif name == DEAD_VOLUME and any(one.factor > 1.0 and not one.counted_in for one in parts):
        says += " " + wording.warm_hose()
    twins = tuple(dict.fromkeys(twin for one in parts for twin in one.twins))
    if twins:
        says += f" {wording.twins(twins)}"
    odds = sum(((one.factor - 1.0) / max(one.error, 1e-12)) ** 2 for one in parts) / (2.0 * math.log(10.0))
    shares = dict.fromkeys((name, *rivals), 1.0 / (1 + len(rivals))) if rivals else {}
    probability = float(UNTESTED if is_declared(name) else CALIBRATED)
    return Finding(name, where, Kind.CALIBRATION, says, estimates, odds, 0.0, (*rivals, *twins), shares, probability=probability)


def is_declared(effect: str) -> bool:
    """Return whether a name is one of the declared effects."""
    return effect in declared()
