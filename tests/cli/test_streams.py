"""The command where its standard streams are closed, full, or cannot hold what is to be said; and what a terminal is spared."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from exo_sim import errors
from exo_sim.cli import printing, streams

FULL = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")


def shell(command: str, **settings: str) -> subprocess.CompletedProcess[str]:
    """Run a command line of bash in an environment of which nothing but `settings` is known; `exo-sim` stands for the program."""
    environment = {"PATH": "/usr/bin:/bin", "LANG": "C.UTF-8", **settings}
    line = command.replace("exo-sim", f'"{sys.executable}" -m exo_sim')
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False, env=environment, errors="replace")


@FULL
@pytest.mark.parametrize("buffering", [{}, {"PYTHONUNBUFFERED": "1"}])
@pytest.mark.parametrize("verb", ["--help", "--version", "scenarios", "scenarios --json"])
def test_a_full_disk_behind_stdout_is_one_line_whatever_the_buffering(verb, buffering):
    done = shell(f"exo-sim {verb} > /dev/full", **buffering)
    assert done.returncode == 2
    assert done.stderr == "exo-sim: the disk is full; free some space or write elsewhere with --out\n"


def test_a_closed_stdout_is_one_line_and_status_2():
    done = shell("exo-sim scenarios >&-")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1 and "stdout is closed" in done.stderr


def test_a_stdout_that_is_only_read_is_one_line_and_status_2():
    done = shell("exo-sim scenarios 1</dev/null")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and "cannot write to stdout" in done.stderr


@FULL
@pytest.mark.parametrize("stderr", ["2>&-", "2>/dev/full"])
def test_without_a_stderr_results_and_status_stay(stderr):
    good, bad = shell(f"exo-sim scenarios {stderr}"), shell(f"exo-sim inspect nothing.csv {stderr}")
    assert good.returncode == 0 and "level_walk" in good.stdout
    assert (bad.returncode, bad.stdout) == (2, "")


def test_no_file_takes_the_place_of_a_closed_stream(tmp_path):
    out = tmp_path / "list.txt"
    done = shell(f"exo-sim scenarios --out {out} <&- 2>&-")
    assert done.returncode == 0 and "level_walk" in out.read_text()


def test_a_file_name_that_is_no_utf8_and_steers_terminals_is_one_printable_line():
    done = shell("exo-sim inspect $'\\xff\\x1b[31m.csv'")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and done.stderr.rstrip("\n").isprintable()
    assert "\\udcff\\u001b[31m.csv" in done.stderr


def test_what_a_terminal_would_obey_is_escaped_in_text_and_in_json(capsys):
    nasty = "a\x1b[2Jb\x9b31m\x7f\u202ec"
    printing.show({"name": nasty}, nasty + "\nnext", as_json=False)
    assert capsys.readouterr().out == "a\\u001b[2Jb\\u009b31m\\u007f\\u202ec\nnext\n"
    printing.show({"name": nasty}, nasty, as_json=True)
    said = capsys.readouterr().out
    assert said.replace("\n", "").isprintable() and json.loads(said) == {"name": nasty}
    streams.say(nasty)
    assert "\x1b" not in capsys.readouterr().err


def test_json_is_json_where_stdout_holds_ascii_only():
    done = shell("exo-sim trial make --cases é --json", PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert done.returncode == 2 and done.stderr.isascii()
    assert json.loads(printing._in_ascii(printing.json_text({"ü\\n": "\U0001f600\\"}))) == {"ü\\n": "\U0001f600\\"}


def test_an_error_line_is_bounded_and_keeps_both_ends():
    line = errors.one_line("begin " + "x" * 10**6 + " end")
    assert len(line) <= errors.LONGEST_LINE
    assert line.startswith("begin ") and line.endswith(" end")


def test_names_too_long_to_be_misspelt_are_not_searched_for():
    assert "mean" not in errors.nearest("x" * 10**6, ["y" * 10**6, "abc"])
    assert errors.nearest("presure", ["pressure"]) == '; did you mean "pressure"?'
