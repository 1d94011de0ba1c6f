"""Why the forces at a joint are not judged."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from exo_sim.diagnosis.subsystems.motion.unjudged_balance import bound_by_model, not_recorded, rarely_free, rarely_known
from exo_sim.machine.linkage import Linkage, linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig, read

TIME = np.linspace(0.0, 10.0, 101)


@pytest.fixture
def bench(repository: Path) -> Rig:
    return read(repository / "assets" / "bench.toml")


@pytest.fixture
def links(bench: Rig) -> tuple[Linkage, ...]:
    return linkages(bench, load(bench))


def recorded(*columns: str) -> Recording:
    return Recording("r", TIME, {column: np.zeros(TIME.size) for column in columns}, {column: "1" for column in columns})


BOTH = ("piston.pressure_1", "piston.pressure_2")


@pytest.mark.parametrize(
    ("columns", "why"),
    [
        ((*BOTH, "piston.valve_command"), ""),
        (("piston.force",), ""),
        (("piston.pressure_1", "piston.valve_command"), "piston.pressure_2 was not recorded"),
        (BOTH, "nothing that was recorded drives piston"),
    ],
)
def test_what_drives_a_joint_must_have_been_recorded(
    bench: Rig, links: tuple[Linkage, ...], columns: tuple[str, ...], why: str
) -> None:
    said = not_recorded(recorded(*columns), bench, links, external=False, fed=())
    assert said.startswith(why) and bool(said) == bool(why)


def test_pressures_alone_do_where_a_force_from_outside_or_its_supply_was_recorded(bench: Rig, links: tuple[Linkage, ...]) -> None:
    assert not not_recorded(recorded(*BOTH), bench, links, external=True, fed=())
    assert not not_recorded(recorded(*BOTH), bench, links, external=False, fed=("piston",))


@pytest.mark.parametrize("judge", [rarely_known, rarely_free])
def test_a_joint_is_judged_where_enough_of_its_time_is(judge: object) -> None:
    assert callable(judge)
    assert judge(TIME, np.ones(TIME.size, dtype=bool)) is None
    assert judge(TIME, np.arange(TIME.size) < 1) is not None


def test_a_short_recording_is_not_asked_where_a_foot_is() -> None:
    short = rarely_known(0.001 * TIME, np.ones(TIME.size, dtype=bool))
    assert short is not None and "0.01 s" in short.why and "foot" not in short.why + short.do and "missing" not in short.do
    standing = rarely_known(TIME, np.arange(TIME.size) < 1)
    assert standing is not None and "ground" in standing.why and "<foot>.pressure_centre" in standing.do


def test_an_equality_of_the_model_pushes_unseen() -> None:
    joints = '<body><joint name="a" type="hinge"/><geom size="0.1"/><body><joint name="b" type="hinge"/><geom size="0.1"/></body></body>'
    held = '<equality><joint name="link" joint1="a" joint2="b"/></equality>'
    free = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{joints}</worldbody></mujoco>")
    bound = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{joints}</worldbody>{held}</mujoco>")
    assert bound_by_model(free) == "" and '"link"' in bound_by_model(bound)
