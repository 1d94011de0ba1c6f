"""`exo.size(motion=...)`: a bench is sized along a motion in memory, and what comes back can be run."""

import numpy as np
import pytest

import exo_sim as exo
from exo_sim.errors import ScenarioError
from exo_sim.recording.table import Recording

TIME = np.arange(0.0, 1.0, 0.01)
MOTION = Recording(
    "motion", TIME, {"slide.position": 0.08 + 0.02 * np.sin(2 * np.pi * TIME), "slide.external_force": np.full(len(TIME), -100.0)},
    {"slide.position": "m", "slide.external_force": "N"},
)  # fmt: skip


def test_a_bench_is_sized_along_a_motion(repository, tmp_path):
    found = exo.size(repository / "assets" / "bench.toml", motion=MOTION, trials=3, fix={"supply": "7 bar"}, out=tmp_path / "sized")
    assert found.summary["evaluated"] == 3
    assert found.chosen.supply.pressure == 7e5
    assert all(one["torque_margin"] > 0.0 for one in found.front)
    assert (tmp_path / "sized" / "sized.toml").is_file()
    assert exo.Rig.load(found.save(tmp_path / "again") / "sized.toml").cylinders["piston"].bore == found.chosen.cylinders["piston"].bore
    assert "gas" in str(found)


def test_a_number_that_is_not_there_is_refused(repository):
    with pytest.raises(ScenarioError, match=r"--fix hip\.bore: there is no such number"):
        exo.size(repository / "assets" / "bench.toml", motion=MOTION, trials=1, fix={"hip.bore": "40 mm"})
