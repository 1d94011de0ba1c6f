"""What a tool answered, reduced to what the contract says of it: whatever a rival writes, the others can still be scored."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from exo_sim.errors import printable
from exo_sim.trials.json_file import read_json

_LONGEST = 200
_MOST = 10_000
_LARGEST = 1e100


def read_answer(path: Path) -> dict[str, Any] | None:
    """Return the content of a diagnosis.json as `tidied`; None where it is no JSON."""
    try:
        return tidied(read_json(path))
    except (OSError, ValueError):
        return None


def tidied(answer: Any) -> dict[str, Any] | None:
    """Return what an answer says in the types of the contract; what is of another type is as if it were not there.

    Texts are printable and short, numbers finite. None where it is no object, or `effects` is no list: then it is no answer.
    """
    if not isinstance(answer, Mapping) or not isinstance(answer.get("effects"), list):
        return None
    fit = _mapping(answer.get("fit"))
    return {
        "verdict": _text(answer.get("verdict")),
        "effects": [_effect(entry) for entry in _list(answer["effects"]) if isinstance(entry, Mapping) and _text(entry.get("name"))],
        "located": [
            {"where": _text(entry.get("where")), "equation": _text(entry.get("equation"))}
            for entry in _list(answer.get("located"))
            if isinstance(entry, Mapping)
        ],
        "fit": {
            "signal": {_text(key): _numbers(entry) for key, entry in _mapping(fit.get("signal")).items()},
            "held_out": _spans(fit.get("held_out")),
            "held_out_by_recording": {_text(name): _spans(spans) for name, spans in _mapping(fit.get("held_out_by_recording")).items()},
        },
    }


def _spans(value: Any) -> list[Any]:
    """Return the spans of time in a list, pairs of numbers."""
    return [pair for pair in _list(value) if isinstance(pair, list) and all(_number(end) is not None for end in pair)]


def _effect(entry: Mapping[Any, Any]) -> dict[str, Any]:
    rivals = [_text(rival.get("name") if isinstance(rival, Mapping) else rival) for rival in _list(entry.get("ambiguous_with"))]
    known: dict[str, Any] = {
        "name": _text(entry["name"]),
        "where": _text(entry.get("where")),
        "kind": _text(entry.get("kind")),
        "parameters": {_text(key): _numbers(value) for key, value in _mapping(entry.get("parameters")).items()},
        "evidence": _numbers(entry.get("evidence")),
        "ambiguous_with": [rival for rival in rivals if rival],
    }
    if (probability := _number(entry.get("probability"))) is not None:
        known["probability"] = probability
    if isinstance(stated := entry.get("probabilities"), Mapping):
        known["probabilities"] = _numbers(stated)
    return known


def _numbers(value: Any) -> dict[str, float]:
    """Return the finite numbers of an object."""
    numbers = {_text(key): _number(number) for key, number in _mapping(value).items()}
    return {key: number for key, number in numbers.items() if number is not None}


def _number(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) and abs(number) < _LARGEST else None


def _text(value: Any) -> str:
    return printable(value[:_LONGEST]) if isinstance(value, str) else ""


def _list(value: Any) -> list[Any]:
    return value[:_MOST] if isinstance(value, list) else []


def _mapping(value: Any) -> Mapping[Any, Any]:
    return value if isinstance(value, Mapping) else {}
