"""A column of a joint in a unit of the other kind is refused, and never taken for a slip in a unit of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim import conventions
from exo_sim.errors import RecordingError
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> tuple[Rig, Recording]:
    rig = benches.bench(tmp_path_factory.mktemp("units"))
    return rig, benches.led(rig, 3.0)


def test_lengths_of_a_joint_that_slides_pass(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    assert not [check for check in conventions.asked(recording, rig, load(rig)).checks if check.what == "unit"]


def test_an_angle_of_a_joint_that_slides_is_refused(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    in_degrees = replace(
        recording,
        columns=dict(recording.columns) | {"slide.position": recording["slide.position"] / 57.29577951308232},
        units=dict(recording.units) | {"slide.position": "rad"},
    )
    with pytest.raises(RecordingError, match=r'"slide.position" is in a unit of "rad".*slides: write.*"slide.position \[m\]"'):
        conventions.settle(in_degrees, rig, load(rig))


def test_a_length_of_a_joint_that_turns_is_refused(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path, cylinder=False)
    (tmp_path / "bench.xml").write_text((tmp_path / "bench.xml").read_text().replace('type="slide"', 'type="hinge"'))
    time = np.arange(500, dtype=np.float64) * 1e-2
    swing = Recording("swing", time, {"slide.position": np.asarray(0.3 * np.sin(time), dtype=np.float64)}, {"slide.position": "m"})
    (check,) = conventions.asked(swing, rig, load(rig)).checks
    assert check.refused and "turns" in check.says and '"slide.position [rad]"' in check.says
