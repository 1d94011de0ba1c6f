"""The pages of effects: `exo-sim effects`, and docs/effects.md kept up to date."""

import json
import runpy
from pathlib import Path

import pytest

from exo_sim.cli import main
from exo_sim.physics.declaration import declared
from exo_sim.rig import effect_page, parse

NAMES = sorted(declared())


def test_list_and_page(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects"]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed] == NAMES
    assert main(["effects", "wall_heat_transfer", "--json"]) == 0
    page = json.loads(capsys.readouterr().out)["effect"]
    assert page["question"] == declared()["wall_heat_transfer"].question
    assert main(["effects", "wall_heat_transfer"]) == 0
    assert "conductance" in capsys.readouterr().out


def test_misspelt_effect_offers_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "piston_leek"]) == 2
    assert 'did you mean "piston_leakage"' in capsys.readouterr().err
    assert main(["effects", "payload_mass"]) == 2
    assert "nominal number" in capsys.readouterr().err


@pytest.mark.parametrize("name", NAMES)
def test_example_is_a_rig_text(name: str, repository: Path) -> None:
    path = repository / "assets" / "bench.toml"
    rig = parse(path.read_text() + "\n" + effect_page.example(declared()[name]), path)
    assert name in {effect.name for effect in rig.effects}


def test_document_is_up_to_date(repository: Path) -> None:
    section = runpy.run_path(str(repository / "scripts" / "document_effects"), run_name="document_effects")["section"]
    text = (repository / "docs" / "effects.md").read_text(encoding="utf-8")
    for name, effect in declared().items():
        assert section(effect) in text, "run scripts/document_effects"
        assert (repository / "docs" / "pictures" / "effects" / f"{name}.png").is_file()


def test_a_list_says_how_many_numbers_it_holds() -> None:
    named = {row[0]: row for row in effect_page.rows(declared()["unknown"])}
    assert named["at"][3].startswith("2 to 16 numbers, ")
