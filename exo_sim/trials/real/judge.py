"""What one diagnosis of a real machine is worth: names first, then the rig that it wrote.

Names: the share of the certain effects that were named; a name that must not be there makes the whole mark 0; something without a name,
where everything has one, counts as one more that was missed. Error of the improved rig on what was held out over that of the best
honest model: full up to 1.3, nothing from 3 on or where it is worse than the rig handed in. The mark is the mean of both.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from exo_sim.trials.real.case import Known, Name
from exo_sim.trials.real.errors import ratio

#: Error over that of the best honest model up to which a rig is as good, and from which it is worth nothing.
AS_GOOD, WORTHLESS = 1.3, 3.0
#: A rig that is this much worse than the one handed in is worse.
WORSE = 1.02
_CALIBRATIONS = ("flow_capacity", "dead_volume", "payload_mass")


@dataclass(frozen=True)
class Mark:
    """What one diagnosis is worth.

    Attributes:
        case, variant_of, make: Which, of which make of rig.
        verdict: As given; "" where there was no answer.
        found, missed: Certain effects that were named, and not.
        allowed, forbidden: Other names given.
        unknown: Places where something without a name was reported.
        names: Mark for the names, 0 to 1; 0 with anything forbidden.
        before, after, honest: Errors on what was held out, by signal.
        over_honest, over_before: Of `after`; None where one of both is not known.
        before_over_honest: How far the rig as handed in is from the best honest model.
        errors: Mark for the improved rig, 0 to 1.
        mark: The whole, 0 to 1.
        cpu_s: Processor time of the diagnosis.
        remarks: What could not be judged.
    """

    case: str
    variant_of: str
    make: str
    verdict: str
    found: tuple[str, ...]
    missed: tuple[str, ...]
    allowed: tuple[str, ...]
    forbidden: tuple[str, ...]
    unknown: tuple[str, ...]
    names: float
    before: Mapping[str, float] | None
    after: Mapping[str, float] | None
    honest: Mapping[str, float]
    over_honest: float | None
    over_before: float | None
    before_over_honest: float | None
    errors: float
    mark: float
    cpu_s: float | None = None
    remarks: tuple[str, ...] = field(default=())


def judge(case: str, known: Known, diagnosis: Mapping[str, Any] | None, before: Mapping[str, float] | None,
          after: Mapping[str, float] | None, honest: Mapping[str, float], cpu_s: float | None = None,
          remarks: Sequence[str] = (), variant_of: str = "", make: str = "") -> Mark:  # fmt: skip
    """Compare a diagnosis with what is known.

    Args:
        case, variant_of, make: Which, of which make of rig.
        known: What is known of the machine.
        diagnosis: The content of diagnosis.json; None where the tool gave none.
        before, after: Errors of the rig handed in and of the improved one on what was held out; None where one cannot be run.
        honest: Those of the best honest model; empty where there is none.
        cpu_s: Processor time.
        remarks: What could not be judged.
    """
    answered = isinstance(diagnosis, Mapping) and isinstance(diagnosis.get("effects"), list)
    report: Mapping[str, Any] = diagnosis if answered and diagnosis is not None else {}
    given = [entry for entry in report.get("effects", []) if isinstance(entry, Mapping) and entry.get("name")]
    unknown = [str(entry.get("where", "")) for entry in given if entry["name"] == "unknown"]
    named = [
        entry for entry in given if entry["name"] not in ("unknown", *_CALIBRATIONS) and entry.get("kind") not in ("calibration", "unknown")
    ]
    found = [name for name in known.must if any(_is(name, entry) for entry in named)]
    missed = [name for name in known.must if name not in found]
    rest = [entry for entry in named if not any(_is(name, entry) for name in known.must)]
    allowed = [entry for entry in rest if any(_is(name, entry) for name in known.may)]
    forbidden = [entry for entry in rest if entry not in allowed]
    names = _mark_of_names(answered, len(found), len(missed), bool(unknown) and not known.unknown, bool(forbidden))
    over_honest, over_before = ratio(after, honest), ratio(after, before) if before else None
    rig = _mark_of_errors(over_honest, over_before) if answered and after is not None else 0.0
    return Mark(
        case=case,
        variant_of=variant_of,
        make=make,
        verdict=str(report.get("verdict", "")),
        found=tuple(map(str, found)),
        missed=tuple(map(str, missed)),
        allowed=_called(allowed),
        forbidden=_called(forbidden),
        unknown=tuple(unknown),
        names=names,
        before=before,
        after=after,
        honest=honest,
        over_honest=over_honest,
        over_before=over_before,
        before_over_honest=ratio(before, honest),
        errors=rig,
        mark=0.0 if forbidden or not answered else 0.5 * (names + rig),
        cpu_s=cpu_s,
        remarks=tuple(remarks),
    )


def _is(name: Name, entry: Mapping[str, Any]) -> bool:
    """Return whether a finding is this effect: its name, or one that it says cannot be distinguished, at its place or a part of it."""
    called = (entry["name"], *(entry.get("ambiguous_with") or ()))
    where = str(entry.get("where", ""))
    right_place = any(where == place or where.startswith((f"{place}/", f"{place}.", f"{place} ")) for place in name.places)
    return right_place and any(one in name.names for one in called)


def _mark_of_names(answered: bool, found: int, missed: int, needless: bool, forbidden: bool) -> float:
    if not answered or forbidden:
        return 0.0
    asked = found + missed + needless
    return (found if asked else 1) / max(asked, 1)


def _mark_of_errors(over_honest: float | None, over_before: float | None) -> float:
    if over_before is not None and over_before > WORSE:
        return 0.0
    if over_honest is None:
        return 1.0
    return min(max((WORTHLESS - over_honest) / (WORTHLESS - AS_GOOD), 0.0), 1.0)


def _called(entries: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    return tuple(f"{entry['name']} ({entry.get('where', '')})" for entry in entries)
