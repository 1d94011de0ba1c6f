"""`exo-sim scenarios`: every scenario with its sentence."""

from __future__ import annotations

import json

import pytest

from exo_sim.cli import main
from exo_sim.gait import scenario


def test_the_list_has_every_scenario(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenarios", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)["scenarios"]
    assert [one["name"] for one in listed] == list(scenario.names()) and all(one["summary"] for one in listed)
    assert main(["scenarios"]) == 0
    assert "level_walk" in capsys.readouterr().out
