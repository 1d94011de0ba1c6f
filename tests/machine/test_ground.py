"""Slopes and stairs as geoms: as high as they say, and what the contact sensors of the feet mean."""

import mujoco
import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.machine.ground import LEVEL, Ground
from exo_sim.machine.mjcf import read_spec


def height_of(model, x):
    """Return how high the ground of a model is at a place, by a ray from above."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    geom = np.zeros(1, dtype=np.int32)
    groups = np.array([1, 0, 0, 0, 0, 0], dtype=np.uint8)
    far = mujoco.mj_ray(model, data, np.array([x, 0.9, 5.0]), np.array([0.0, 0.0, -1.0]), groups, 1, -1, geom)
    return 5.0 - far


@pytest.mark.parametrize("ground", [LEVEL, Ground(0.1), Ground(-0.08), Ground(0.17 / 0.29, 0.29, -0.07), Ground(-0.5, 0.3, 0.05)])
def test_the_model_is_as_high_as_the_ground_says(repository, ground):
    spec = read_spec(repository / "assets" / "exo.xml")
    ground.lay(spec, 2.0)
    model = spec.compile()
    for x in (-0.2, 0.0, 0.31, 1.4):
        assert height_of(model, x) == pytest.approx(ground.height(x), abs=1e-6)


def test_ground_that_nobody_walks_is_refused(repository):
    with pytest.raises(ScenarioError, match="stairs instead"):
        Ground(0.5)
    with pytest.raises(ScenarioError, match="which a foot fits"):
        Ground(0.5, 0.1)
    with pytest.raises(ScenarioError, match="fewer strides"):
        Ground(0.5, 0.3).lay(read_spec(repository / "assets" / "exo.xml"), 500.0)
