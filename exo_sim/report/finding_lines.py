"""One finding in the terminal: all that is said of it, or its name, place and numbers in a line."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

from exo_sim.diagnosis.findings import Estimate, Finding
from exo_sim.report import amounts, diagnosis_words

WIDTH = 110
#: So many numbers of a finding stand in its line, those that are furthest from none of it; of the others it is said how many they are.
MOST_NUMBERS = 3


def full(finding: Finding) -> list[str]:
    """Return all that is said of a finding."""
    title = f"{diagnosis_words.name_of(finding.name)} at {finding.where} ({diagnosis_words.KINDS[finding.kind]})"
    lines = wrapped(f"{title}: {finding.says}", "  ")
    lines += [f"    {name} = {value}  (95 %: {span})" for name, value, span in diagnosis_words.numbers(finding)]
    if proof := diagnosis_words.evidence(finding):
        lines += wrapped(proof, "    ")
    if cost := diagnosis_words.cost(finding):
        lines += wrapped(cost[0].lower() + cost[1:].rstrip("."), "    ")
    if rivals := diagnosis_words.rivals(finding):
        listed = [f"{diagnosis_words.name_of(name)}{'' if p is None else f' {amounts.share(p)}'}" for name, p in rivals]
        lines += wrapped(f"cannot be distinguished: {', '.join(listed)}", "    ")
    return lines


def brief(finding: Finding) -> list[str]:
    """Return name, place, numbers with their 95 % intervals and probability; without a number, what is said of it."""
    numbers, estimates = diagnosis_words.numbers(finding), diagnosis_words.estimates(finding).values()
    off = [finding.kind == "calibration" and estimate.unit in ("", "1") for estimate in estimates]
    shown = [f"{name} {'× ' if by else ''}{value} (95 %: {span})" for (name, value, span), by in zip(numbers, off, strict=True)]
    told = [shown[i] for i in _furthest(list(estimates), [float(by) for by in off])] or [finding.says.rstrip(".")]
    left = len(numbers) - MOST_NUMBERS
    more = [f"{left} number{'s' if left > 1 else ''} more in the report"] if left > 0 else []
    sure = [f"probability {100.0 * finding.confidence:.0f} %"] if finding.log10_odds else []
    name = " or ".join(map(diagnosis_words.name_of, (finding.name, *finding.ambiguous_with)))
    return wrapped(f"{name} at {finding.where}: {'; '.join([*told, *more, *sure])}", "  ")


def _furthest(estimates: Sequence[Estimate], none: Sequence[float]) -> list[int]:
    """Return which numbers of a finding stand in its line, in their order: those that are the most half intervals from none of it.

    Args:
        estimates: The numbers.
        none: What each is where the finding is absent: 0, and 1 of a factor.
    """

    def apart(i: int) -> float:
        half = 0.5 * (estimates[i].high - estimates[i].low)
        return abs(estimates[i].value - none[i]) / half if half > 0.0 else math.inf

    return sorted(sorted(range(len(estimates)), key=apart, reverse=True)[:MOST_NUMBERS])


def wrapped(words: str, indent: str) -> list[str]:
    """Return words as lines of the terminal, all but the first set in by two more."""
    return textwrap.wrap(words, WIDTH, initial_indent=indent, subsequent_indent=indent + "  ", break_long_words=False)
