"""The scenarios that come along, by name."""

from __future__ import annotations

from pathlib import Path

import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait import included_scenarios, scenario
from exo_sim.gait.scenario_record import Scenario


def test_a_name_finds_its_scenario_and_a_misspelt_one_the_nearest() -> None:
    assert "level_walk" in included_scenarios.names()
    assert isinstance(included_scenarios.included("level_walk"), Scenario)
    assert scenario.find("level_walk") is included_scenarios.included("level_walk")
    with pytest.raises(ScenarioError, match='did you mean "level_walk"'):
        included_scenarios.included("level_wlak")


def test_a_file_is_none_of_them(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text('like = "stand"\n')
    assert scenario.find(str(tmp_path / "own.toml")).cycle == included_scenarios.included("stand").cycle
    with pytest.raises(ScenarioError):
        included_scenarios.included(str(tmp_path / "own.toml"))
