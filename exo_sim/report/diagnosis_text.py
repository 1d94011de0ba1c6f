"""A diagnosis in the terminal: at most forty lines of plain text."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.report import amounts, diagnosis_words

WIDTH = 110
MOST_LINES = 40


def text(diagnosis: Diagnosis, written: Sequence[str] = ()) -> str:
    """Return the summary.

    Args:
        diagnosis: What was found.
        written: Lines about the files that hold the rest; they always show.
    """
    head = _wrapped(f"{diagnosis.verdict.upper()}  {diagnosis_words.verdict(diagnosis)}", "")
    if proof := diagnosis_words.proof(diagnosis):
        head += _wrapped(proof, "")
    if first := diagnosis_words.first_step(diagnosis):
        head += _wrapped(f"First: {first}", "")
    sections = [s for s in (_findings(diagnosis), _fit(diagnosis), _located(diagnosis), _rest(diagnosis)) if s]
    tail = ["", *written] if written else []
    return "\n".join([*_fitting(head, sections, MOST_LINES - len(tail)), *tail])


def _fitting(head: list[str], sections: list[list[str]], room: int) -> list[str]:
    """Cut the longest sections until everything fits; a cut one says how much of it is gone, and where that stands."""
    sections, gone = [list(section) for section in sections], [0] * len(sections)

    def total() -> int:
        return len(head) + sum(len(section) + 1 for section in sections)

    while total() > room and max(map(len, sections)) > 4:
        k = max(range(len(sections)), key=lambda i: len(sections[i]))
        del sections[k][-2 if gone[k] else -1]
        gone[k] += 1 if gone[k] else 2
        sections[k][-1] = f"  ({gone[k]} lines more in the report)"
    lines = list(head)
    for section in sections:
        lines += ["", *section]
    return lines[:room]


def _findings(diagnosis: Diagnosis) -> list[str]:
    if not diagnosis.effects:
        return []
    lines = ["Found"]
    for finding in diagnosis.effects:
        title = f"{diagnosis_words.name_of(finding.name)} at {finding.where} ({diagnosis_words.KINDS[finding.kind]})"
        lines += _wrapped(f"{title}: {finding.says}", "  ")
        lines += [f"    {name} = {value}  (95 %: {span})" for name, value, span in diagnosis_words.numbers(finding)]
        if proof := diagnosis_words.evidence(finding):
            lines += _wrapped(proof, "    ")
        if cost := diagnosis_words.cost(finding):
            lines += _wrapped(cost[0].lower() + cost[1:].rstrip("."), "    ")
        if rivals := diagnosis_words.rivals(finding):
            listed = [f"{diagnosis_words.name_of(name)}{'' if p is None else f' {amounts.share(p)}'}" for name, p in rivals]
            lines += _wrapped(f"cannot be distinguished: {', '.join(listed)}", "    ")
    return lines


def _fit(diagnosis: Diagnosis) -> list[str]:
    if not diagnosis.signals:
        return []
    width = max(map(len, [*diagnosis.signals, *diagnosis.free_run]))
    lines = [f"Error on held-out time ({diagnosis.measure})"]
    lines += [_row(name, width, fit) for name, fit in diagnosis.signals.items()]
    if diagnosis.free_run:
        lines.append("... and of improved.toml in one free run from the first measured state, which nothing corrects")
        lines += [_row(name, width, run) for name, run in diagnosis.free_run.items()]
    return lines


def _row(name: str, width: int, fit: SignalFit) -> str:
    fit = diagnosis_words.without_rounding(fit)
    unit, size = amounts.shown_in(fit.unit, fit.largest)
    before, after, noise = (amounts.digits(v / size) for v in (fit.before, fit.after, fit.noise))
    return f"  {name:{width}}  before {before:>8}  after {after:>8}  noise {noise:>8}  {unit}"


def _located(diagnosis: Diagnosis) -> list[str]:
    if not diagnosis.located:
        return []
    lines = ["Where the error sits"]
    for place in diagnosis.located:
        words = f"{place.where}, {place.equation}: {amounts.share(place.share)} of it; {place.regime}"
        lines += _wrapped(words + (f"; {amounts.spans(place.when, 3)}" if place.when else ""), "  ")
    return lines


def _rest(diagnosis: Diagnosis) -> list[str]:
    lines = []
    for left in diagnosis.unexplained:
        lines += _wrapped(f"Explained by no name: {diagnosis_words.unexplained(left)}", "")
    for small in diagnosis.small:
        sizes = ", ".join(f"{name} {value}" for name, value, _ in diagnosis_words.numbers(small))
        lines += _wrapped(f"Small: {diagnosis_words.small(small)} ({sizes})", "")
    for question in diagnosis.open_questions:
        lines += _wrapped(f"Open: {question.question.rstrip('.?')} ({question.why})", "")
    for remark in diagnosis.sensor_remarks:
        lines += _wrapped(f"Note: {remark}", "")
    if diagnosis.next_experiment is not None:
        lines += _wrapped(f"Next: {diagnosis.next_experiment.do} ({diagnosis.next_experiment.why})", "")
    return lines


def _wrapped(words: str, indent: str) -> list[str]:
    return textwrap.wrap(words, WIDTH, initial_indent=indent, subsequent_indent=indent + "  ", break_long_words=False)
