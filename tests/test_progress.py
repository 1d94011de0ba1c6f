"""Progress is shown on a terminal only, and leaves nothing behind."""

from __future__ import annotations

import sys

import pytest

from exo_sim.progress import Bar, Stages, each


def test_where_stderr_is_no_terminal_nothing_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(each(range(3), "counting", total=3)) == [0, 1, 2]
    with Stages() as stages, Bar(2.0, "working") as bar:
        stages.say("reading")
        bar.to(1.0)
        bar.advance()
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("quiet", [False, True])
def test_on_a_terminal_a_stage_is_one_line_that_is_taken_away(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], quiet: bool
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with Stages(quiet) as stages:
        stages.say("reading " + "x" * 500)
    err = capsys.readouterr().err
    assert err == "" if quiet else "reading" in err and err.endswith("\x1b[2K") and "\n" not in err and len(err) < 300


@pytest.mark.parametrize("at_once", [False, True])
def test_work_that_takes_long_shows_its_bar_before_the_first_is_done(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], at_once: bool
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    for _ in each(range(2), "diagnosing", total=2, unit="case", at_once=at_once):
        assert ("diagnosing   0%" in capsys.readouterr().err) is at_once
        break
