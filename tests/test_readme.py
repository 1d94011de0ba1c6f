from __future__ import annotations

import re
import shlex
from pathlib import Path

import click
import pytest

from exo_sim.cli import frame


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
