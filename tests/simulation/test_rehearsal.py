"""What a rehearsal shows: of the machine's heels and toes, and of what the straps ask of the wearer."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import mujoco
import numpy as np
import pytest
from simulation.walked import simulate

from exo_sim import rig as rigs
from exo_sim.control.least_load import LeastLoad
from exo_sim.control.rehearsed import Rehearsed
from exo_sim.simulation import rehearsal
from exo_sim.simulation.rehearsal import Rehearsals, carrying, counted, cycle_mean
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.wearer_load import own, with_machine

FEET = """<mujoco><worldbody>{}</worldbody></mujoco>"""
FOOT = """<body name="foot_{0}"><geom name="heel_{0}" size="0.02" pos="-0.05 0 0"/><geom name="toe_{0}" size="0.02" pos="0.15 0 0"/>
<site name="foot_{0}" pos="0.05 0 0"/></body>"""


def test_heel_and_toe_carry_by_where_the_ground_pushes() -> None:
    model = mujoco.MjModel.from_xml_string(FEET.format(FOOT.format("l") + FOOT.format("r")))
    columns = {
        "foot_l.ground_force_z": np.array([200.0, 200.0, 200.0, 30.0]), "foot_l.pressure_centre": np.array([-0.1, 0.0, 0.1, 0.0]),
        "foot_r.ground_force_z": np.array([0.0, 200.0, 200.0, 60.0]), "foot_r.pressure_centre": np.array([0.0, 0.12, 0.09, 0.05]),
    }  # fmt: skip
    walk = cast(Walk, cast(Any, SimpleNamespace(model=model, columns=columns)))
    np.testing.assert_array_equal(carrying(walk), [[1, 0, 0, 0], [1, 1, 0, 1], [0, 1, 0, 1], [0, 0, 0, 1]])


class Pupil:
    """Keeps what it is taught."""

    def __init__(self) -> None:
        self.taught: list[Rehearsed] = []
        self.cost = 0.0
        self.driven = [0, 1, 3, 4]

    def learn(self, seen: Rehearsed) -> float:
        self.taught.append(seen)
        return self.cost


def test_the_own_body_is_worked_out_once_and_only_for_the_rows_that_count(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    exo = rigs.read(repository / "assets" / "exo_250_psi.toml")
    walk = simulate(exo, Request("level_walk", law="inverse_dynamics", payload=10.0, cycles=3))
    rows: list[int] = []

    def counting(part: Walk) -> Any:
        rows.append(len(part.time))
        return own(part)

    monkeypatch.setattr(rehearsal, "own", counting)
    pupil = Pupil()
    rehearsals = Rehearsals(cast(LeastLoad, pupil), 1)
    rehearsals.learn_from(walk)
    rehearsals.learn_from(walk)
    seen = counted(walk, 1)
    assert rows == [seen.stop - seen.start]
    whole = cycle_mean(walk, with_machine(walk).moments - own(walk).moments, 1)
    held = with_machine(walk).ground
    left = [cycle_mean(walk, each, 1) for each in (held.residual[:, 2], held.outside.astype(float))]
    for one in pupil.taught:
        np.testing.assert_array_equal(one.moments, whole)
        assert len(one.straps) == len(one.contacts) == len(one.moments)
        assert one.response is not None
        for shown, known in zip((one.residual, one.at_edge), left):
            np.testing.assert_array_equal(shown, known)


def test_rows_that_count_are_whole_cycles() -> None:
    walk = cast(Walk, cast(Any, SimpleNamespace(time=np.arange(0.0, 4.3, 0.25), motion=SimpleNamespace(period=1.0))))
    assert counted(walk, 2) == slice(8, 16)
    assert counted(walk, 0) == slice(0, 16)


@pytest.mark.parametrize(
    ("costs", "settled_at"),
    [
        ((100.0, 50.0, *[49.9] * 12), 14),
        ((100.0, 50.0, *[90.0] * 8, 40.0, *[41.0] * 12), 23),  # steps that failed are shortened: one of them gained something
    ],
)
def test_rehearsals_are_settled_once_twelve_of_them_bettered_little(
    repository: Path, costs: tuple[float, ...], settled_at: int
) -> None:
    exo = rigs.read(repository / "assets" / "exo_250_psi.toml")
    walk = simulate(exo, Request("level_walk", law="inverse_dynamics", payload=10.0, cycles=3))
    pupil = Pupil()
    rehearsals, settled = Rehearsals(cast(LeastLoad, pupil), 1), []
    for cost in costs:
        pupil.cost = cost
        rehearsals.learn_from(walk)
        settled.append(rehearsals.settled)
    assert settled == [count >= settled_at for count in range(1, len(costs) + 1)]
