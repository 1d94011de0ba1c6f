"""Counting: marks to figures, each with its 95 % confidence bounds."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from exo_sim.trials.judge import Mark

#: Sizes in limits are gathered in these bins for the detection curve.
EDGES = (0.0, 0.7, 1.4, 2.8, 6.0, 1e9)


def clopper_pearson(hits: int, tries: int, confidence: float = 0.95) -> tuple[float, float]:
    """Return the exact confidence interval of a share (Clopper and Pearson 1934); (0, 1) where nothing was tried."""
    from scipy.stats import beta

    if tries == 0:
        return 0.0, 1.0
    rest = (1 - confidence) / 2
    low = 0.0 if hits == 0 else float(beta.ppf(rest, hits, tries - hits + 1))
    high = 1.0 if hits == tries else float(beta.ppf(1 - rest, hits + 1, tries - hits))
    return low, high


def share(outcomes: Iterable[bool]) -> dict[str, Any]:
    """Return hits, tries, their ratio (None where nothing was tried) and its bounds."""
    values = list(outcomes)
    hits, tries = sum(values), len(values)
    low, high = clopper_pearson(hits, tries)
    return {"hits": hits, "of": tries, "share": hits / tries if tries else None, "low": low, "high": high}


def figures(
    marks: Sequence[Mark], spent: Sequence[dict[str, Any]] = (), over_oracle: Mapping[str, float] | None = None
) -> dict[str, Any]:
    """Return all figures of a trial.

    Args:
        marks: One per case.
        spent: VerdictChain records: `wall_s`, `cpu_s`, `peak_bytes` of each case.
        over_oracle: By case, the held-out error over that of an oracle, the same tool with the truth in its rig.
    """
    clean = [mark for mark in marks if not mark.hidden]
    dirty = [mark for mark in marks if mark.hidden]
    listed = [mark for mark in dirty if "unknown" not in mark.hidden]
    outside = [mark for mark in dirty if "unknown" in mark.hidden]
    tens = [mark for mark in marks if mark.cell == "single" and mark.sizes and mark.sizes[0][0] >= 9.0]
    given = sum(len(mark.named) for mark in marks)
    right = sum(sum(mark.found) for mark in marks)
    wanted = sum(len(mark.hidden) for mark in marks)
    probabilities = [mark.probability for mark in listed if mark.probability is not None]
    result: dict[str, Any] = {
        "cases": len(marks),
        "answered": share(mark.answered for mark in marks),
        "located_right": share(bool(mark.located) for mark in dirty),
        "top_1": share(mark.best in mark.hidden for mark in listed),
        "class_right": share(all(mark.class_found) for mark in listed),
        "exact_set": share(mark.exact for mark in listed),
        "class_exact_set": share(mark.class_exact for mark in listed),
        "exact_set_from_four_limits": share(m.exact for m in listed if min(size for size, _ in m.sizes) >= 3.9),
        "precision": {"hits": right, "of": given, "share": right / given if given else None,
                      **dict(zip(("low", "high"), clopper_pearson(right, given)))},
        "recall": {"hits": right, "of": wanted, "share": right / wanted if wanted else None,
                   **dict(zip(("low", "high"), clopper_pearson(right, wanted)))},
        "single_at_ten_limits": share(mark.exact for mark in tens),
        "mean_probability_on_truth": float(np.mean(probabilities)) if probabilities else None,
        "false_alarms": share(mark.false_alarm for mark in clean),
        "confidently_wrong": share(bool(mark.confidently_wrong) for mark in marks),
        "outside_called_unknown": share(mark.found[0] for mark in outside),
        "outside_confidently_misnamed": share(bool(mark.confidently_wrong) for mark in outside),
        "undetermined_where_likelihood_agrees": sum(mark.undetermined_right for mark in marks),
        "cells": {cell: _cell([m for m in marks if m.cell == cell]) for cell in sorted({m.cell for m in marks})},
        "effects": _effects(marks),
        "detection": _detection([mark for mark in marks if mark.cell == "single" and mark.sizes]),
        "parameters": _parameters(marks),
        "held_out_error_over_noise": _quantiles([ratio for mark in listed for ratio in mark.held_out]),
        "held_out_error_after_over_before": _quantiles([ratio for mark in listed for ratio in mark.drop]),
        "held_out_error_over_oracle": _quantiles(list((over_oracle or {}).values())),
        "held_out_error_near_oracle": share(ratio <= 1.1 for ratio in (over_oracle or {}).values()),
        "wall_s": _quantiles([float(record["wall_s"]) for record in spent]),
        "cpu_s": _quantiles([float(record["cpu_s"]) for record in spent]),
        "peak_bytes": max((int(record["peak_bytes"]) for record in spent), default=None),
        "reliability": _reliability(listed),
        "confusion": _confusion(marks),
    }  # fmt: skip
    return result


def _cell(marks: Sequence[Mark]) -> dict[str, Any]:
    if marks and not any(mark.hidden for mark in marks):
        return {"right": share(not m.named for m in marks), "false_alarms": share(m.false_alarm for m in marks)}
    return {
        "exact_set": share(mark.exact for mark in marks),
        "class_exact_set": share(mark.class_exact for mark in marks),
        "located_right": share(bool(mark.located) for mark in marks),
        "confidently_wrong": share(bool(mark.confidently_wrong) for mark in marks),
    }


def _effects(marks: Sequence[Mark]) -> dict[str, Any]:
    names = sorted({name for mark in marks for name in mark.hidden})
    return {
        name: share(found for mark in marks for hidden, found in zip(mark.hidden, mark.found) if hidden == name)
        for name in names
    }


def _detection(singles: Sequence[Mark]) -> dict[str, Any]:
    """Return the detection curve of singles and the size, in limits, from which nine of ten are named."""
    curve = []
    for low, high in pairwise(EDGES):
        inside = [mark for mark in singles if low <= mark.sizes[0][0] < high]
        if inside:
            sizes = [mark.sizes[0][0] for mark in inside]
            curve.append({"size_in_limits": float(np.exp(np.mean(np.log(sizes)))), **share(m.found[0] for m in inside)})
    return {"curve": curve, "size_named_in_nine_of_ten": nine_of_ten(singles)}


def nine_of_ten(singles: Sequence[Mark]) -> float | None:
    """Return the size in limits at which a logistic curve through the singles passes 0.9.

    None where nine of ten is never reached, or there are too few cases or sizes to say.
    """
    from scipy.optimize import minimize

    x = np.log([max(mark.sizes[0][0], 1e-6) for mark in singles])
    y = np.array([mark.found[0] for mark in singles], float)
    if len(x) < 8 or np.ptp(x) < 0.1 or y.mean() < 0.05:
        return None

    def loss(p: np.ndarray) -> float:
        # ceiling below 1: some effects are never named, whatever their size
        top = 1 / (1 + math.exp(-p[2]))
        q = np.clip(top / (1 + np.exp(-np.exp(p[1]) * (x - p[0]))), 1e-9, 1 - 1e-9)
        return float(-(y * np.log(q) + (1 - y) * np.log(1 - q)).sum() + 0.05 * (p[1] ** 2 + 0.1 * (p[2] - 3) ** 2))

    best = min((minimize(loss, [start, 0.5, 3.0], method="Nelder-Mead") for start in (0.0, 1.5)), key=lambda r: r.fun)
    top = 1 / (1 + math.exp(-best.x[2]))
    if top <= 0.9:
        return None
    place = float(best.x[0] - math.log(top / 0.9 - 1) / math.exp(best.x[1]))
    return math.exp(place) if place <= x.max() else None


def _parameters(marks: Sequence[Mark]) -> dict[str, Any]:
    # a coverage is only as good as the effect is right, so parameters of found effects count
    results = [entry for mark in marks for entry in mark.parameters]
    return {
        "relative_error": _quantiles([error for error, _, _ in results]),
        "coverage": share(within for _, within, _ in results),
        "of": {
            name: {
                "median_error": float(np.median([e for e, _, n in results if n == name])),
                "coverage": share(w for _, w, n in results if n == name),
            }
            for name in sorted({name for _, _, name in results})
        },
    }


def _quantiles(values: Sequence[float]) -> dict[str, float] | None:
    if not values:
        return None
    low, middle, high = np.quantile(values, [0.1, 0.5, 0.9])
    return {"p10": float(low), "median": float(middle), "p90": float(high), "n": len(values)}


def _reliability(marks: Sequence[Mark]) -> list[dict[str, Any]]:
    """Return, for bins of the probability claimed for a class, how often the truth was the name given first."""
    bins: list[dict[str, Any]] = []
    pairs = [
        (mark.probability, all(mark.found)) for mark in marks if mark.probability is not None and any(mark.class_found)
    ]
    for low, high in ((0.0, 0.35), (0.35, 0.55), (0.55, 0.8), (0.8, 0.95), (0.95, 1.01)):
        inside = [(p, right) for p, right in pairs if low <= p < high]
        if inside:
            bins.append({"claimed": float(np.mean([p for p, _ in inside])), **share(right for _, right in inside)})
    return bins


def _confusion(marks: Sequence[Mark]) -> dict[str, dict[str, int]]:
    """Return hidden name to (name given first: how often), for cases that hide one thing or nothing."""
    table: dict[str, Counter[str]] = {}
    for mark in marks:
        if len(mark.hidden) <= 1:
            truth = mark.hidden[0] if mark.hidden else "nothing"
            table.setdefault(truth, Counter())[mark.best or "nothing"] += 1
    return {truth: dict(sorted(row.items())) for truth, row in sorted(table.items())}
