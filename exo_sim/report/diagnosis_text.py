"""A diagnosis in the terminal: at most forty lines of plain text, more only where findings are that many."""

from __future__ import annotations

from collections.abc import Sequence

from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.report import amounts, diagnosis_words, finding_lines
from exo_sim.report.finding_lines import wrapped

MOST_LINES = 40
#: Every other section keeps so many lines, the one that says how many are gone among them.
FEWEST_LINES = 4


def text(diagnosis: Diagnosis, written: Sequence[str] = ()) -> str:
    """Return the summary.

    Args:
        diagnosis: What was found.
        written: Lines about the files that hold the rest; they always show.
    """
    head = wrapped(f"{diagnosis.verdict.upper()}  {diagnosis_words.verdict(diagnosis)}", "")
    if proof := diagnosis_words.proof(diagnosis):
        head += wrapped(proof, "")
    if first := diagnosis_words.first_step(diagnosis):
        head += wrapped(f"First: {first}", "")
    others = [s for s in (_fit(diagnosis), _located(diagnosis), _rest(diagnosis)) if s]
    tail = ["", *written] if written else []
    room = MOST_LINES - len(head) - len(tail)
    found = _findings(diagnosis, room - sum(min(len(section), FEWEST_LINES) + 1 for section in others))
    sections = [found] if found else []
    sections += _cut(others, room - sum(len(section) + 1 for section in sections))
    return "\n".join([*head, *(line for section in sections for line in ("", *section)), *tail])


def _findings(diagnosis: Diagnosis, room: int) -> list[str]:
    """Return every finding; the last ones each in a line of name, place and numbers where not all that is said of all has room."""
    if not diagnosis.effects:
        return []
    said = [finding_lines.full(finding) for finding in diagnosis.effects]
    for place in range(len(said) - 1, -1, -1):
        if sum(map(len, said)) + 2 <= room:
            break
        said[place] = finding_lines.brief(diagnosis.effects[place])
    return ["Found", *(line for lines in said for line in lines)]


def _cut(sections: Sequence[list[str]], room: int) -> list[list[str]]:
    """Cut the longest sections until everything fits; a cut one says how much of it is gone, and where that stands."""
    sections, gone = [list(section) for section in sections], [0] * len(sections)
    while sections and sum(len(section) + 1 for section in sections) > room and max(map(len, sections)) > FEWEST_LINES:
        k = max(range(len(sections)), key=lambda i: len(sections[i]))
        del sections[k][-2 if gone[k] else -1]
        gone[k] += 1 if gone[k] else 2
        sections[k][-1] = f"  ({gone[k]} lines more in the report)"
    return sections


def _fit(diagnosis: Diagnosis) -> list[str]:
    """Return the errors, those run free beside those over windows: cut, neither is without the other."""
    if not diagnosis.signals:
        return []
    names = dict.fromkeys([*diagnosis.signals, *diagnosis.free_run])
    width = max(map(len, names))
    lines = [f"Error on held-out time ({diagnosis.measure})"]
    if diagnosis.free_run:
        lines.append("  run free: of improved.toml in one run from the first measured state, which nothing corrects")
    return lines + [_row(name, width, diagnosis.signals.get(name), diagnosis.free_run.get(name)) for name in names]


def _row(name: str, width: int, fit: SignalFit | None, run: SignalFit | None) -> str:
    """Return the errors of one column before and after, over windows and run free, in one unit."""
    either = [diagnosis_words.without_rounding(one) for one in (fit, run) if one is not None]
    unit, size = amounts.shown_in(either[0].unit, max(one.largest for one in either))

    def shown(value: float) -> str:
        return f"{amounts.digits(value / size):>8}"

    parts = [f"  {name:{width}}", " " * 31 if fit is None else f"before {shown(either[0].before)}  after {shown(either[0].after)}"]
    if run is not None:
        parts.append(f"run free {shown(either[-1].before)} {shown(either[-1].after)}")
    return "  ".join([*parts, f"noise {shown(either[0].noise)}  {unit}"])


def _located(diagnosis: Diagnosis) -> list[str]:
    if not diagnosis.located:
        return []
    lines = ["Where the error sits"]
    for place in diagnosis.located:
        words = f"{place.where}, {place.equation}: {amounts.share(place.share)} of it; {place.regime}"
        lines += wrapped(words + (f"; {amounts.spans(place.when, 3)}" if place.when else ""), "  ")
    return lines


def _rest(diagnosis: Diagnosis) -> list[str]:
    lines = []
    for left in diagnosis.unexplained:
        lines += wrapped(f"Explained by no name: {diagnosis_words.unexplained(left)}", "")
    for small in diagnosis.small:
        sizes = ", ".join(f"{name} {value}" for name, value, _ in diagnosis_words.numbers(small))
        lines += wrapped(f"Small: {diagnosis_words.small(small)} ({sizes})", "")
    for question in diagnosis.open_questions:
        lines += wrapped(f"Open: {question.question.rstrip('.?')} ({question.why})", "")
    for remark in diagnosis.sensor_remarks:
        lines += wrapped(f"Note: {remark}", "")
    if diagnosis.next_experiment is not None:
        lines += wrapped(f"Next: {diagnosis.next_experiment.do} ({diagnosis.next_experiment.why})", "")
    return lines
