"""The score as one self-contained page with pictures."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from exo_sim.trials import score_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Proving ground</title>
<style>
body{font:15px/1.45 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1a1a}
table{border-collapse:collapse;margin:1rem 0}td,th{padding:.2rem .7rem;border-bottom:1px solid #ddd;text-align:left}
td.n{text-align:right;font-variant-numeric:tabular-nums}h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2rem}
svg{max-width:100%;height:auto}figure{margin:1rem 0}figcaption{color:#555}code{font-size:.85em;overflow-wrap:anywhere}
@media print{figure,table{break-inside:avoid}}
</style></head><body>
<h1>What the tool found in {{ f.cases }} sealed cases</h1>
<p>Tool: <code>{{ tool }}</code><br>Last verdict: <code>{{ head }}</code></p>
<table><tr><th>figure</th><th>share</th><th>95 % bounds</th><th>cases</th></tr>
{% for words, s in shares %}<tr><td>{{ words }}</td><td class="n">{{ percent(s.share) }}</td>
<td class="n">{{ percent(s.low) }} to {{ percent(s.high) }}</td><td class="n">{{ s.hits }} of {{ s.of }}</td></tr>
{% endfor %}</table>
<table><tr><th>figure</th><th>value</th></tr>
{% for words, value in numbers %}<tr><td>{{ words }}</td><td class="n">{{ value }}</td></tr>
{% endfor %}</table>
<h2>By cell</h2>
<table><tr><th>cell</th><th>what</th><th>share</th><th>95 % bounds</th><th>cases</th></tr>
{% for cell, entry in f.cells.items() %}{% for what, s in entry.items() %}
<tr><td>{{ cell if loop.first else "" }}</td><td>{{ words[what] }}</td>
<td class="n">{{ percent(s.share) }}</td>
<td class="n">{{ percent(s.low) }} to {{ percent(s.high) }}</td>
<td class="n">{{ s.hits }} of {{ s.of }}</td></tr>
{% endfor %}{% endfor %}</table>
{% for heading, picture, caption in pictures %}<h2>{{ heading }}</h2>
<figure>{{ picture|safe }}<figcaption>{{ caption }}</figcaption></figure>
{% endfor %}
<h2>Confident mistakes and misses above the limit</h2>
<table><tr><th>case</th><th>cell</th><th>hidden (size in limits)</th><th>named</th></tr>
{% for m in wrong %}<tr><td>{{ m.case }}</td><td>{{ m.cell }}</td>
<td>{% for name in m.hidden %}{{ name }} ({{ "%.1f"|format(m.sizes[loop.index0][0]) }})
{{ ", " if not loop.last }}{% endfor %}</td>
<td>{{ m.named|join(", ") or "nothing" }}</td></tr>
{% endfor %}</table>
</body></html>
"""

#: Estimates of a parameter below which its coverage is not drawn: the bounds of so few span nearly everything.
_FEWEST = 5


def named_from(figures: Mapping[str, Any]) -> str:
    """Return the size from which nine of ten are named, as people read it."""
    detection = figures["detection"]
    if len(detection["curve"]) < 2:
        return "one size only" if detection["curve"] else "-"
    nine = detection["size_named_in_nine_of_ten"]
    return "not reached" if nine is None else f"{nine:.2g}"


def percent(value: float | None) -> str:
    """Return a share as text."""
    return "-" if value is None else f"{100 * value:.1f} %"


def page(score: Mapping[str, Any]) -> str:
    """Return the HTML of a score."""
    import jinja2

    f = score["figures"]
    environment = jinja2.Environment(autoescape=True)
    return environment.from_string(_PAGE).render(
        f=f,
        tool=score["tool"],
        head=score["head"],
        percent=percent,
        shares=list(score_words.shares(f)),
        words=score_words.OF_CELL,
        numbers=_numbers(f),
        pictures=_pictures(f),
        wrong=[
            mark
            for mark in score["marks"]
            if mark["confidently_wrong"]
            or mark["false_alarm"]
            or any(not found and size[0] > 2 for found, size in zip(mark["class_found"], mark["sizes"]))
        ],
    )


def _numbers(f: Mapping[str, Any]) -> list[tuple[str, str]]:
    def of(entry: Mapping[str, float] | None, scale: float = 1.0, unit: str = "") -> str:
        if entry is None:
            return "-"
        return f"{entry['median'] * scale:.3g}{unit} ({entry['p10'] * scale:.3g} to {entry['p90'] * scale:.3g})"

    probability = f["mean_probability_on_truth"]
    peak = f["peak_bytes"]
    return [
        ("smallest size named in nine of ten, in limits", named_from(f)),
        ("mean probability on the truth", "-" if probability is None else f"{probability:.2f}"),
        ("parameter error, median (10 to 90 %)", of(f["parameters"]["relative_error"], 100, " %")),
        ("held-out error over noise", of(f["held_out_error_over_noise"])),
        ("held-out error after over before", of(f["held_out_error_after_over_before"])),
        ("held-out error over that of an oracle, the same tool with the truth in its rig", of(f["held_out_error_over_oracle"])),
        ("seconds a case", of(f["wall_s"])),
        ("peak memory", "-" if peak is None else f"{peak / 1e9:.2f} GB"),
    ]


def _pictures(f: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    pictures = []
    if f["detection"]["curve"]:
        pictures.append(
            (
                "Detection",
                _svg(lambda axes: _detection(axes, f["detection"]["curve"]), 6, 3.4),
                "Singles named right against size, in units of the limit of a likelihood-ratio test.",
            )
        )
    if f["confusion"]:
        rows, columns = map(len, _places(f["confusion"]))
        pictures.append(
            (
                "Confusion",
                _svg(lambda axes: _confusion(axes, f["confusion"]), 2.5 + 0.24 * columns, 2 + 0.22 * rows),
                "Cases that hide one thing or nothing: what was hidden (rows) and what was named first (columns, in the same order: right "
                "answers are on the diagonal).",
            )
        )
    if f["reliability"]:
        pictures.append(
            (
                "Reliability",
                _svg(lambda axes: _reliability(axes, f["reliability"]), 4, 3.4),
                "Probability claimed for a name, and how often it was right.",
            )
        )
    often = {name: entry for name, entry in f["parameters"]["of"].items() if entry["coverage"]["of"] >= _FEWEST}
    if often:
        pictures.append(
            (
                "Coverage",
                _svg(lambda axes: _coverage(axes, often), 6, 1 + 0.24 * len(often)),
                f"How often the 95 % interval of a parameter held the truth, with 95 % bounds; parameters of {_FEWEST} cases or more.",
            )
        )
    return pictures


def _svg(draw: Callable[[Axes], None], width: float, height: float) -> str:
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    # fixed salt and no date: the same score gives the same bytes
    with mpl.rc_context({"svg.hashsalt": "score", "font.size": 8, "svg.fonttype": "none"}):
        figure = Figure((width, height), layout="constrained")
        FigureCanvasSVG(figure)
        draw(figure.subplots())
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()[text.getvalue().index("<svg") :]


def _bars(axes: Axes, x: list[float], entries: list[Mapping[str, Any]]) -> None:
    shares = [100 * entry["share"] for entry in entries]
    low = [100 * (entry["share"] - entry["low"]) for entry in entries]
    high = [100 * (entry["high"] - entry["share"]) for entry in entries]
    axes.errorbar(x, shares, [low, high], fmt="o-", capsize=3, color="#1f5a8a")
    axes.set_ylim(-3, 103)


def _detection(axes: Axes, curve: list[Mapping[str, Any]]) -> None:
    _bars(axes, [entry["size_in_limits"] for entry in curve], curve)
    axes.set_xscale("log")
    if len(curve) == 1:
        axes.set_xlim(0.5, 2.0 * curve[0]["size_in_limits"])
    axes.axvline(1.0, color="#999", linestyle=":")
    axes.axhline(90, color="#999", linestyle=":")
    axes.set_xlabel("size [limits]")
    axes.set_ylabel("named right [%]")


def _reliability(axes: Axes, bins: list[Mapping[str, Any]]) -> None:
    axes.plot([0, 1], [0, 100], color="#999", linestyle=":")
    _bars(axes, [entry["claimed"] for entry in bins], bins)
    axes.set_xlabel("probability claimed")
    axes.set_ylabel("right [%]")


def _places(table: Mapping[str, Mapping[str, int]]) -> tuple[list[str], list[str]]:
    """Return rows and columns of a confusion matrix: the same names in the same order, then those that were named and never hidden."""
    rows = list(table)
    return rows, rows + sorted({name for row in table.values() for name in row} - set(rows))


def _confusion(axes: Axes, table: Mapping[str, Mapping[str, int]]) -> None:
    import numpy as np

    rows, columns = _places(table)
    counts = np.array([[table[row].get(name, 0) for name in columns] for row in rows], float)
    axes.imshow(counts / np.maximum(counts.sum(1, keepdims=True), 1), cmap="Blues", vmin=0, vmax=1, aspect="auto")
    axes.set_yticks(range(len(rows)), rows)
    axes.set_xticks(range(len(columns)), columns, rotation=90)
    axes.set_xlabel("named first")
    axes.set_ylabel("hidden")
    axes.plot([-0.5, len(rows) - 0.5], [-0.5, len(rows) - 0.5], color="#999", linestyle=":", linewidth=0.8)
    for i, j in np.argwhere(counts > 0):
        axes.text(j, i, f"{counts[i, j]:.0f}", ha="center", va="center", fontsize=6,
                  color="white" if counts[i, j] > 0.5 * counts[i].sum() else "black")


def _coverage(axes: Axes, entries: Mapping[str, Mapping[str, Any]]) -> None:
    for row, entry in enumerate(entries.values()):
        bounds = entry["coverage"]
        axes.plot([100 * bounds["low"], 100 * bounds["high"]], [row, row], color="#9bbcd6")
        axes.plot([100 * bounds["share"]], [row], "o", color="#1f5a8a")
    axes.axvline(95, color="#999", linestyle=":")
    axes.set_yticks(range(len(entries)), [f"{name} (n = {entry['coverage']['of']})" for name, entry in entries.items()])
    axes.set_xlim(-2, 102)
    axes.set_xlabel("intervals that cover [%]")
