import pytest

from exo_sim import rig as rigs
from exo_sim.control import user_controller


@pytest.fixture(scope="module")
def context(repository):
    """Return what a controller of the machine that comes along is given."""
    rig = rigs.read(repository / "exo_sim" / "assets" / "exo_250_psi.toml")
    joints = tuple(f"{joint}_{side}" for side in "lr" for joint in ("hip", "knee", "ankle"))
    return user_controller.Context(rig, tuple(rig.cylinders), joints, (), 0.002, 0.001, 1.0)
