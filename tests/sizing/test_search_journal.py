"""A journal gives back what was finished, and nothing of another search."""

from __future__ import annotations

from pathlib import Path

import pytest

from exo_sim.errors import OutputError
from exo_sim.sizing.evaluation import Score
from exo_sim.sizing.search_journal import SearchJournal

SCORE = Score(0.2, 3e-3, 1.5, 4.0, (-0.1, -0.2), True, True, {"knee": 0.2}, ("knee_l", "34 kg", 0.4), "knee_l", 7e5, {"knee": 2},
              {"knee": (300.0, 0.1)}, 3.5e-3)  # fmt: skip
PARAMS = {"length": 0.31}


def journal(path: Path | None, name: str = "one") -> SearchJournal:
    return SearchJournal(path, name)


def keep(book: SearchJournal, number: int) -> None:
    from optuna.distributions import FloatDistribution

    book.keep(number, PARAMS, SCORE, {"length": FloatDistribution(0.2, 0.4)})


def test_a_finished_design_is_there_again(tmp_path: Path) -> None:
    path = tmp_path / "new" / "search.journal"
    keep(journal(path), 3)
    again = journal(path)
    assert again.score(3, PARAMS) == SCORE
    assert again.score(3, {"length": 0.32}) is None and again.score(2, PARAMS) is None


def test_without_a_path_nothing_is_kept() -> None:
    book = journal(None)
    keep(book, 0)
    assert book.score(0, PARAMS) is None


def test_the_line_that_a_killed_search_was_writing_is_taken_away(tmp_path: Path) -> None:
    path = tmp_path / "search.journal"
    for number in (0, 1):
        keep(journal(path), number)
    path.write_bytes(path.read_bytes()[:-20])
    again = journal(path)
    assert again.score(0, PARAMS) == SCORE and path.read_bytes().endswith(b"\n")


@pytest.mark.parametrize(("text", "says"), [("shopping list", "no journal"), ('{"op_code": "none"}\n', "no journal")])
def test_what_is_no_journal_is_left_alone(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "search.journal"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(OutputError, match=says):
        journal(path)
    assert path.read_text(encoding="utf-8") == text


def test_the_journal_of_another_search_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "search.journal"
    keep(journal(path), 0)
    with pytest.raises(OutputError, match="holds another search"):
        journal(path, "other")


def test_a_folder_that_is_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("", encoding="utf-8")
    with pytest.raises(OutputError, match="it is a file"):
        journal(tmp_path / "out" / "search.journal")
