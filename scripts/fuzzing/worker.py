"""One process of a campaign: draws cases, runs them, shrinks what breaks a promise, and keeps count in a file."""

from __future__ import annotations

import json
import os
import random
import shutil
import sys
import time
from collections import Counter, defaultdict
from pathlib import Path

import hypothesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis.strategies import SearchStrategy

from exo_sim.cli import main
from fuzzing import machine, promises
from fuzzing.case import Case
from fuzzing.command import Outcome, run

#: Cases drawn in a row of one target.
ROW = 40
#: Exit status of a worker whose command was interrupted: as a user's process would be, it is gone, and another takes its place.
AFRESH = 75


class Broken(AssertionError):
    """A promise was not kept."""


class Worker:
    """What one process has tried so far.

    Args:
        folder: Of this worker: the case at hand, the counts, and the folders that cases are run in.
        bases: The bases, see `fuzzing.bases`.
        until: When to stop, on the wall's clock [s].
    """

    def __init__(self, folder: Path, bases: Path, until: float) -> None:
        self.folder, self.bases, self.until = folder, bases, until
        folder.mkdir(parents=True, exist_ok=True)
        self.cases: Counter[str] = Counter()
        self.statuses: Counter[str] = Counter()
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self.kinds: dict[str, str] = {}
        self.found: dict[str, str] = {}
        self.slowest = (0.0, "")
        self.failing: tuple[str, str] | None = None

    def attempt(self, target: str, case: Case) -> None:
        """Run one case.

        Raises:
            Broken: it broke a promise in a way not seen before.
        """
        if time.time() > self.until and self.failing is None:
            return
        line = case.line()
        (self.folder / "at_work").write_text(line)
        place = self.folder / "case"
        shutil.rmtree(place, ignore_errors=True)
        begun = time.monotonic()
        case.lay_out(self.bases, place)
        outcome = run(case.words, place, machine.drive if case.words[:1] == ("machine",) else main)
        self._count(target, line, case, outcome, time.monotonic() - begun)
        if wrong := promises.broken(outcome, case.words):
            signature = promises.kind_of(Outcome(err=wrong[0], status=outcome.status), case.words)
            if signature not in self.found:
                self.failing = signature, json.dumps({**json.loads(line), "broke": "; ".join(wrong), "said": outcome.err[-1500:]})
                if not outcome.interrupted:
                    raise Broken(signature)
        if outcome.interrupted:
            if self.failing is not None:
                self.found[self.failing[0]] = self.failing[1]
            self.write()
            os._exit(AFRESH)

    def _count(self, target: str, line: str, case: Case, outcome: Outcome, seconds: float) -> None:
        self.cases[target] += 1
        self.seconds[target] += seconds
        self.statuses[str(outcome.status)] += 1
        kind = promises.kind_of(outcome, case.words)
        if kind not in self.kinds or len(line) < len(self.kinds[kind]):
            self.kinds[kind] = line
        self.slowest = max(self.slowest, (outcome.seconds, line))

    def row(self, target: str, cases: SearchStrategy[Case], number: int, shrink: bool) -> None:
        """Draw and try a row of cases; what breaks a promise is made small and kept."""

        @hypothesis.seed(number)
        @settings(
            max_examples=ROW, database=None, deadline=None, print_blob=False, suppress_health_check=list(HealthCheck),
            phases=[Phase.generate, Phase.shrink] if shrink else [Phase.generate], report_multiple_bugs=False,
        )  # fmt: skip
        @given(cases)
        def attempted(case: Case) -> None:
            self.attempt(target, case)

        self.failing = None
        try:
            attempted()
        except Exception as error:
            if self.failing is None:
                raise
            signature, line = self.failing
            if not isinstance(error, Broken):
                line = json.dumps({**json.loads(line), "again": "not each time"})
            self.found[signature] = line
        self.failing = None
        self.write()

    def write(self) -> None:
        """Write the counts."""
        held = {
            "cases": self.cases, "seconds": self.seconds, "statuses": self.statuses, "kinds": self.kinds, "found": self.found,
            "slowest": self.slowest,
        }  # fmt: skip
        beside = self.folder / "counts.new"
        beside.write_text(json.dumps(held))
        beside.replace(self.folder / "counts.json")


def work(folder: Path, bases: Path, seconds: float, seed: int, names: list[str], corpus: list[Case], shrink: bool) -> None:
    """Try the corpus, then draw cases until the time is over."""
    from fuzzing.targets import TARGETS

    os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = str(folder / "hypothesis")
    worker = Worker(folder, bases, time.time() + seconds)
    for case in corpus:
        try:
            worker.attempt("corpus", case)
        except Broken:
            assert worker.failing is not None
            worker.found[worker.failing[0]] = worker.failing[1]
            worker.failing = None
        worker.write()
    draw = random.Random(seed)
    while time.time() < worker.until:  # whichever has had the least of its share is next
        target = min(names, key=lambda name: worker.seconds[name] / TARGETS[name][1])
        worker.row(target, TARGETS[target][0], draw.getrandbits(32), shrink)


if __name__ == "__main__":
    asked = json.loads(sys.argv[1])
    work(
        Path(asked["folder"]), Path(asked["bases"]), asked["seconds"], asked["seed"], asked["targets"],
        [Case.read(line) for line in asked["corpus"]], asked["shrink"],
    )  # fmt: skip
