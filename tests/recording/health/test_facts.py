"""What a rig knows that sensors can be held against: atmosphere, supply where a valve lets it in, limits of joints."""

from __future__ import annotations

from pathlib import Path

import benches
import mujoco

from exo_sim.machine.rig_model import load
from exo_sim.recording.health import Facts
from exo_sim.rig import parse

LIMITED = '<mujoco><worldbody><body><joint name="slide" type="slide" range="0 0.1" limited="true"/><joint name="free" type="hinge"/>' \
    '<geom size="0.1"/></body></worldbody></mujoco>'  # fmt: skip


def test_a_supply_counts_only_where_a_valve_lets_it_in(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    assert Facts.of(rig, load(rig)).supply_pressure == 7e5
    shut = parse(rig.text.split("[cylinders.piston.valve]")[0], rig.path)
    assert Facts.of(shut, load(rig)).supply_pressure is None


def test_limits_are_those_of_limited_joints(tmp_path: Path) -> None:
    model = mujoco.MjModel.from_xml_string(LIMITED)
    assert Facts.of(benches.bench(tmp_path), model).joint_range == {"slide": (0.0, 0.1)}
