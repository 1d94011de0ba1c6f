"""The picture of a diagnosis: each signal before and after beside its noise, over the whole time and from near."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.findings import Finding, Located, Series
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.report import amounts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

#: Distinguished by colour-blind readers, and in print by their darkness (Okabe and Ito 2008).
RECORDED, BEFORE, AFTER, NOISE, LOCATED, HELD_OUT = "#1a1a1a", "#d55e00", "#009e73", "#6c757d", "#f4b6a6", "#dfe7f3"
#: Stretches of time over which an error is averaged along a recording.
STRETCHES = 90
#: An error that is less than this share of the noise is drawn there: what lies below says nothing of a machine.
LEAST_SHOWN = 0.1
#: Length of what is shown from near [s], and the most points of a line.
NEAR, MOST_POINTS = 1.5, 450
#: Recordings that are drawn; the rest is in comparison.rrd.
MOST_RECORDINGS, MOST_SIGNALS = 2, 6
_STYLE: dict[Any, Any] = {
    "svg.hashsalt": "exo-sim",
    "svg.fonttype": "path",
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "path.simplify": True,
    "path.simplify_threshold": 0.4,
}


def drawn(diagnosis: Diagnosis) -> list[tuple[str, list[Series]]]:
    """Return the recordings that are worth a picture with their signals: first where the mismatch was located."""
    by_recording: dict[str, list[Series]] = {}
    for series in diagnosis.series:
        if np.isfinite(series.recorded).any() and np.isfinite(series.before).any():
            by_recording.setdefault(series.recording, []).append(series)
    located = [place.recording for place in diagnosis.located]

    def rank(item: tuple[str, list[Series]]) -> tuple[bool, float]:
        worst = max(_rms(s.before - s.recorded) / max(s.noise, 1e-30) for s in item[1])
        return item[0] not in located, -worst

    chosen = sorted(by_recording.items(), key=rank)[:MOST_RECORDINGS]
    return [(name, signals[:MOST_SIGNALS]) for name, signals in chosen]


def overview(diagnosis: Diagnosis, recording: str, signals: Sequence[Series]) -> str:
    """Return an SVG: one row a signal, its error over time on the left, a second and a half from near on the right."""
    held_out = _held_out(diagnosis, recording, signals[0])
    places = [place for place in diagnosis.located if place.recording in ("", recording)]

    def draw(figure: Figure) -> None:
        rows = figure.subplots(len(signals), 2, squeeze=False, width_ratios=(1.55, 1.0))
        for row, series in zip(rows, signals):
            _error_over_time(row[0], series, [p for p in places if concerns(p, series.signal)], held_out)
            _from_near(row[1], series, held_out)
            row[0].sharex(rows[0][0])
        rows[-1][0].set_xlabel("time, s")
        rows[-1][1].set_xlabel("time, s")
        _legend(figure, bool(held_out), bool(places))

    return _svg((9.6, 0.55 + 1.75 * len(signals)), draw)


def curve(finding: Finding) -> str:
    """Return an SVG of the curve that stands for something without a name, with its band; "" where there is none."""
    held = finding.curve
    if held is None or "values" not in held:
        return ""
    at, values = np.asarray(held["at"], dtype=float), np.asarray(held["values"], dtype=float)
    band = np.asarray(held.get("band", np.zeros_like(values)), dtype=float)
    name, size = amounts.shown_in(str(held.get("unit", "")), float(np.nanmax(np.abs(values), initial=0.0)))
    variable = str(held.get("variable", "variable"))
    along, scale = amounts.shown_in("Pa", 1e5) if variable.startswith("pressure") else ("s" if variable == "time" else "SI", 1.0)

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.fill_between(at / scale, (values - band) / size, (values + band) / size, color=AFTER, alpha=0.2, linewidth=0.0)
        axes.plot(at / scale, values / size, color=AFTER, marker="o", markersize=3.0)
        axes.axhline(0.0, color=NOISE, linewidth=0.8)
        axes.set_xlabel(f"{variable.replace('_', ' ')}, {along}")
        axes.set_ylabel(f"missing {str(held.get('acts', '')).replace('_', ' ')}, {name}")

    return _svg((5.2, 2.4), draw)


def concerns(place: Located, signal: str) -> bool:
    """Return whether a located mismatch sits in the balance that predicts a signal."""
    part, name = signal.rsplit(".", 1)
    where, _, node = place.where.partition("/")
    if node.startswith("chamber"):
        return part == where and name == f"pressure_{node[-1]}"
    if "force" in place.equation or "motion" in place.equation:
        return not name.startswith("pressure")
    return part == where or where in ("supply", "exhaust")


def _error_over_time(axes: Axes, series: Series, places: Sequence[Located], held_out: Sequence[tuple[float, float]]) -> None:
    edges = np.linspace(series.time[0], series.time[-1], STRETCHES + 1)
    before, after = shown_errors(series, edges)
    known = np.concatenate([before, after, [series.noise]])
    known = known[np.isfinite(known) & (known > 0.0)]
    name, size = amounts.shown_in(series.unit, float(np.quantile(known, 0.9)) if known.size else 1.0)
    for start, stop in held_out:
        axes.axvspan(start, stop, color=HELD_OUT, linewidth=0.0, zorder=0)
    for place in places:
        for start, stop in place.when:
            axes.axvspan(start, stop, ymin=0.94, color=LOCATED, linewidth=0.0, zorder=1)
    axes.stairs(before / size, edges, color=BEFORE, linewidth=1.3, baseline=None)
    axes.stairs(after / size, edges, color=AFTER, linewidth=1.3, baseline=None)
    if series.noise > 0.0:
        axes.axhline(series.noise / size, color=NOISE, linewidth=1.0, linestyle="--")
    axes.set_yscale("log")
    if known.size:
        low, high = np.quantile(known, (0.01, 0.975))
        axes.set_ylim(0.6 * low / size, 2.2 * high / size)
    _plain_ticks(axes)
    axes.set_title(series.signal)
    axes.set_ylabel(f"error, {name}")
    axes.set_xlim(edges[0], edges[-1])


def shown_errors(series: Series, edges: Array) -> tuple[Array, Array]:
    """Return the error before and after over each stretch of time, no less than is drawn; edges of shape (n + 1,), errors (n,)."""
    errors = (_stretches(series.time, values - series.recorded, edges) for values in (series.before, series.after))
    before, after = (np.maximum(error, LEAST_SHOWN * series.noise) for error in errors)
    return before, after


def _from_near(axes: Axes, series: Series, held_out: Sequence[tuple[float, float]]) -> None:
    start, stop = nearest_look(series, held_out)
    rows = np.arange(*np.searchsorted(series.time, (start, stop)))
    rows = rows[:: max(1, len(rows) // MOST_POINTS)]
    time = series.time[rows]
    lines = [values[rows] for values in (series.recorded, series.before, series.after)]
    shown = np.concatenate([line[np.isfinite(line)] for line in lines])
    low, high = np.quantile(shown, (0.005, 0.995)) if shown.size else (0.0, 1.0)
    name, size = amounts.shown_in(series.unit, float(max(abs(low), abs(high))))
    if high > low:
        axes.set_ylim((low - 0.08 * (high - low)) / size, (high + 0.08 * (high - low)) / size)
    widths = (2.6, 1.2, 1.2)
    for line, colour, width, alpha in zip(lines, (RECORDED, BEFORE, AFTER), widths, (0.35, 1.0, 1.0)):
        axes.plot(time, line / size, color=colour, linewidth=width, alpha=alpha, solid_capstyle="round")
    if any(a <= start and stop <= b for a, b in held_out):
        axes.set_facecolor(HELD_OUT)
    axes.set_ylabel(name)
    axes.set_xlim(start, stop)
    axes.locator_params(axis="x", nbins=4)


def nearest_look(series: Series, held_out: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return the second and a half in which before and after differ most, within held-out time where there is enough."""
    first, last = float(series.time[0]), float(series.time[-1])
    length = min(NEAR, last - first)
    gain = np.nan_to_num((series.before - series.recorded) ** 2 - (series.after - series.recorded) ** 2)
    if not np.any(gain):
        gain = np.nan_to_num((series.before - series.recorded) ** 2)
    usual = float(np.quantile(np.abs(gain), 0.98))
    gain = np.clip(gain, -usual, usual)  # what derivatives do at the ends of a recording tells nothing
    total = np.concatenate([[0.0], np.cumsum(gain)])
    roomy = [(a, b) for a, b in held_out if b - a >= length] or [(first, last)]
    starts = np.concatenate([np.linspace(a, b - length, max(2, int(4 * (b - a) / max(length, 1e-9)))) for a, b in roomy])
    sums = total[np.searchsorted(series.time, starts + length)] - total[np.searchsorted(series.time, starts)]
    start = float(starts[int(np.argmax(sums))])
    return start, start + length


def _held_out(diagnosis: Diagnosis, recording: str, series: Series) -> list[tuple[float, float]]:
    first, last = float(series.time[0]), float(series.time[-1])
    return [(max(a, first), min(b, last)) for a, b in diagnosis.held_out.get(recording, ()) if b > first and a < last]


def _stretches(time: Array, error: Array, edges: Array) -> Array:
    """Return the rms of an error in each stretch of time, NaN where nothing was predicted."""
    place = np.clip(np.searchsorted(edges, time, side="right") - 1, 0, len(edges) - 2)
    there = np.isfinite(error)
    count = np.bincount(place[there], minlength=len(edges) - 1)
    total = np.bincount(place[there], weights=error[there] ** 2, minlength=len(edges) - 1)
    return np.where(count > 0, np.sqrt(total / np.maximum(count, 1)), np.nan)


def _rms(error: Array) -> float:
    there = error[np.isfinite(error)]
    return float(np.sqrt(np.mean(there**2))) if there.size else 0.0


def _plain_ticks(axes: Axes) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axes.get_ylim()
    wide = high / low > 30.0
    axes.yaxis.set_major_locator(LogLocator(10.0, subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _legend(figure: Figure, held_out: bool, located: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        Line2D([], [], color=RECORDED, linewidth=2.6, alpha=0.35, label="recorded"),
        Line2D([], [], color=BEFORE, label="rig as given"),
        Line2D([], [], color=AFTER, label="rig as found"),
        Line2D([], [], color=NOISE, linestyle="--", label="noise floor"),
    ]
    if located:
        handles.append(Patch(color=LOCATED, label="located here"))
    if held_out:
        handles.append(Patch(color=HELD_OUT, label="held out: no part in fitting"))
    figure.legend(handles=handles, loc="outside upper left", ncols=len(handles), frameon=False, handlelength=1.6, columnspacing=1.4)


def _svg(size: tuple[float, float], draw: Any) -> str:
    """Draw and return an SVG that is the same byte for byte."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        figure = Figure(figsize=size, layout="constrained")
        draw(figure)
        buffer = io.StringIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    return re.sub(r"^.*?(?=<svg)", "", text, flags=re.DOTALL)
