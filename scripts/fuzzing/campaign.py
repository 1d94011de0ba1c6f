"""Several workers for a time: started, watched, started again where one dies or hangs, and their counts put together."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fuzzing import bases
from fuzzing.command import LONGEST
from fuzzing.worker import AFRESH

#: Seconds behind the last case's start after which a worker that cannot even be interrupted is ended.
GIVEN_UP = LONGEST + 120.0
SCRIPTS = Path(__file__).resolve().parents[1]


@dataclass
class Campaign:
    """What came of it.

    Attributes:
        cases: How many were run, by target; "corpus" are those kept from before.
        statuses: How often each exit status came.
        kinds: The shortest case of each kind of outcome.
        found: The smallest case of each broken promise, as lines of JSON.
        slowest: Seconds and case.
        seconds: How long it took.
    """

    cases: Counter[str] = field(default_factory=Counter)
    statuses: Counter[str] = field(default_factory=Counter)
    kinds: dict[str, str] = field(default_factory=dict)
    found: dict[str, str] = field(default_factory=dict)
    slowest: tuple[float, str] = (0.0, "")
    seconds: float = 0.0

    def add(self, held: dict[str, Any]) -> None:
        """Add one worker's counts."""
        self.cases.update(held["cases"])
        self.statuses.update(held["statuses"])
        for kind, line in held["kinds"].items():
            if kind not in self.kinds or len(line) < len(self.kinds[kind]):
                self.kinds[kind] = line
        self.found |= held["found"]
        self.slowest = max(self.slowest, (held["slowest"][0], held["slowest"][1]))


class _Process:
    """A worker that is started again with what is left of the time where it dies."""

    def __init__(self, folder: Path, asked: dict[str, Any], until: float) -> None:
        self.folder, self.asked, self.until, self.starts, self.tried = folder, asked, until, 0, 0
        self.start()

    def start(self) -> None:
        """Start it, in a session of its own so that all that it starts can be ended with it."""
        self.place = self.folder / str(self.starts)
        asked = self.asked | {
            "folder": str(self.place), "seconds": self.until - time.time(), "seed": self.asked["seed"] + 1000 * self.starts,
            "corpus": self.asked["corpus"][self.tried :],
        }  # fmt: skip
        self.starts += 1
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(SCRIPTS), str(SCRIPTS.parent)])}
        environment.pop("DISPLAY", None)
        self.place.mkdir(parents=True)
        with (self.place / "said").open("w") as said:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "fuzzing.worker", json.dumps(asked)], stdin=subprocess.DEVNULL, stdout=said, stderr=said,
                env=environment, start_new_session=True, cwd=self.place,
            )  # fmt: skip

    def watch(self, campaign: Campaign) -> bool:
        """Look after it; return whether it is still at work."""
        at_work = self.place / "at_work"
        if self.process.poll() is None:
            if not at_work.exists() or time.time() - at_work.stat().st_mtime < GIVEN_UP:
                return True
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
            ended = "could not be interrupted"
        elif self.process.returncode in (0, AFRESH):
            self.gather(campaign)
            return self.process.returncode == AFRESH and self.start_again()
        else:
            ended = f"the process ended with {self.process.returncode}: {(self.place / 'said').read_text()[-500:]}"
        self.gather(campaign)
        self.tried += 1  # the one that ended it is not tried again
        line = at_work.read_text() if at_work.exists() else '{"base": "", "words": [], "edits": []}'
        campaign.found[f"{ended} {line[:80]}"] = json.dumps({**json.loads(line), "broke": ended})
        return self.start_again()

    def start_again(self) -> bool:
        """Start once more where time is left; return whether it was."""
        if time.time() < self.until and self.starts < 100:
            self.start()
            return True
        return False

    def gather(self, campaign: Campaign) -> None:
        """Add what it counted."""
        if (counts := self.place / "counts.json").exists():
            held = json.loads(counts.read_text())
            self.tried += held["cases"].get("corpus", 0)
            campaign.add(held)


def run(folder: Path, seconds: float, workers: int, seed: int, targets: list[str], corpus: list[str], shrink: bool = True) -> Campaign:
    """Fuzz for some seconds.

    Args:
        folder: For all that comes up; bases made before are used again.
        seconds: How long, behind the making of the bases.
        workers: Processes.
        seed: Where chance starts.
        targets: Names in `fuzzing.targets.TARGETS`.
        corpus: Cases as lines of JSON that are tried first.
        shrink: Make what breaks a promise small before it is reported.
    """
    if not (folder / "bases").exists():
        bases.make(folder / "bases")
    begun = time.time()
    campaign = Campaign()
    processes = []
    try:
        for number in range(workers):
            asked = {
                "bases": str(folder / "bases"), "seed": seed + 7919 * number, "targets": targets, "corpus": corpus[number::workers],
                "shrink": shrink,
            }  # fmt: skip
            processes.append(_Process(folder / f"worker_{number}", asked, begun + seconds))
        at_work = list(processes)
        while at_work:
            time.sleep(0.2)
            at_work = [process for process in at_work if process.watch(campaign)]
    finally:
        for process in processes:
            if process.process.poll() is None:
                os.killpg(process.process.pid, signal.SIGKILL)
                process.process.wait()
    campaign.seconds = time.time() - begun
    return campaign
