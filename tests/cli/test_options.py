"""Values of options: quantities in SI, choices and files with the nearest name, controllers."""

from __future__ import annotations

from pathlib import Path

import click
import pytest

from exo_sim.cli.options import Choice, ControllerName, InputFile, Quantity, RigFile, included_machines


def test_a_quantity_is_read_in_si_and_kept_within_its_bounds() -> None:
    mass = Quantity("kg", 0.0, 45.0)
    assert mass.convert("34 kg", None, None) == 34.0 and mass.convert("500 g", None, None) == pytest.approx(0.5)
    assert mass.convert(2.0, None, None) == 2.0
    for text, says in (("-1 kg", "too small"), ("46 kg", "too large"), ("3 m", "kg"), ("heavy", "heavy")):
        with pytest.raises(click.BadParameter, match=says):
            mass.convert(text, None, None)


def test_help_shows_the_unit_that_is_usual() -> None:
    parameter = click.Option(["--tank"])
    assert Quantity("m^3", usual="l").get_metavar(parameter) == '"NUMBER l"' and Quantity("kg").get_metavar(parameter) == '"NUMBER kg"'


def test_a_misspelt_word_is_answered_with_the_nearest() -> None:
    with pytest.raises(click.BadParameter, match='did you mean "vented"'):
        Choice(("on", "off", "vented")).convert("vneted", None, None)
    with pytest.raises(click.BadParameter, match='did you mean "model"'):
        ControllerName().convert("modle", None, None)
    assert ControllerName().convert("mine.py:Impedance", None, None) == "mine.py:Impedance"


def test_a_file_must_be_there_and_be_no_folder(tmp_path: Path) -> None:
    (tmp_path / "walk.csv").write_text("")
    assert InputFile().convert(str(tmp_path / "walk.csv"), None, None) == tmp_path / "walk.csv"
    with pytest.raises(click.BadParameter, match=r'did you mean "walk\.csv"'):
        InputFile().convert(str(tmp_path / "wlak.csv"), None, None)
    with pytest.raises(click.BadParameter, match="is a folder"):
        InputFile().convert(str(tmp_path), None, None)


def test_a_machine_that_comes_along_is_called_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert included_machines().keys() == {"bench", "exo", "exo_250_psi"}
    assert RigFile().convert("bench", None, None) == included_machines()["bench"]
    with pytest.raises(click.BadParameter, match='did you mean "bench"'):
        RigFile().convert("benhc", None, None)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bench").write_text("")
    assert RigFile().convert("bench", None, None) == Path("bench")  # a file of one's own comes first
