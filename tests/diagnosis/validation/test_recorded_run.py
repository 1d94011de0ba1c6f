"""One recording run by one rig."""

from __future__ import annotations

import math

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.validation.recorded_run import Machine, run_of
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("recorded"))


def test_nothing_is_run_of_a_recording_without_anything_to_predict(rig: Rig) -> None:
    time = np.arange(0.0, 1.0, 1e-3)
    empty = Recording("empty", time, {"supply.pressure": np.full(len(time), 7e5)}, {"supply.pressure": "Pa"})
    assert run_of(empty, Machine(rig), "auto", math.inf, {}) is None
