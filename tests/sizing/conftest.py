"""One machine and one condition that the sizing tests share."""

import pytest

from exo_sim import rig as rigs
from exo_sim.sizing.evaluation import Task, evaluator
from exo_sim.sizing.loads import Condition, joint_loads
from exo_sim.sizing.study import space_of


@pytest.fixture(scope="session")
def exo(repository):
    return rigs.read(repository / "assets" / "exo_250_psi.toml")


@pytest.fixture(scope="session")
def condition():
    return Condition("level_walk", 34.0)


@pytest.fixture(scope="session")
def loads(exo, condition):
    return joint_loads(exo, condition)


@pytest.fixture(scope="session")
def space(exo):
    return space_of(exo, 0.04, None)


@pytest.fixture(scope="session")
def task(exo, condition, space):
    return Task(exo, (condition,), space)


@pytest.fixture(scope="session")
def judge(task):
    return evaluator(task)
