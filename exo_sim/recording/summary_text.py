"""A summary as text for the terminal: what is odd first, a line each; then aligned tables, in the units people read."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from exo_sim.recording.instants import instant
from exo_sim.recording.summary import Summary

#: SI unit to the unit that is printed, and how many of these one SI unit is.
_READABLE = {"Pa": ("bar", 1e-5), "rad": ("deg", 57.29577951308232), "rad/s": ("deg/s", 57.29577951308232)}
_MARKS = {"fault": "!!", "warning": "! ", "info": "  "}
_MEANINGS = {"fault": "!! a sensor or the file is wrong", "warning": "! may spoil results"}
_SHORT_METADATA = 60
#: Columns that are listed with their numbers without being asked for.
_FEW_COLUMNS = 30
_WIDTH = 110


def text(summary: Summary, every_column: bool = False) -> str:
    """Return the summary: what looks wrong, then what is in it.

    Args:
        summary: Of a recording.
        every_column: List the numbers of every column, also where there are many; else of those with something to look at.
    """
    blocks = [_head(summary.head), _findings(summary)]
    if metadata := _metadata(summary.head):
        blocks.append(metadata)
    if every_column or len(summary.signals) <= _FEW_COLUMNS:
        blocks.append(_signals(summary.signals))
    else:
        blocks += _many_signals(summary)
    if summary.gait:
        blocks.append("Gait\n" + _gait(summary.gait))
    if summary.cylinders:
        blocks.append("Cylinders\n" + _cylinders(summary.cylinders))
    if any(len(entry) > 2 for entry in summary.joints.values()):
        blocks.append("Joints\n" + _joints(summary.joints))
    return "\n\n".join(blocks)


def _head(head: dict[str, Any]) -> str:
    start = head["start_s"]
    begins = f", from {instant(start, start, start + head['duration_s'])} s on" if start else ""
    return f"{head['name']}: {head['duration_s']:.4g} s, {head['samples']} samples, {head['rate_hz']:.4g} Hz{begins}"


def _metadata(head: dict[str, Any]) -> str:
    lines = []
    for key, value in head["metadata"].items():
        one_line = " ".join(value.split())
        if len(one_line) <= _SHORT_METADATA or "\n" not in value.strip():
            lines.append(f"{key}: {one_line}")
        else:
            lines.append(f"{key}: {len(value.splitlines())} lines, {len(value)} characters (all of it with --json)")
    return "\n".join(lines)


def _many_signals(summary: Summary) -> list[str]:
    """Return the columns that are something to look at with their numbers, and the names of all, parts with the same signals together."""
    odd = {finding.column for finding in summary.findings if finding.severity != "info"}
    looked_at = [entry for entry in summary.signals if entry["name"] in odd or entry["missing"]]
    signals_of: dict[str, list[str]] = {}
    for entry in summary.signals:
        part, _, signal = entry["name"].rpartition(".")
        signals_of.setdefault(part, []).append(signal)
    parts_with: dict[tuple[str, ...], list[str]] = {}
    for part, signals in signals_of.items():
        parts_with.setdefault(tuple(sorted(signals)), []).append(part)
    lines = [f"{len(summary.signals)} columns (the numbers of each: --all)"]
    for shared, parts in parts_with.items():
        lines += textwrap.wrap(f"{', '.join(parts)}: {', '.join(shared)}", _WIDTH, initial_indent="  ", subsequent_indent="    ")
    return [*([_signals(looked_at)] if looked_at else []), "\n".join(lines)]


def _signals(signals: Sequence[dict[str, Any]]) -> str:
    rows = []
    for entry in signals:
        unit, scale = _unit(entry["unit"], max(abs(entry["least"]), abs(entry["greatest"])))
        size = max(abs(entry["least"]), abs(entry["greatest"]))
        numbers = [_number(scale * entry[name], scale * size) for name in ("least", "mean", "greatest", "rms")]
        rows.append([entry["name"], *numbers, _noise(entry, scale), unit, str(entry["missing"] or "")])
    return _table(["signal", "least", "mean", "greatest", "rms", "noise", "unit", "missing"], rows, left=(0, 6))


def _gait(gait: Sequence[dict[str, Any]]) -> str:
    rows = []
    for foot in gait:
        stride = "-" if foot["stride_s"] is None else f"{foot['stride_s']:.3f} +- {foot['stride_spread_s']:.3f}"
        peak = "-" if foot["peak_force_n"] is None else f"{foot['peak_force_n']:.0f}"
        rows.append([foot["foot"], str(foot["strides"]), stride, f"{100 * foot['stance_share']:.0f}", peak])
    return _table(["foot", "strides", "stride, s", "stance, %", "peak force, N"], rows)


def _cylinders(cylinders: dict[str, dict[str, Any]]) -> str:
    rows = []
    for name, entry in cylinders.items():
        spans = [
            "-" if span is None else f"{span[0] / 1e5:.2f}..{span[1] / 1e5:.2f}"
            for span in (entry.get("pressure_1_pa"), entry.get("pressure_2_pa"))
        ]
        rows.append(
            [
                name,
                *spans,
                _or_dash(entry.get("force_peak_n"), "{:.0f}"),
                _or_dash(entry.get("force_error_rms_n"), "{:.1f}"),
                _or_dash(entry.get("valve_closed_share"), "{:.0f}", 100.0),
                _or_dash(entry.get("choked_share"), "{:.0f}", 100.0),
                _or_dash(entry.get("gas_used_kg"), "{:.2f}", 1e3),
                _or_dash(entry.get("gas_used_kg_per_stride"), "{:.2f}", 1e3),
            ]
        )
    titles = ["cylinder", "p1, bar", "p2, bar", "peak force, N", "force error, N", "closed, %", "choked, %", "gas, g"]
    return _table([*titles, "gas a stride, g"], rows)


def _joints(joints: dict[str, dict[str, Any]]) -> str:
    rows = []
    for name, entry in joints.items():
        low, high = entry.get("range", (None, None))
        unit, scale = _unit(entry.get("unit", ""), 0.0)
        span = "-" if low is None else f"{scale * low:.4g}..{scale * high:.4g} {unit}"
        rows.append(
            [
                name,
                span,
                _or_dash(entry.get("speed_peak"), "{:.4g}", scale),
                _or_dash(entry.get("torque_peak"), "{:.1f}"),
                _or_dash(entry.get("torque_rms"), "{:.1f}"),
                _or_dash(entry.get("torque_error_rms"), "{:.2f}"),
                _or_dash(entry.get("external_force_rms"), "{:.4g}"),
            ]
        )
    titles = ["joint", "range", "peak speed", "peak torque", "rms torque", "torque error", "outside force, rms"]
    return _table(titles, rows)


def _findings(summary: Summary) -> str:
    if not summary.findings:
        return "Nothing looks wrong."
    wrong = [finding for finding in summary.findings if finding.severity != "info"]
    title = f"{len(wrong)} thing{'' if len(wrong) == 1 else 's'} look{'s' if len(wrong) == 1 else ''} wrong"
    marks = "; ".join(words for severity, words in _MEANINGS.items() if any(finding.severity == severity for finding in wrong))
    lines = [f"{title} ({marks})" if wrong else "Nothing looks wrong; worth knowing"]
    for finding in summary.findings:
        use = "these rows are left out" if finding.use == "set aside" and finding.rows else finding.use
        said = use == "used" or use in finding.says
        after = "" if said else f" [{use}]"
        lines.append(f"  {_MARKS[finding.severity]} {finding.says}{after}")
    return "\n".join(lines)


def _unit(unit: str, size: float) -> tuple[str, float]:
    if unit == "m" and 0.0 < size < 1.0:
        return "mm", 1e3
    return _READABLE.get(unit, ("" if unit == "1" else unit, 1.0))


def _noise(entry: dict[str, Any], scale: float) -> str:
    floor = entry["noise"]
    if floor <= 1e-6 * max(abs(entry["least"]), abs(entry["greatest"])):
        return "-"
    return ("<" if entry["noise_is_a_bound"] else "") + f"{scale * floor:.2g}"


def _number(value: float, size: float) -> str:
    if abs(value) < 1e-9 * size:
        return "0"
    return f"{value:.4g}" if abs(value) < 1e5 or abs(value) >= 1e7 else f"{value:.0f}"


def _or_dash(value: float | None, how: str, scale: float = 1.0) -> str:
    return "-" if value is None else how.format(scale * value)


def _table(titles: Sequence[str], rows: Sequence[Sequence[str]], left: Sequence[int] = (0,)) -> str:
    """Align columns; those that are empty in every row are left out."""
    kept = [i for i in range(len(titles)) if any(row[i] not in ("", "-") for row in rows)]
    widths = [max(len(titles[i]), *(len(row[i]) for row in rows)) for i in kept]
    lines = []
    for row in (titles, *rows):
        cells = [row[i].ljust(width) if i in left else row[i].rjust(width) for i, width in zip(kept, widths)]
        lines.append("  " + "  ".join(cells).rstrip())
    return "\n".join(lines)
