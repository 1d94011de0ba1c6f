"""One diagnosis of a whole machine against what is true of it.

A name is *expected* where it matters: where the true machine, used without it and fitted again, misses recordings by more than
`MATTERS` times what can be seen (`matters`). What is there and does not matter is optional, neither rewarded nor punished; so is a
fault that an instrument really has, and what stands beside an effect because its law differs from the contract's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from exo_sim.trials.whole_machines.hidden_effects import BLOCKS

#: Multiples of what can be seen from which an effect is expected to be named.
MATTERS = 2.0
#: Names that may be given beside anything: believed numbers are a little off on every rig.
CALIBRATIONS = ("flow_capacity", "dead_volume", "payload_mass")
#: From here a name is given with confidence.
CONFIDENT_PROBABILITY, CONFIDENT_ODDS = 0.9, 2.0
FAMILIES: dict[str, str] = {name: block.family for block in BLOCKS.values() for name in (block.name or block.key, *block.also)}
FAMILIES |= {"presliding": "friction", "backlash": "transmission", "cracking_pressure": "flow", "subsonic_index": "flow"}


@dataclass(frozen=True)
class Mark:
    """What one diagnosis of a whole machine is worth.

    Attributes:
        case, cell, make: Which.
        reported: Of a make that is only reported on, never learnt from.
        answered: There was a diagnosis.
        verdict: As given.
        expected, optional: True names.
        found: Of `expected`, those named; `class_found`: those of whose family a name was given.
        right, neutral, wrong: Names given.
        false_sensors: Sensors called faulty that are not.
        unknown: Places where something without a name was reported.
        confidently_wrong: Of `wrong` and `false_sensors`, those given with confidence.
        exact, class_exact: All that is expected and nothing wrong; the same by family.
        parameters: (name, relative error, covered by the interval).
        probabilities: (claimed, was it so) of every name given.
        errors: What `fresh.errors` says of a recording that nobody had seen.
        time_s: Processor time.
    """

    case: str
    cell: str
    make: str
    reported: bool
    answered: bool
    verdict: str
    expected: tuple[str, ...]
    optional: tuple[str, ...]
    found: tuple[bool, ...]
    class_found: tuple[bool, ...]
    right: tuple[str, ...]
    neutral: tuple[str, ...]
    wrong: tuple[str, ...]
    false_sensors: tuple[str, ...]
    unknown: tuple[str, ...]
    confidently_wrong: tuple[str, ...]
    exact: bool
    class_exact: bool
    parameters: tuple[tuple[str, float, bool], ...]
    probabilities: tuple[tuple[float, bool], ...]
    errors: Mapping[str, Any] = field(default_factory=dict)
    time_s: float | None = None


def judge(
    truth: Mapping[str, Any],
    diagnosis: Mapping[str, Any] | None,
    errors: Mapping[str, Any] | None = None,
    time_s: float | None = None,
    matters: float = MATTERS,
) -> Mark:
    """Compare.

    Args:
        truth: The content of truth.json.
        diagnosis: The content of diagnosis.json; None where the tool gave none.
        errors: Of the fresh recording.
        time_s: Processor time that it took.
        matters: Multiples of what can be seen from which an effect is expected.
    """
    answered = isinstance(diagnosis, Mapping) and isinstance(diagnosis.get("effects"), list)
    report: Mapping[str, Any] = diagnosis if answered and diagnosis is not None else {}
    given = [entry for entry in report.get("effects", []) if isinstance(entry, Mapping) and entry.get("name")]
    hidden = truth["hidden"]
    listed = [one for one in hidden if one["kind"] != "outside"]
    outside = [one for one in hidden if one["kind"] == "outside"]
    expected = [one for one in listed if _worst(one) >= matters]
    names = [entry for entry in given if not _calibration(entry) and entry["name"] != "unknown" and entry.get("kind") != "sensor"
             and not str(entry["name"]).startswith("sensor_")]  # fmt: skip
    right, neutral, wrong = [], [], []
    for entry in names:
        if any(_names(one, entry) for one in hidden):
            right.append(entry)
        elif entry["name"] in truth["beside"] or entry["name"] in truth["known"]:
            neutral.append(entry)
        else:
            wrong.append(entry)
    sensors = [entry for entry in given if entry.get("kind") == "sensor" or str(entry["name"]).startswith("sensor_")]
    false_sensors = [entry for entry in sensors if not _really(entry, truth["columns"])]
    found = tuple(any(_names(one, entry) for entry in names) for one in expected)
    families = {FAMILIES.get(str(entry["name"]), "") for entry in names}
    true_families = {one["family"] for one in hidden}
    class_found = tuple(hit or one["family"] in families for hit, one in zip(found, expected))
    unknown = [str(entry.get("where", "")) for entry in given if entry["name"] == "unknown"]
    noticed = bool(unknown) or any(_names(one, entry) for one in outside for entry in names)
    complete = all(found) and (noticed or not outside) and answered
    clean = not wrong and not false_sensors and (not unknown or bool(outside))
    return Mark(
        case=str(truth["case"]),
        cell=str(truth["cell"]),
        make=str(truth["make"]),
        reported=bool(truth["reported_only"]),
        answered=answered,
        verdict=str(report.get("verdict", "")),
        expected=tuple(one["name"] for one in expected),
        optional=tuple(one["name"] for one in listed if one not in expected),
        found=found,
        class_found=class_found,
        right=_called(right),
        neutral=_called(neutral),
        wrong=_called(wrong),
        false_sensors=_called(false_sensors),
        unknown=tuple(unknown),
        confidently_wrong=_called([entry for entry in (*wrong, *false_sensors) if _confident(entry)]),
        exact=complete and clean,
        class_exact=answered
        and all(class_found)
        and not false_sensors
        and (noticed or not outside or bool(families & {one["family"] for one in outside}))
        and all(FAMILIES.get(str(entry["name"]), "") in true_families for entry in wrong),
        parameters=tuple(result for one in hidden for entry in right if _names(one, entry) for result in _parameters(one, entry)),
        probabilities=tuple((_probability(entry), entry in right) for entry in (*right, *wrong) if _probability(entry) >= 0),
        errors=dict(errors or {}),
        time_s=time_s,
    )


def _worst(one: Mapping[str, Any]) -> float:
    measured = one.get("matters")
    return float(measured["worst"]) if measured else float("inf")


def _names(one: Mapping[str, Any], entry: Mapping[str, Any]) -> bool:
    """Return whether a finding names this effect, at its place or at a part of it."""
    if entry["name"] != one["name"] and entry["name"] not in one["also"]:
        return False
    where = str(entry.get("where", ""))
    return any(where == place or where.startswith((f"{place}/", f"{place}.")) for place in one["places"])


def _calibration(entry: Mapping[str, Any]) -> bool:
    return entry.get("kind") == "calibration" or entry["name"] in CALIBRATIONS


def _really(entry: Mapping[str, Any], columns: Mapping[str, Any]) -> bool:
    """Return whether an instrument really has the fault that is reported, about as large."""
    channel = columns.get(str(entry.get("where", "")).split(" ")[0])
    if channel is None:
        return False
    for key, true in (("seconds", channel["late"]), ("value", channel["offset"]), ("factor", channel["scale"] - 1.0)):
        claimed = ((entry.get("parameters") or {}).get(key) or {}).get("value")
        if isinstance(claimed, int | float):
            off = claimed - 1.0 if key == "factor" else claimed
            # a filter's delay is what an instrument has; only a delay of several milliseconds is its fault
            least = 4e-3 if key == "seconds" else 0.0
            return abs(true) > least and abs(off - true) < 0.4 * abs(true)
    return False


def _confident(entry: Mapping[str, Any]) -> bool:
    stated = _probability(entry)
    if stated >= 0:
        return stated >= CONFIDENT_PROBABILITY
    odds = (entry.get("evidence") or {}).get("log10_odds")
    return not isinstance(odds, int | float) or odds >= CONFIDENT_ODDS


def _probability(entry: Mapping[str, Any]) -> float:
    stated = entry.get("probability", (entry.get("evidence") or {}).get("probability"))
    return float(stated) if isinstance(stated, int | float) else -1.0


def _called(entries: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    return tuple(str(entry["name"]) for entry in entries)


def _parameters(one: Mapping[str, Any], entry: Mapping[str, Any]) -> list[tuple[str, float, bool]]:
    """Return the error and coverage of each parameter whose true value the contract's law has."""
    out = []
    for key, true in one["parameters"].items():
        stated = (entry.get("parameters") or {}).get(key)
        if not isinstance(stated, Mapping) or not isinstance(stated.get("value"), int | float):
            continue
        low, high = stated.get("low"), stated.get("high")
        covered = isinstance(low, int | float) and isinstance(high, int | float) and low <= true["high"] and high >= true["low"]
        out.append((f"{one['name']}.{key}", abs(stated["value"] - true["value"]) / abs(true["value"]), covered))
    return out
