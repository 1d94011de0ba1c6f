"""Marks to tables: a line for each cell, for each make in it, and for the cell without that make.

Makes for learning and makes that are only reported on stand in tables of their own: no figure is drawn from both.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from exo_sim.trials.score_statistics import clopper_pearson
from exo_sim.trials.whole_machines.judge import Mark

LEARNT, REPORTED = "makes for learning", "makes that are only reported on"
#: Heading and key of `figures` of each column: names, then rigs.
NAMES = (
    ("cases", "cases"), ("recall", "recall"), ("precision", "precision"), ("name or class", "class_found"), ("exact", "exact"),
    ("exact or class", "class_exact"), ("95 % intervals", "covered"), ("false sensor", "false_sensor"), ("unknown", "unknown"),
    ("confidently wrong", "confidently_wrong"),
)  # fmt: skip
RIGS = (
    ("cases", "cases"), ("improved/handed in, windows", "windowed_rms_after_over_before"),
    ("run free", "free_run_rms_after_over_before"), ("improved/true names, windows", "windowed_rms_after_over_nearest"),
    ("run free", "free_run_rms_after_over_nearest"), ("worse than handed in", "worse"), ("cpu s", "cpu_s"),
)  # fmt: skip
#: A rig that is this much worse than the one handed in is worse.
_WORSE = 1.02


def groups(marks: Sequence[Mark]) -> dict[str, list[Mark]]:
    """Return the marks of makes for learning and of makes that are only reported on, those that there are."""
    both = {LEARNT: [mark for mark in marks if not mark.reported], REPORTED: [mark for mark in marks if mark.reported]}
    return {name: those for name, those in both.items() if those}


def lines(marks: Sequence[Mark]) -> Iterator[tuple[str, list[Mark]]]:
    """Yield name and marks of each line of a group: a cell, each make in it, and of three makes or more the cell without it."""
    for cell in sorted({mark.cell for mark in marks}):
        there = [mark for mark in marks if mark.cell == cell]
        yield cell, there
        makes = sorted({mark.make for mark in there})
        if len(makes) > 1:
            for make in makes:
                yield f"{cell}, make {make}", [mark for mark in there if mark.make == make]
                if len(makes) > 2:
                    yield f"{cell} without {make}", [mark for mark in there if mark.make != make]


def figures(marks: Sequence[Mark]) -> dict[str, Any]:
    """Return what is counted: shares as {hits, of, low, high} with 95 % Clopper-Pearson bounds, errors and times as {median, most}.

    Args:
        marks: At least one. Shares of nothing and medians of nothing are None, and so is a median or maximum that is infinite.
    """
    found = [hit for mark in marks for hit in mark.found]
    classes = [hit for mark in marks for hit in mark.class_found]
    right, wrong = sum(len(mark.right) for mark in marks), sum(len(mark.wrong) for mark in marks)
    covered = [hit for mark in marks for _, _, hit in mark.parameters]
    ratios = [key for _, key in RIGS if "_over_" in key]
    rigs = [mark for mark in marks if any(mark.errors.get(key) is not None for key in ratios)]
    return {
        "cases": len(marks),
        "recall": _share(sum(found), len(found)),
        "precision": _share(right, right + wrong),
        "class_found": _share(sum(classes), len(classes)),
        "exact": _share(sum(mark.exact for mark in marks), len(marks)),
        "class_exact": _share(sum(mark.class_exact for mark in marks), len(marks)),
        "covered": _share(sum(covered), len(covered)),
        "false_sensor": _share(sum(bool(mark.false_sensors) for mark in marks), len(marks)),
        "unknown": _share(sum(bool(mark.unknown) for mark in marks), len(marks)),
        "confidently_wrong": _share(sum(bool(mark.confidently_wrong) for mark in marks), len(marks)),
        **{key: _middle(marks, lambda mark, key=key: mark.errors.get(key)) for key in ratios},  # type: ignore[misc]
        "worse": _share(sum(_worse(mark) for mark in rigs), len(rigs)),
        "cpu_s": _middle(marks, lambda mark: mark.time_s),
    }


def rows(marks: Sequence[Mark], columns: Sequence[tuple[str, str]]) -> list[list[str]]:
    """Return the lines of one group as text, its name first; columns are `NAMES` or `RIGS`."""
    found = [(name, figures(those)) for name, those in lines(marks)]
    return [[name, *(_text(entry[key]) for _, key in columns)] for name, entry in found]


def tables(marks: Sequence[Mark]) -> str:
    """Return the tables of both groups as Markdown."""
    parts = []
    for group, those in groups(marks).items():
        for columns in (NAMES, RIGS):
            parts.append(markdown(rows(those, columns), (group, *(heading for heading, _ in columns))))
        parts.append(markdown(names(those), (f"name ({group})", "found where expected", "given wrongly")))
        claimed = calibration(those)
        if claimed:
            parts.append(markdown(claimed, (f"probability claimed ({group})", "so")))
    return "\n\n".join(parts)


def plain(marks: Sequence[Mark]) -> dict[str, Any]:
    """Return the figures of every line of both groups as plain numbers and text."""
    return {
        group: {
            "lines": {name: figures(inside) for name, inside in lines(those)},
            "names": {name: {"found": found, "given_wrongly": int(wrong)} for name, found, wrong in names(those)},
        }
        for group, those in groups(marks).items()
    }


def names(marks: Sequence[Mark]) -> list[list[str]]:
    """Return for each name how often it was expected and found, and how often it was given wrongly."""
    expected, found, wrong = Counter[str](), Counter[str](), Counter[str]()
    for mark in marks:
        for name, hit in zip(mark.expected, mark.found):
            expected[name] += 1
            found[name] += hit
        wrong.update((*mark.wrong, *mark.false_sensors))
    return [[name, _text(_share(found[name], expected[name])), str(wrong[name])] for name in sorted(expected | wrong)]


def calibration(marks: Sequence[Mark]) -> list[list[str]]:
    """Return for bins of the probability claimed of a name how often it was so."""
    pairs = [pair for mark in marks for pair in mark.probabilities]
    found = []
    for low, high in ((0.0, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 0.99), (0.99, 1.01)):
        inside = [(claimed, so) for claimed, so in pairs if low <= claimed < high]
        if inside:
            share = _share(sum(so for _, so in inside), len(inside))
            found.append([f"{np.mean([claimed for claimed, _ in inside]):.3f}", _text(share)])
    return found


def _worse(mark: Mark) -> bool:
    ratios = [mark.errors.get(f"{measure}_after_over_before") for measure in ("windowed_rms", "free_run_rms")]
    return any(ratio is not None and ratio > _WORSE for ratio in ratios)


def _share(hits: int, of: int) -> dict[str, float] | None:
    if of == 0:
        return None
    low, high = clopper_pearson(hits, of)
    return {"share": hits / of, "low": low, "high": high, "hits": hits, "of": of}


def _middle(marks: Sequence[Mark], of: Callable[[Mark], float | None]) -> dict[str, float | None] | None:
    values = sorted(value for mark in marks if (value := of(mark)) is not None)
    return {"median": _finite(values[(len(values) - 1) // 2], values[len(values) // 2]), "most": _finite(values[-1])} if values else None


def _finite(*values: float) -> float | None:
    """Return the mean, None where a rig left all bounds: JSON has no word for infinity."""
    return sum(values) / len(values) if all(map(math.isfinite, values)) else None


def _text(figure: Any) -> str:
    if figure is None:
        return "-"
    if isinstance(figure, int):
        return str(figure)
    if "share" in figure:
        return f"{100 * figure['share']:.0f} % ({100 * figure['low']:.0f}-{100 * figure['high']:.0f}) of {figure['of']}"
    median, most = ("inf" if figure[key] is None else f"{figure[key]:.3g}" for key in ("median", "most"))
    return f"{median} (most {most})"


def markdown(rows: Sequence[Sequence[str]], columns: Sequence[str]) -> str:
    """Return rows as a Markdown table."""
    lines = ["| " + " | ".join(columns) + " |", "| --- " * len(columns) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(line) + " |" for line in rows)])
