"""What is left far above the noise, in words: by the fitted balances, by the rig as handed in run free, and by its refitted numbers."""

from __future__ import annotations

from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.policy.recordings import LOUD_DRIFT, LOUD_REST
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.report import amounts


def of_rig(diagnosis: Diagnosis) -> str:
    """Return what fitted balances miss, and the rig as handed in where nothing corrects it; "" where neither misses much.

    A free run drifts on its own, so that more is asked of it before it is reported. What numbers refitted within their data sheets take
    away is no fault of the rig, and what they add is none either.
    """
    parts = [rest] if (rest := of_balances(diagnosis, LOUD_REST)) else []
    drifts = {key: fit for key, fit in diagnosis.free_run.items() if _is_loud(fit, fit.before) and _is_loud(fit, fit.after)}
    if drifts:
        key, fit = max(drifts.items(), key=lambda pair: min(pair[1].before, pair[1].after) / pair[1].noise)
        noise = "what a sensor shows of noise" if key in diagnosis.computed else "the noise"
        often = f"{amounts.digits(fit.before / fit.noise, 2)} times {noise}"
        refitted = amounts.amount(fit.after, fit.unit)
        given = amounts.amount(fit.before, fit.unit)
        beside = f" ({refitted} with improved.toml)" if refitted != given else ""
        parts.append(f"run free, {key} is {given} off, {often}{beside}")
    return "; ".join(parts)


def of_refit(diagnosis: Diagnosis) -> str:
    """Return by how much refitted numbers stray where the rig as handed in hardly does, as a clause; "" where they do not."""
    further = {key: fit for key, fit in diagnosis.free_run.items() if _is_loud(fit, fit.after) and not _is_loud(fit, fit.before)}
    further = {key: fit for key, fit in further.items() if key not in diagnosis.by_chance}
    if not further:
        return ""
    key, fit = max(further.items(), key=lambda pair: pair[1].after / pair[1].noise)
    refitted, given = amounts.amount(fit.after, fit.unit), amounts.amount(fit.before, fit.unit)
    return f"run free, improved.toml, which holds its numbers refitted, is {refitted} off at {key}, the rig as it is {given}"


def of_balances(diagnosis: Diagnosis, times: float) -> str:
    """Return what the fitted balances miss by more than so many times the noise, at the worst, as a clause; "" where nothing does."""
    loud = [one for one in diagnosis.unexplained if one.error > times * one.noise > 0.0]
    if not loud:
        return ""
    worst = max(loud, key=lambda one: one.error / one.noise)
    part, _, balance = worst.where.partition("/")
    often = amounts.digits(worst.error / worst.noise, 2)
    return f"{amounts.amount(worst.error, worst.unit)} are left in the {balance} of {part}, {often} times the noise"


def _is_loud(fit: SignalFit, error: float) -> bool:
    return error > LOUD_DRIFT * fit.noise > 0.0
