"""One verdict against one truth: what was found, what was missed, what was made up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from exo_sim.trials.detection_limit import NEEDED

#: Names that may be reported beside anything: believed numbers always are a little off.
CALIBRATIONS = ("flow_capacity", "dead_volume", "payload_mass")
#: Odds from which a name counts as confidently given (log10).
CONFIDENT = 2.0
_MOTION = {
    "coulomb_friction", "viscous_friction", "stribeck_friction", "pressure_dependent_friction", "asymmetric_friction",
    "presliding", "quadratic_drag", "return_spring", "payload_mass", "position_friction", "dwell_friction", "cogging",
    "draining_payload", "warming_grease", "magnetic_detent",
}  # fmt: skip
_EITHER = {"transmission_compliance", "backlash"}


@dataclass(frozen=True)
class Mark:
    """What one verdict is worth.

    Attributes:
        case, cell: Which.
        hidden: True names ("unknown" stands for anything outside the list).
        named: Names given, calibrations that were not hidden left out.
        best: The name given with the highest odds, or "".
        exact: The names given are the true ones, no more and no less.
        class_exact: As `exact`, a true name among the rivals of an ambiguous one counting as given.
        found: One per hidden effect: given, with the right place.
        class_found: One per hidden effect: given, or among the rivals of one that was.
        located: The first place reported is one where something is hidden; None where nothing is.
        probability: Mean probability on the truth: a name shares its weight with its rivals.
        confidently_wrong: Names given confidently that are neither true nor rivals of a true one.
        false_alarm: Missing physics or a faulty sensor was named where nothing is hidden.
        undetermined_right: "Cannot tell", where the likelihood cannot either.
        sizes: One per hidden effect: size in limits, and its distance.
        parameters: One per parameter of a found effect: (relative error, within low..high, name).
        held_out: Ratio of error after to noise, one per signal.
        drop: Ratio of error after to before, one per signal.
        answered: There was a diagnosis.
    """

    case: str
    cell: str
    hidden: tuple[str, ...]
    named: tuple[str, ...]
    best: str
    exact: bool
    class_exact: bool
    found: tuple[bool, ...]
    class_found: tuple[bool, ...]
    located: bool | None
    probability: float | None
    confidently_wrong: tuple[str, ...]
    false_alarm: bool
    undetermined_right: bool
    sizes: tuple[tuple[float, float], ...]
    parameters: tuple[tuple[float, bool, str], ...] = ()
    held_out: tuple[float, ...] = ()
    drop: tuple[float, ...] = ()
    answered: bool = True


def judge(truth: Mapping[str, Any], diagnosis: Mapping[str, Any] | None) -> Mark:
    """Compare.

    Args:
        truth: What `cases.truth_of` wrote, with the cell and the sizes in limits.
        diagnosis: The content of diagnosis.json; None where the tool gave none.
    """
    built, believed = _dampers(truth)
    hidden = [_Target(entry, truth.get("actual", {}), built - believed) for entry in truth["hidden"]]
    answered = isinstance(diagnosis, Mapping) and isinstance(diagnosis.get("effects"), list)
    report: Mapping[str, Any] = diagnosis if answered and diagnosis is not None else {}
    given = [entry for entry in report.get("effects", []) if isinstance(entry, Mapping) and entry.get("name")]
    targets = {target.name for target in hidden}
    spare = {"viscous_friction"} if believed < 0.95 * built else set()  # missing in truth, hidden or not
    given = [
        entry
        for entry in given
        if (entry["name"] in targets and not _elsewhere(entry, hidden)) or not (_mere_calibration(entry) or entry["name"] in spare)
    ]
    matches = [next((entry for entry in given if target.is_named_by(entry)), None) for target in hidden]
    rivals = [
        next((entry for entry in given if target.is_rival_of(entry)), None) if match is None else match
        for target, match in zip(hidden, matches)
    ]
    used = [id(entry) for entry in matches if entry is not None]
    loose = [id(entry) for entry in rivals if entry is not None]
    wrong = tuple(
        str(entry["name"])
        for entry in given
        if id(entry) not in loose and entry["name"] != "unknown" and _odds(entry) >= CONFIDENT
    )
    undetermined = report.get("verdict") == "undetermined"
    weak = bool(hidden) and all(target.distance < NEEDED for target in hidden)
    top = max(given, key=_odds, default=None)
    located = report.get("located") or []
    places = [str(entry.get("where", "")) + " " + str(entry.get("equation", "")) for entry in located[:1]]
    if not places and top is not None:
        places = [f"{top.get('where', '')} {'force' if top['name'] in _MOTION else 'gas'} balance"]
    return Mark(
        case=str(truth["case"]),
        cell=str(truth.get("cell", "")),
        hidden=tuple(target.name for target in hidden),
        named=tuple(str(entry["name"]) for entry in given),
        best=str(top["name"]) if top is not None else "",
        exact=answered and len(used) == len(hidden) == len(given) and len(set(used)) == len(used),
        class_exact=answered and len(loose) == len(hidden) == len(given) and len(set(loose)) == len(loose),
        found=tuple(match is not None for match in matches),
        class_found=tuple(match is not None for match in rivals),
        located=any(target.lies_at(place) for target in hidden for place in places) if hidden else None,
        probability=_mean([_weight(entry, target) if entry is not None else 0.0 for target, entry in zip(hidden, rivals)]),
        confidently_wrong=wrong,
        false_alarm=not hidden and any(entry.get("kind") != "calibration" for entry in given),
        undetermined_right=undetermined and weak and not given,
        sizes=tuple((target.times, target.distance) for target in hidden),
        parameters=tuple(
            result
            for target, match in zip(hidden, matches)
            if match is not None
            for result in target.parameters_of(match)
        ),
        held_out=_ratios(report, "after", "noise"),
        drop=_ratios(report, "after", "before"),
        answered=answered,
    )


class _Target:
    """One hidden effect as the judge sees it."""

    def __init__(self, entry: Mapping[str, Any], actual: Mapping[str, float], damping: float = 0.0) -> None:
        self.name = "unknown" if entry["kind"] == "outside" else str(entry["name"])
        self.true_name = str(entry["name"])
        self.names = {self.name, *entry.get("also", ())} if entry["kind"] == "sensor" else {self.name}
        self.kind = entry["kind"]
        self.places = (str(entry["where"]), *map(str, entry.get("also", ())))
        self.times = float(entry.get("times_limit", entry.get("size", 1.0)))
        self.distance = float(entry.get("distance", float("inf")))
        self.values = {key: float(value["value"]) for key, value in entry["parameters"].items()}
        if self.kind == "calibration" and self.true_name in actual:
            self.values = {"factor": float(actual[self.true_name])}
            if f"{self.true_name}_value" in actual:
                self.values["value"] = float(actual[f"{self.true_name}_value"])
        if self.true_name == "viscous_friction" and "coefficient" in self.values:
            self.values["coefficient"] += damping  # a damper and viscous friction are one number
        if self.kind == "outside":
            self.values = {}

    def is_named_by(self, found: Mapping[str, Any]) -> bool:
        if found["name"] not in self.names:
            return False
        if self.kind == "outside":
            return True
        where = str(found.get("where", ""))
        return any(where == place or where.startswith((f"{place}/", f"{place}.")) for place in self.places)

    def is_rival_of(self, found: Mapping[str, Any]) -> bool:
        rivals = found.get("ambiguous_with") or []
        names = {str(rival.get("name") if isinstance(rival, Mapping) else rival) for rival in rivals}
        return bool(names & self.names)

    def lies_at(self, place: str) -> bool:
        here = place.lower()
        if self.kind == "sensor" and self.places[0].lower() in here:
            return True
        if not any(here.startswith(part.split(".")[0].lower()) for part in (*self.places, "piston", "slide")):
            return False
        moving = any(word in here for word in ("force", "motion", "newton"))
        gaseous = any(word in here for word in ("energy", "mass", "chamber", "gas", "valve", "flow"))
        if self.true_name in _EITHER or self.kind == "sensor" or not (moving or gaseous):
            return True
        return moving if self.true_name in _MOTION else gaseous

    def parameters_of(self, found: Mapping[str, Any]) -> list[tuple[float, bool, str]]:
        out = []
        for key, value in (found.get("parameters") or {}).items():
            if key not in self.values or self.values[key] == 0 or not isinstance(value, Mapping):
                continue
            true, got = self.values[key], value.get("value")
            if not isinstance(got, int | float):
                continue
            low, high = value.get("low"), value.get("high")
            within = isinstance(low, int | float) and isinstance(high, int | float) and low <= true <= high
            out.append((abs(got - true) / abs(true), bool(within), f"{self.true_name}.{key}"))
        return out


def _dampers(truth: Mapping[str, Any]) -> tuple[float, float]:
    """Return the damping that was built and the one that its owner believes in [N s/m]; zeros where there is no damper."""
    built, believed = (float((truth.get(key) or {}).get("damping") or 0.0) for key in ("bench", "believed"))
    return built, believed


def _elsewhere(entry: Mapping[str, Any], hidden: Sequence[_Target]) -> bool:
    """Return whether a believed number was corrected at another place than the hidden one: there it may be a little off as well."""
    return _mere_calibration(entry) and not any(target.is_named_by(entry) for target in hidden)


def _mere_calibration(entry: Mapping[str, Any]) -> bool:
    return entry.get("kind") == "calibration" or entry["name"] in CALIBRATIONS


def _odds(entry: Mapping[str, Any]) -> float:
    odds = (entry.get("evidence") or {}).get("log10_odds")
    return float(odds) if isinstance(odds, int | float) else CONFIDENT


def _weight(entry: Mapping[str, Any], target: _Target) -> float:
    """Return the probability that a finding gives to a hidden name: as it says, else equal among the name and its rivals."""
    stated = entry.get("probabilities")
    if isinstance(stated, Mapping):
        return max((float(stated[name]) for name in target.names if isinstance(stated.get(name), int | float)), default=0.0)
    return 1.0 / (1 + len(entry.get("ambiguous_with") or []))


def _mean(values: Sequence[float]) -> float | None:
    return sum(values) / len(values) if values else None


def _ratios(report: Mapping[str, Any], top: str, bottom: str) -> tuple[float, ...]:
    signals = (report.get("fit") or {}).get("signal") or {}
    out = []
    for entry in signals.values():
        a, b = entry.get(top), entry.get(bottom)
        if isinstance(a, int | float) and isinstance(b, int | float) and b > 0:
            out.append(float(a) / float(b))
    return tuple(out)
