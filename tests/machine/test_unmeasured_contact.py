"""Which parts of a machine stand on the ground without a force that is known."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

from exo_sim.machine.unmeasured_contact import without_ground_force


@pytest.mark.parametrize(("sites", "lacking"), [((), "foot_l"), (("foot_l",), "foot_r"), (("foot_l", "foot_r"), "")])
def test_each_foot_of_the_worn_machine_counts(repository: Path, sites: tuple[str, ...], lacking: str) -> None:
    model = mujoco.MjModel.from_xml_path(str(repository / "assets" / "exo.xml"))
    assert without_ground_force(model, [model.site(name).id for name in sites]) == lacking


def test_what_is_bolted_down_need_not_stand(repository: Path) -> None:
    text = (repository / "assets" / "bench.xml").read_text().replace('<geom contype="0" conaffinity="0" mass="0"/>', '<geom mass="0"/>')
    assert without_ground_force(mujoco.MjModel.from_xml_string(text), []) == ""
