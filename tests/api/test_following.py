"""What is a motion, and what makes no sense for a machine that nobody wears."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from exo_sim.api.following import is_motion, nobody_walks
from exo_sim.api.rig import Rig
from exo_sim.errors import ScenarioError
from exo_sim.recording.table import Recording


def test_recordings_are_motions_and_scenarios_are_none() -> None:
    assert is_motion(Recording("r", np.arange(3.0), {}, {}))
    assert is_motion("motion.CSV") and is_motion(Path("motion.parquet"))
    assert not is_motion("level_walk") and not is_motion("scenario.toml") and not is_motion(None)


def test_how_somebody_walks_is_refused_where_nobody_does(repository: Path) -> None:
    rig = Rig.load(repository / "assets" / "bench.toml")
    nobody_walks(rig, speed=1.0, payload=None, demand="least_load")
    with pytest.raises(ScenarioError, match="--payload says how somebody walks, and nobody wears bench"):
        nobody_walks(rig, speed=1.0, payload="34 kg")
