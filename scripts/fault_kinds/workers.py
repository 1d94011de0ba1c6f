"""The same command with other numbers of workers: the same bytes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fault_kinds.child import run
from fault_kinds.commands import COMMANDS, lay_out
from fault_kinds.outcome import Outcome


def compare(folder: Path, bases: Path, names: list[str], numbers: tuple[int, ...]) -> Outcome:
    """Run commands that take `--jobs` with each number of workers and compare what they write."""
    outcome = Outcome("workers")
    for command in COMMANDS:
        if command.name not in names or "--jobs" not in command.words or not command.same:
            continue
        written: dict[int, list[bytes]] = {}
        for number in numbers:
            words = list(command.words)
            words[words.index("--jobs") + 1] = str(number)
            place = folder / f"{command.name}_{number}"
            lay_out(command, bases, place)
            ended = run(replace(command, words=tuple(words)).words, place, folder / "said")
            outcome.count(f"{command.name} --jobs {number}")
            if ended.status not in command.statuses:
                outcome.broken.append(f"{command.name} --jobs {number}: ended with {ended.status}: {ended.err[-300:]}")
                break
            written[number] = [(place / name).read_bytes() for name in command.same]
        if any(held != written[numbers[0]] for held in written.values()):
            outcome.broken.append(f"{command.name}: other bytes with other numbers of workers")
    return outcome
