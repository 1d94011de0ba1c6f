"""A diagnosis as one self-contained page that is read in two minutes and printed."""

from __future__ import annotations

import difflib
from importlib import metadata
from pathlib import Path
from typing import Any

from exo_sim.diagnosis.findings import Finding, Located, SignalFit
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.report import amounts, diagnosis_picture, diagnosis_words
from exo_sim.version import VERSION

_HERE = Path(__file__).parent
_PACKAGES = ("mujoco", "numpy", "scipy", "numba")


def page(diagnosis: Diagnosis, rig_text: str, rig_name: str = "rig.toml") -> str:
    """Return the HTML.

    The same diagnosis, rig and versions give the same bytes.

    Args:
        diagnosis: What was found.
        rig_text: The rig as it was handed in.
        rig_name: What its file is called.
    """
    import jinja2

    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    environment.filters.update(share=amounts.share, name_of=diagnosis_words.name_of, joined=diagnosis_words.joined)
    template = environment.from_string((_HERE / "diagnosis.html").read_text(encoding="utf-8"))
    pictures = diagnosis_picture.drawn(diagnosis)
    following = diagnosis.next_experiment
    return template.render(
        d=diagnosis,
        style=(_HERE / "diagnosis.css").read_text(encoding="utf-8"),
        badge=diagnosis_words.VERDICTS[diagnosis.verdict],
        sentence=diagnosis_words.verdict(diagnosis),
        proof=diagnosis_words.proof(diagnosis),
        first=diagnosis_words.first_step(diagnosis),
        experiments=diagnosis_words.settles(following.ranked if following else ()),
        unexplained=[diagnosis_words.unexplained(left) for left in diagnosis.unexplained],
        small=[
            (diagnosis_words.small(one), name, value, span)
            for one in diagnosis.small
            for name, value, span in diagnosis_words.numbers(one)
        ],
        findings=[_finding(finding) for finding in diagnosis.effects if finding.kind != "calibration"],
        corrections=[row for finding in diagnosis.effects if finding.kind == "calibration" for row in _correction(finding)],
        pictures=[(name, diagnosis_picture.overview(diagnosis, name, signals)) for name, signals in pictures],
        not_drawn=len({s.recording for s in diagnosis.series}) - len(pictures),
        fits=[_fit(name, fit) for name, fit in diagnosis.signals.items()],
        runs=[_fit(name, run) for name, run in diagnosis.free_run.items()],
        held_out=diagnosis_words.held_out_time(diagnosis),
        rejected=diagnosis_words.weighed_against(diagnosis),
        located=[_located(place) for place in diagnosis.located],
        diff=_diff(rig_text, diagnosis.improved, rig_name),
        versions=versions(),
    )


def versions() -> str:
    """Return what made the page, with versions."""
    return ", ".join([f"exo-sim {VERSION}", *(f"{name} {metadata.version(name)}" for name in _PACKAGES)])


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "title": diagnosis_words.title(finding),
        "where": finding.where,
        "kind": diagnosis_words.KINDS[finding.kind],
        "class": finding.kind,
        "says": finding.says,
        "numbers": diagnosis_words.numbers(finding),
        "evidence": diagnosis_words.evidence(finding),
        "cost": diagnosis_words.cost(finding),
        "check": diagnosis_words.on_the_machine(finding),
        "rivals": diagnosis_words.rivals(finding),
        "depends_on": diagnosis_words.joined(finding.depends_on),
        "curve": diagnosis_picture.curve(finding),
    }


def _correction(finding: Finding) -> list[tuple[str, str, str, str]]:
    """Return (sentence, part, factor or value, interval) for each number that is off; of several the sentence stands once."""
    rows: list[tuple[str, str, str, str]] = []
    numbers = diagnosis_words.numbers(finding)
    for estimate, (name, value, span) in zip(diagnosis_words.estimates(finding).values(), numbers, strict=True):
        times = "× " if estimate.unit in ("", "1") else ""
        place = "" if finding.where in finding.says else finding.where
        part = f"{place} {name}".strip() if len(numbers) > 1 else place
        rows.append(("" if rows else finding.says, part, times + value, span))
    return rows or [(finding.says, finding.where, "", "")]


def _fit(name: str, fit: SignalFit) -> dict[str, Any]:
    """Return one row of the proof: numbers in one unit, and how long their bars are against the largest."""
    fit = diagnosis_words.without_rounding(fit)
    unit, size = amounts.shown_in(fit.unit, fit.largest)
    row: dict[str, Any] = {"name": name, "unit": unit}
    for key, value in (("before", fit.before), ("after", fit.after), ("noise", fit.noise)):
        row[key] = amounts.digits(value / size)
        row[f"{key}_share"] = f"{100 * value / fit.largest:.1f}" if value == value else "0"
    return row


def _located(place: Located) -> dict[str, Any]:
    return {
        "where": place.where,
        "equation": place.equation,
        "share": amounts.share(place.share),
        "regime": place.regime,
        "error": amounts.amount(place.error, place.unit),
        "noise": amounts.amount(place.noise, place.unit),
        "when": amounts.spans(place.when).replace(" and ", ", and ").split(", "),
        "recording": place.recording,
    }


def _diff(before: str, after: str, name: str) -> list[tuple[str, str]]:
    """Return the lines of a unified diff as (kind, text)."""
    if not after or after == before:
        return []
    lines = list(difflib.unified_diff(before.splitlines(), after.splitlines(), name, "improved.toml", lineterm="", n=2))
    kinds = {"+": "added", "-": "removed", "@": "place"}
    return [("file" if i < 2 else kinds.get(line[:1], "same"), line) for i, line in enumerate(lines)]
