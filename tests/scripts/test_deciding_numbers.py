"""The log of deciding numbers sees what each one enters and changes nothing that is computed with it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

#: In a process of its own: from then on every number of the process is logged.
ASKING = """
import json
import numpy as np
from answers.number_log import NumberLog, numbers
plain = {name: float(value) for name, value in numbers()}
log = NumberLog()
from exo_sim.diagnosis.policy.acceptance import CLEAN, LEAST_ODDS
from exo_sim.diagnosis.policy.recordings import FEWEST_ROWS
seen = []
for odds in (np.float64(1.0), 3.0):
    seen.append(bool(odds > LEAST_ODDS))
for rows in (10, 20):
    seen.append(rows < FEWEST_ROWS)
share = 0.5 * CLEAN
seen += [bool(np.float64(5.0) < share), max(1.0, share) == 1.0, (np.ones(2) * CLEAN).tolist(), list(range(FEWEST_ROWS))[-1]]
kept = all(float(value) == plain[name] for name, value in numbers())
compared = {name: [sum(column) for column in zip(*places.values())] for name, places in log.compared.items()}
print(json.dumps({"seen": seen, "kept": kept, "compared": compared, "used": sorted(log.used)}))
"""


def asked(repository: Path) -> dict[str, object]:
    paths = os.pathsep.join([str(repository), str(repository / "scripts")])
    done = subprocess.run(
        [sys.executable, "-c", ASKING], capture_output=True, text=True, check=True, env={**os.environ, "PYTHONPATH": paths}
    )
    return dict(json.loads(done.stdout))


def test_comparisons_are_counted_by_outcome_and_nothing_else_changes(repository: Path) -> None:
    found = asked(repository)
    assert found["seen"] == [False, True, True, True, False, True, [1.8, 1.8], 29] and found["kept"] is True
    assert found["compared"] == {"acceptance.LEAST_ODDS": [1, 1], "recordings.FEWEST_ROWS": [0, 2], "acceptance.CLEAN": [2, 0]}
    assert found["used"] == ["acceptance.CLEAN"]
