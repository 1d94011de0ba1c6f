from __future__ import annotations

import re
import shlex
from pathlib import Path

import click
import pytest

from exo_sim.cli import frame, main
from exo_sim.cli.failures import INTERRUPTED
from exo_sim.diagnosis.result import Verdict
from exo_sim.errors import Diverged, ExoSimError


def blocks(repository: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (repository / "README.md").read_text(), re.DOTALL)


def test_the_python_of_the_readme_runs(
    repository: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(repository)
    for block in blocks(repository, "python"):
        exec(compile(block, "README.md", "exec"), {})
    assert capsys.readouterr().out


def test_the_commands_of_the_readme_exist(repository: Path) -> None:
    lines = [shlex.split(line, comments=True) for block in blocks(repository, "sh") for line in block.splitlines()]
    commands = [words for words in lines if words[:1] == ["exo-sim"]]
    assert commands
    for words in commands:
        verb = frame.program.get_command(click.Context(frame.program), words[1])
        assert verb is not None, words
        verb.make_parser(click.Context(verb)).parse_args(words[2:])  # an option that is not there is refused
    for words in lines:
        if words and words[0].startswith("scripts/"):
            assert (repository / words[0]).is_file()


def test_pictures_and_files_that_the_readme_names_are_there(repository: Path) -> None:
    text = (repository / "README.md").read_text()
    for name in re.findall(r"!?\[[^]]*\]\(([^)]+)\)", text) + re.findall(r"`((?:assets|scripts|docs)/[^`\s]+)`", text):
        assert (repository / name).exists(), name


def test_every_exit_status_of_a_verb_stands_in_the_readme_and_in_help(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    statuses = {*(kind.exit_status for kind in (ExoSimError, Diverged)), *(verdict.exit_status for verdict in Verdict), INTERRUPTED}
    assert main(["--help"]) == 0
    for text in ((repository / "README.md").read_text(), capsys.readouterr().out):
        _, _, told = " ".join(text.split()).partition("xit status")
        assert all(re.search(rf"\b{status}\b", told[:400]) for status in statuses)
    assert main(["run", "--help"]) == 0
    assert "5 where the simulation" in " ".join(capsys.readouterr().out.split())
