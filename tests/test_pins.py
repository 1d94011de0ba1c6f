from __future__ import annotations

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name


def pins(repository: Path) -> dict[str, str]:
    lines = (repository / "requirements.lock").read_text().splitlines()
    return dict(line.split("==") for line in lines if not line.startswith("#"))


def test_dm_control_steps_with_the_pinned_mujoco() -> None:
    from dm_control import mujoco

    physics = mujoco.Physics.from_xml_string(
        "<mujoco><option timestep='0.01'/><worldbody><body><freejoint/><geom size='0.1'/></body></worldbody></mujoco>"
    )
    physics.step(10)
    # semi-implicit Euler falls g h^2 (1 + ... + 10)
    assert abs(physics.data.qpos[2] + 9.81 * 0.01**2 * 55) < 1e-12


def test_pins_are_names_and_versions_only(repository: Path) -> None:
    lines = (repository / "requirements.lock").read_text().splitlines()
    assert all(re.fullmatch(r"[a-z0-9-]+==[0-9][0-9a-z.]*", line) for line in lines if not line.startswith("#"))


def test_pins_meet_what_the_package_asks_for(repository: Path) -> None:
    table = tomllib.loads((repository / "pyproject.toml").read_text())
    extras = table["project"]["optional-dependencies"]
    pinned = pins(repository)
    for text in [*table["project"]["dependencies"], *extras["test"], *extras["check"]]:
        requirement = Requirement(text)
        assert pinned[canonicalize_name(requirement.name)] in requirement.specifier, text
