from __future__ import annotations

from pathlib import Path

from exo_sim import errors


def test_a_misspelt_name_is_answered_with_the_nearest() -> None:
    assert errors.nearest("presure_1", ["pressure_1", "pressure_2", "force"]).startswith('; did you mean "pressure_1"')


def test_names_that_are_much_less_alike_are_not_suggested_beside_the_nearest() -> None:
    known = ["pressure_1", "pressure_2", "pressure_centre"]
    assert errors.nearest("presure_2", known) == '; did you mean "pressure_2" or "pressure_1"?'


def test_a_foreign_name_is_answered_with_all_there_are() -> None:
    assert errors.nearest("xyz", ["squat", "stand"]) == "; there is: squat, stand"
    assert errors.nearest("xyz", []) == ""


def test_every_error_has_the_status_of_the_contract() -> None:
    kinds = [kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, errors.ExoSimError)]
    assert {kind.exit_status for kind in kinds if kind is not errors.Diverged} == {2}
    assert errors.Diverged.exit_status == 5


def test_a_file_that_is_not_there_is_answered_with_its_neighbours(tmp_path: Path) -> None:
    (tmp_path / "bench.csv").write_text("")
    assert errors.misspelt(tmp_path / "bnch.csv") == '; did you mean "bench.csv"?'
    assert errors.misspelt(tmp_path / "quite_another.csv") == errors.misspelt(tmp_path / "nowhere" / "bench.csv") == ""
