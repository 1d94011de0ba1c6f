"""`exo-sim effects`: every declared effect in the list, one page each, and the nearest name."""

from __future__ import annotations

import json

import pytest

from exo_sim.cli import main
from exo_sim.physics.declaration import declared


def test_the_list_has_every_effect_and_a_page_has_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "--json"]) == 0
    assert [one["name"] for one in json.loads(capsys.readouterr().out)["effects"]] == list(declared())
    assert main(["effects", "valve_lag"]) == 0
    assert "time_constant" in capsys.readouterr().out


@pytest.mark.parametrize(("name", "says"), [("valve_lga", 'did you mean "valve_lag"'), ("payload_mass", "is a nominal number")])
def test_what_is_no_effect_is_one_line(capsys: pytest.CaptureFixture[str], name: str, says: str) -> None:
    assert main(["effects", name]) == 2
    assert says in capsys.readouterr().err
