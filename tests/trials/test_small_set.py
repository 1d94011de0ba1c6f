"""A small sealed set, made, diagnosed blind by the tool itself, opened and counted: the published run in little."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from exo_sim.trials import protocol
from exo_sim.trials.case_mix import draw_plans
from exo_sim.trials.score import score

CASES, SEED, SECONDS = 8, 20, 10.0


@pytest.mark.slow
def test_a_small_sealed_set(tmp_path: Path) -> None:
    folder, key = tmp_path / "trial", tmp_path / "trial.key"
    protocol.make(folder, draw_plans(CASES, SEED), key, duration=SECONDS, jobs=1, quiet=True)
    done = protocol.run(folder, f"{protocol.OWN_TOOL} --jobs 1", jobs=os.cpu_count() or 1, quiet=True)
    assert done["verdicts"] == CASES
    figures = score(folder, key, done["head"])["figures"]
    assert figures["answered"]["share"] == 1.0
    assert figures["false_alarms"]["of"] > 0 and figures["false_alarms"]["hits"] == 0
    assert figures["confidently_wrong"]["hits"] <= 1
    assert figures["exact_set_from_four_limits"]["share"] >= 0.75
    assert figures["parameters"]["relative_error"]["median"] < 0.05
