"""Commands that are killed, or interrupted, at any moment: nothing half-written, and the same command again ends well."""

from __future__ import annotations

import random
import shutil
import signal
import sys
from pathlib import Path

from fault_kinds.child import run
from fault_kinds.commands import COMMANDS, Command, half_written, lay_out, left_behind
from fault_kinds.outcome import Outcome

#: Kills in one folder before the command may end in it.
IN_A_ROW = 5


def kill(folder: Path, bases: Path, kills: int, seed: int, names: list[str]) -> Outcome:
    """Kill every command some times, spread over the time that it takes."""
    outcome, draw = Outcome("kills"), random.Random(seed)
    chosen = [command for command in COMMANDS if command.name in names]
    for command in chosen:
        _kill(command, folder / command.name, bases, -(-kills // len(chosen)), draw, outcome)
        print(f"{sum(outcome.counts.values())} of {kills} kills, {len(outcome.broken)} broken promises", file=sys.stderr, flush=True)
    return outcome


def _kill(command: Command, folder: Path, bases: Path, kills: int, draw: random.Random, outcome: Outcome) -> None:
    lay_out(command, bases, folder / "undisturbed")
    run(command.words, folder / "undisturbed", folder / "said")  # fills the cache of compiled code
    shutil.rmtree(folder / "undisturbed")
    lay_out(command, bases, folder / "undisturbed")
    whole = run(command.words, folder / "undisturbed", folder / "said")
    if whole.status not in command.statuses:
        outcome.broken.append(f"{command.name}: ends with {whole.status} undisturbed: {whole.err[-300:]}")
        return
    done = 0
    while done < kills:
        place = folder / str(done)
        lay_out(command, bases, place)
        before = {str(path.relative_to(place)) for path in place.rglob("*")}
        for _ in range(min(IN_A_ROW, kills - done)):
            by = draw.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
            ended = run(command.words, place, folder / "said", draw.uniform(0.0, 1.05) * whole.seconds, by)
            outcome.count(f"{command.name} {signal.Signals(by).name}")
            outcome.broken += half_written(command, place)
            if by == signal.SIGINT and ended.status not in (130, -signal.SIGINT, *command.statuses, 2):
                outcome.broken.append(f"{command.name}: interrupted, ended with {ended.status}: {ended.err[-300:]}")
            if by == signal.SIGINT and "Traceback" in ended.err:
                outcome.broken.append(f"{command.name}: interrupted, and a traceback: {ended.err[-600:]}")
            done += 1
        if command.name != "make" and command.name != "score":  # a trial is made, and its key used, once
            again = run(command.words, place, folder / "said")
            if again.status != whole.status:
                outcome.broken.append(f"{command.name}: after kills it ends with {again.status}: {again.err[-300:]}")
            outcome.broken += half_written(command, place)
            outcome.broken += [f"{command.name}: left {name} behind" for name in left_behind(command, place, before)]
            for name in command.same:
                if not (place / name).exists() or (place / name).read_bytes() != (folder / "undisturbed" / name).read_bytes():
                    outcome.broken.append(f"{command.name}: {name} has other bytes after kills")
        shutil.rmtree(place)
