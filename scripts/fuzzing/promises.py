"""What the command promises whatever it is given; docs/reliability.md says it in words."""

from __future__ import annotations

import json
import re

from exo_sim.errors import LONGEST_LINE
from fuzzing.command import Outcome

STATUSES = (0, 2, 3, 4, 5)
#: Bytes that a small input may take of memory.
MOST_MEMORY = 1_500_000_000
_UNPRINTABLE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
#: What a search keeps of finished designs, to go on from there.
_KEPT = ".journal"
_LEFT_BEHIND = re.compile(r"\.partial|\.probe|\.former|\.lock$|MUJOCO_LOG|core\.\d+$")


def broken(outcome: Outcome, words: tuple[str, ...]) -> list[str]:
    """Return which promises were not kept, each as a few words; none where all were."""
    out: list[str] = []
    if outcome.escaped:
        return [f"escaped: {outcome.escaped}"]
    said = [line for line in outcome.err.split("\n") if line]
    last = said[-1] if said else ""
    if outcome.interrupted:
        if outcome.status != 130:
            out.append(f"interrupted after a minute, and ended with {outcome.status}")
    elif outcome.status not in STATUSES:
        out.append(f"status {outcome.status}: {last[:300]}")
    if "Traceback (most recent" in outcome.err or "Exception ignored" in outcome.err:
        out.append("a traceback")
    if outcome.below:
        out.append(f"past Python: {outcome.below[:300]}")
    if outcome.status in (2, 5):
        if not last.startswith("exo-sim: ") and "Usage:" not in outcome.err:
            out.append(f"no line that says what is wrong: {last[:300]}")
        if outcome.out:
            out.append("stdout is not empty though it failed")
    if any(len(line) > LONGEST_LINE + len("exo-sim: ") for line in said):
        out.append(f"a line of {max(map(len, said))} characters on stderr")
    for name, text in (("stdout", outcome.out), ("stderr", outcome.err)):
        if found := _UNPRINTABLE.search(text):
            out.append(f"U+{ord(found.group()):04X} on {name}")
    if outcome.status in (0, 3, 4) and "--json" in words and "--help" not in words and "-h" not in words:
        out += _not_json(outcome.out)
    out += _files(outcome)
    if outcome.grown > MOST_MEMORY:
        out.append(f"took {outcome.grown / 1e9:.1f} GB of memory")
    return out


def _not_json(text: str) -> list[str]:
    def refuse(word: str) -> None:
        raise ValueError(word)

    if not text:  # it went into the file of --out
        return []
    try:
        json.loads(text, parse_constant=refuse)
    except ValueError as error:
        return [f"stdout is no JSON: {error}"]
    return []


def _files(outcome: Outcome) -> list[str]:
    out = [f"changed its input {name}" for name, held in outcome.before.items() if outcome.files.get(name, b"") != held and _is_input(name)]
    new = [name for name in outcome.files if name not in outcome.before and "__pycache__" not in name]  # Python's own, of somebody's code
    out += [f"left {name} behind" for name in new if _LEFT_BEHIND.search(name)]
    if outcome.status == 2:
        results = [name for name in new if outcome.files[name] is not None and not name.endswith(_KEPT)]
        out += [f"failed, and wrote {name}" for name in results if not _LEFT_BEHIND.search(name)]
    for name in new:
        held = outcome.files[name]
        if held is not None and name.endswith(".json"):
            out += [f"{name}: {words}" for words in _not_json(held.decode("utf-8", "replace"))]
    return out


def _is_input(name: str) -> bool:
    """Return whether a verb never writes it: what a trial keeps grows with its verdicts."""
    return not name.startswith(("trial", "undone"))


_FOLDER = re.compile(r"/\S*/case/")
_QUOTED, _NUMBER = re.compile(r'"[^"]*"|\'[^\']*\'|\[[^\]]*\]'), re.compile(r"[-+]?\d[\d.e+-]*")


def kind_of(outcome: Outcome, words: tuple[str, ...]) -> str:
    """Return what is the same in outcomes of one kind: the verb, the status, and the last line without names and numbers."""
    last = next((line for line in reversed(outcome.err.split("\n")) if line), "")
    line = _NUMBER.sub("N", _QUOTED.sub("Q", _FOLDER.sub("", last)))
    return f"{words[0] if words else ''} {outcome.status} {line[:90]}".strip()
