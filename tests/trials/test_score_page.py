"""The page of a score: sentences for what is counted, a confusion matrix with a diagonal, coverage of what was seen often enough."""

from __future__ import annotations

import re
from typing import Any

import pytest

from exo_sim.trials import score_page, score_words
from exo_sim.trials.judge import Mark
from exo_sim.trials.score_statistics import figures


def mark(hidden: str, best: str, estimates: int = 1) -> Mark:
    right = hidden == best
    found = (right,) if hidden else ()
    return Mark(
        "case", "single" if hidden else "nothing", (hidden,) if hidden else (), (best,) if best else (), best, right, right, found, found,
        right if hidden else None, 0.9 if hidden else None, (), bool(best) and not hidden, False, ((4.0, 1.0),) if hidden else (),
        parameters=tuple((0.01, True, f"{hidden}.size") for _ in range(estimates if hidden and right else 0)),
    )  # fmt: skip


@pytest.fixture(scope="module")
def score() -> dict[str, Any]:
    marks = [mark("backlash", "backlash", 7), mark("valve_lag", "valve_lag"), mark("", ""), mark("valve_lag", "air_bubble")]
    spent = [{"wall_s": 1.0, "cpu_s": 1.0, "peak_bytes": 1000}]
    plain = ({**vars(one), "extra": {}} for one in marks)
    return {"figures": figures(marks, spent), "tool": "exo-sim diagnose", "head": "abc", "marks": list(plain)}


def test_what_is_counted_is_said_in_sentences(score: dict[str, Any]) -> None:
    told = dict(score_words.shares(score["figures"]))
    assert all("_" not in words and len(words.split()) > 3 for words in told)
    assert told["exactly the hidden effects are named, no more and no less"]["of"] == 3
    page = score_page.page(score)
    assert all(words in page.replace("&#34;", '"') for words in told) and "exact_set" not in page


def test_the_confusion_matrix_has_titles_and_its_diagonal(score: dict[str, Any]) -> None:
    rows, columns = score_page._places(score["figures"]["confusion"])
    assert rows == ["backlash", "nothing", "valve_lag"] and columns == [*rows, "air_bubble"]
    page = score_page.page(score)
    assert ">named first<" in page and ">hidden<" in page


def test_coverage_is_drawn_of_what_was_seen_often(score: dict[str, Any]) -> None:
    page = score_page.page(score)
    assert "backlash.size (n = 7)" in page and not re.search(r"valve_lag\.size", page)
