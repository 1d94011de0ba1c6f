"""A diagnosis in sentences: what page and terminal both say."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from exo_sim.diagnosis.findings import Estimate, Finding, SignalFit, Unexplained
from exo_sim.diagnosis.outcome.wrong_sizes import still_far
from exo_sim.diagnosis.policy.recordings import LOUD_DRIFT
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.diagnosis.wording import name_of
from exo_sim.physics.declaration import declared
from exo_sim.report import amounts, left_over

#: What a verdict is called on a page.
VERDICTS = {
    "consistent": "Consistent",
    "calibration": "Nominal numbers are off",
    "mismatch": "Mismatch",
    "undetermined": "Cannot tell",
}
#: Of how much signals vary: what costs less is not told as a share.
LEAST_COST = 5e-4
#: An error that is less than this share of the noise is none.
NIL = 0.01
_CORRECTED = ("sensor_bias", "sensor_scale", "sensor_delay")
KINDS = {
    "missing_physics": "missing physics",
    "calibration": "nominal number off",
    "sensor": "sensor at fault",
    "unknown": "without a name",
}


def joined(words: Sequence[str]) -> str:
    """Return "a", "a and b", "a, b and c"."""
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + f" and {words[-1]}" if words else ""


def title(finding: Finding) -> str:
    """Return name and place of a finding as a heading."""
    name = name_of(finding.name)
    name = name[0].upper() + name[1:]
    return name if finding.where in finding.name.split("_") and finding.where in ("supply", "exhaust") else f"{name} at {finding.where}"


def verdict(diagnosis: Diagnosis) -> str:
    """Return the answer in one sentence."""
    by_kind = {kind: [f for f in diagnosis.effects if f.kind == kind] for kind in KINDS}
    parts = []
    if missing := by_kind["missing_physics"]:
        parts.append(f"the rig leaves out {joined([_placed(f) for f in missing])}")
    if unknown := by_kind["unknown"]:
        parts.append(f"something without a name acts at {joined([f.where for f in unknown])}")
    if sensors := by_kind["sensor"]:
        parts.append(f"{joined([_sensor(f) for f in sensors])}")
    if numbers := by_kind["calibration"]:
        listed = joined(list(dict.fromkeys(f"{name_of(f.name)} of {f.where}" for f in numbers)))
        off = f"{_count(len(numbers))} nominal number{' is' if len(numbers) == 1 else 's are'} off"
        if not parts:
            return f"No physics is missing, but {off}: {listed}."
        parts.append(f"{off} as well")
    if diagnosis.verdict == "consistent":
        if rest := left_over.of_rig(diagnosis):
            return f"No physics is missing as far as these recordings tell, but the rig is not exact: {rest}."
        noise = "what a sensor could show" if diagnosis.computed else "the noise"
        return f"Recording and rig agree to within {noise} and what a healthy machine shows."
    if diagnosis.verdict == "undetermined" and not parts:
        return "These recordings cannot tell whether the rig leaves anything out."
    if not unknown and (rest := left_over.of_balances(diagnosis, LOUD_DRIFT)):
        parts.append(f"{rest}, and have no name")
    sentence = "; ".join(parts) or "something is missing"
    if diagnosis.verdict == "undetermined":
        sentence = f"these recordings cannot tell for certain: {sentence}"
    return sentence[0].upper() + sentence[1:] + "."


def unexplained(left: Unexplained) -> str:
    """Return what no name explains as a phrase."""
    size = f": {amounts.amount(left.error, left.unit)}" if left.error > 0.0 else ""
    size += f", {amounts.digits(left.error / left.noise, 2)} times the noise" if size and left.noise > 0.0 else ""
    follows = f", follows {joined(left.depends_on)}" if left.depends_on else ""
    follows += f", of whose variance a curve predicts {amounts.share(left.by_curve)}" if left.by_curve > 0.0 else ""
    return f"{amounts.share(left.share)} of the error, in {left.where}{size}{follows}"


def small(finding: Finding) -> str:
    """Return what is too small to matter, and where."""
    return f"{name_of(finding.name)} at {finding.where}{', other than nominal' if finding.kind == 'calibration' else ''}"


def first_step(diagnosis: Diagnosis) -> str:
    """Return what to do first, in a sentence or two; empty where there is nothing to do."""
    if misnamed := [(column, check["meant"]) for check in diagnosis.checks if check.get("meant") for column in check["columns"]]:
        renamed = joined([f'"{column}" to "{meant}"' for column, meant in misnamed])
        unread = "under that name it is" if len(misnamed) == 1 else "under those names they are"
        return f"Rename column{'s' if len(misnamed) > 1 else ''} {renamed} and diagnose again: {unread} not read."
    if without := _to_put_right(diagnosis):
        return without
    if diagnosis.sizes and diagnosis.stopped:
        return (
            f"Diagnose again with a longer budget: the time was up before everything had been sought.{_hardly_better(diagnosis)} "
            f"If it stays so, check {diagnosis.sizes}."
        )
    if diagnosis.sizes:
        return f"Check {diagnosis.sizes}.{_hardly_better(diagnosis)}"
    by_kind = {kind: [f for f in diagnosis.effects if f.kind == kind] for kind in KINDS}
    if sensors := [f for f in by_kind["sensor"] if f.name not in _CORRECTED]:
        return f"Check the sensor of {sensors[0].where}, then record again: what it shows was set aside."
    costly = sorted((f for f in diagnosis.effects if f.kind in ("missing_physics", "unknown")), key=lambda f: -f.cost)
    if costly and costly[0].kind == "missing_physics":
        first = costly[0]
        held = f"[effects.{first.name}.{first.where}]"
        if held not in diagnosis.improved:
            return f"Settle {_placed(first)} first: it costs the predictions most, and improved.toml does without it."
        check = on_the_machine(first)
        return f"Simulate with improved.toml; {_placed(first)} matters most to its predictions." + (
            f" To see it on the machine: {check}." if check else ""
        )
    if costly and diagnosis.next_experiment is not None:
        return f"Find out what acts at {costly[0].where}: {diagnosis.next_experiment.do}."
    if by_kind["calibration"] or by_kind["sensor"]:
        if not diagnosis.improves:
            return "Keep the rig as it is: with the corrected numbers it predicts held-out time no better."
        return "Simulate with improved.toml: it holds the corrected numbers."
    if diagnosis.verdict == "consistent" and (further := left_over.of_refit(diagnosis)):
        return f"Keep the rig as it is: {further}."
    if diagnosis.verdict == "undetermined" and diagnosis.next_experiment is not None:
        return f"Record once more: {diagnosis.next_experiment.do}."
    return ""


def _to_put_right(diagnosis: Diagnosis) -> str:
    """Return what of the columns or of the rig is to be put right, for nothing could be made of a column, as a sentence; "" where none."""
    valveless = [check["columns"][0].rpartition(".")[0] for check in diagnosis.checks if check["what"] == "valve"]
    kinds = [check["columns"][0].rpartition(".")[0] for check in diagnosis.checks if check["what"] == "valve kind"]
    unread = [f'"{column}"' for check in diagnosis.checks if check["what"] == "unread" for column in check["columns"]]
    blank = [f for f in diagnosis.effects if f.name == "sensor_scale" and not f.parameters and not f.where.endswith(".velocity")]
    if valveless:
        tables = joined([f"[cylinders.{name}.valve]" for name in valveless])
        return f"Write {tables} in rig.toml and diagnose again: commands were recorded, and the rig has no valve there."
    if kinds:
        tables = joined([f"[cylinders.{name}.valve]" for name in kinds])
        return f"Put kind in {tables} of rig.toml right and diagnose again: the commands recorded are those of another kind of valve."
    if unread:
        columns, them = ("columns", "them") if len(unread) > 1 else ("column", "it")
        return f"Put {columns} {joined(unread)} right and diagnose again: this was found without {them}."
    if blank:
        return f'Put the unit of "{blank[0].where}" right, or its sensor, and diagnose again: this was found without it.'
    return ""


def _hardly_better(diagnosis: Diagnosis) -> str:
    """Return how far the improved rig still is, run free, as a sentence; "" where it is better."""
    far = still_far({key: fit for key, fit in diagnosis.free_run.items() if key not in diagnosis.by_chance})
    if far is None:
        return ""
    key, fit = far
    unit, size = amounts.shown_in(fit.unit, fit.before)
    before, after, noise = (amounts.digits(value / size, 2) for value in (fit.before, fit.after, fit.noise))
    return f" Run free, improved.toml is still {after} {unit} off at {key} ({before} before, noise {noise}): do not build on it yet."


def _count(number: int) -> str:
    words = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
    return words[number] if number < len(words) else str(number)


def _placed(finding: Finding) -> str:
    name = name_of(finding.name)
    if finding.ambiguous_with:
        name = " or ".join([name, *map(name_of, finding.ambiguous_with)])
    return name if finding.where in ("supply", "exhaust") and finding.where in name else f"{name} at {finding.where}"


def _sensor(finding: Finding) -> str:
    what = {"sensor_bias": "is off by a constant", "sensor_scale": "has a wrong gain", "sensor_delay": "is late"}
    return f"{finding.where} {what.get(finding.name, 'is at fault: ' + name_of(finding.name))}"


def proof(diagnosis: Diagnosis) -> str:
    """Return, in one sentence, what putting it all in is worth on time that took no part."""
    worst = worst_signal(diagnosis)
    if worst is None:
        return ""
    name, fit = worst
    held_out = held_out_time(diagnosis)
    fit = without_rounding(fit)
    unit, size = amounts.shown_in(fit.unit, max(fit.before, fit.after) or fit.largest)
    before, after, noise = (amounts.digits(v / size, 2) for v in (fit.before, fit.after, fit.noise))
    beside = f"(noise {noise} {unit})"
    if name in diagnosis.computed:
        beside = f"(noise none; a sensor shows {noise} {unit})"
    if fit.after >= 0.98 * fit.before:
        return f"On {held_out}, the error of {name} is {before} {unit} {beside}."
    return f"On {held_out}, the error of {name} falls from {before} to {after} {unit} {beside}."


def without_rounding(fit: SignalFit) -> SignalFit:
    """Return errors of a signal, nil where they are so far below the noise that they are rounding of a computer."""
    before, after = (0.0 if error < NIL * fit.noise else error for error in (fit.before, fit.after))
    return replace(fit, before=before, after=after)


def held_out_time(diagnosis: Diagnosis) -> str:
    """Return which time took no part in choosing or fitting, in words."""
    if len(diagnosis.held_out) == 1:
        (spans,) = diagnosis.held_out.values()
        return f"the held-out {amounts.spans(spans)}" if spans else "held-out time"
    return "the held-out time of every recording" if diagnosis.held_out else "held-out time"


def worst_signal(diagnosis: Diagnosis) -> tuple[str, SignalFit] | None:
    """Return the signal that the rig as given misses most, in multiples of its noise."""
    known = [(n, s) for n, s in diagnosis.signals.items() if math.isfinite(s.before) and math.isfinite(s.after)]
    return max(known, key=lambda pair: pair[1].before / max(pair[1].noise, 1e-30), default=None)


def evidence(finding: Finding) -> str:
    """Return probability and held-out gain of a finding as a phrase, empty where there is neither."""
    words = []
    if finding.log10_odds:
        words.append(f"{likelihood(finding.confidence)}{' that it or what looks like it acts' if finding.ambiguous_with else ''}")
    if finding.held_out_error_drop > 0.0:
        put_in = "its curve" if finding.kind == "unknown" else "it"
        words.append(f"held-out error {amounts.share(finding.held_out_error_drop)} lower with {put_in}")
    return "; ".join(words)


def cost(finding: Finding) -> str:
    """Return what leaving a finding out costs the machine's own predictions, as a sentence; "" where that is not known or nothing."""
    if finding.cost < LEAST_COST:
        return ""
    if finding.cost > 1.0:  # a machine that nothing holds runs away: by how much says nothing
        return "Left out, it puts the predictions off by more than these signals vary."
    return f"Left out, it puts the predictions off by {amounts.share(finding.cost)} of how much these signals vary."


def on_the_machine(finding: Finding) -> str:
    """Return the experiment that shows missing physics by itself, as its effect declares it; "" where it has a rival or declares none."""
    effect = declared().get(finding.name)
    return effect.experiment if effect and finding.kind == "missing_physics" and not finding.ambiguous_with else ""


def weighed_against(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """Return (names with places, why not) of what was put aside, names that share a reason together."""
    by_reason: dict[str, dict[str, list[str]]] = {}
    for one in diagnosis.rejected:
        names = by_reason.setdefault(one.why, {}).setdefault(one.where, [])
        if name_of(one.name) not in names:
            names.append(name_of(one.name))
    return [("; ".join(f"{joined(names)} at {where}" for where, names in places.items()), why) for why, places in by_reason.items()]


def likelihood(probability: float) -> str:
    """Return a probability in words, with the number."""
    ways = ((0.93, "almost certain"), (0.8, "very likely"), (0.6, "likely"), (0.4, "as likely as not"), (0.0, "doubtful"))
    words = next(words for least, words in ways if probability >= least)
    return f"{words} (probability {100.0 * probability:.0f} %)"


def settles(ranked: Sequence[tuple[str, float]]) -> list[tuple[str, str]]:
    """Return experiments with how surely each is expected to tell two explanations apart, and with how much of the best one's evidence.

    Args:
        ranked: Experiments with the log10 of the odds that each is expected to give, the best first.
    """
    ways = ((2.0, "surely"), (1.0, "most likely"), (0.5, "perhaps"), (-math.inf, "hardly"))
    found = []
    for place, (do, gain) in enumerate(ranked):
        beside = f", with {amounts.share(gain / ranked[0][1])} of that evidence" if place else ""
        found.append((do, next(words for least, words in ways if gain >= least) + beside))
    return found


def numbers(finding: Finding) -> list[tuple[str, str, str]]:
    """Return (parameter, value, 95 % interval) of a finding, in readable units."""
    return [
        (name_of(name), *amounts.interval(estimate.value, estimate.low, estimate.high, estimate.unit))
        for name, estimate in estimates(finding).items()
    ]


def estimates(finding: Finding) -> dict[str, Estimate]:
    """Return the parameters of a finding that are worth reading: beside the numbers themselves not the mean of their factors."""
    estimates = finding.parameters
    return {name: e for name, e in estimates.items() if name != "factor" or len(estimates) == 1}


def rivals(finding: Finding) -> list[tuple[str, float | None]]:
    """Return the names that explain the recording as well, with probabilities, the likeliest first."""
    if not finding.ambiguous_with:
        return []
    names = [finding.name, *finding.ambiguous_with]
    known = [(name, finding.probabilities.get(name)) for name in names]
    return sorted(known, key=lambda pair: -(pair[1] or 0.0))
