from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

import exo_sim
from exo_sim import cli
from exo_sim.cli import failures, frame, options, printing
from exo_sim.errors import Diverged, RigError


@frame.verb("exo-sim probe 3 --payload '2 kg'", out="Where to.", seed=True)
@click.argument("word")
@click.option("--payload", type=options.Quantity("kg", low=0.0, high=45.0), default="20 kg")
@click.option("--assist", type=options.Choice(("on", "off", "vented")), default="on")
@click.option("--rig", type=options.InputFile())
def probe(
    word: str, payload: float, assist: str, rig: Path | None, out: Path | None, as_json: bool, quiet: bool, seed: int
) -> int | None:
    """Try the frame."""
    match word:
        case "bad":
            raise RigError('rig.toml: cylinders.piston.bore "-3 mm" is not\npositive')
        case "diverged":
            raise Diverged("diverged at 1.2 s")
        case "fault":
            raise ZeroDivisionError("division by zero")
        case "lacking":
            raise ModuleNotFoundError("No module named 'pint'", name="pint")
        case "interrupt":
            raise KeyboardInterrupt("2 s are kept in walk.rrd")
        case "status":
            return 4
    printing.show({"payload": payload, "seed": seed, "nan": float("nan")}, f"{payload} kg", as_json=as_json, out=out)
    return None


@pytest.fixture(autouse=True)
def _probe_is_a_verb(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    found, listed = frame.Program.get_command, frame.Program.list_commands
    monkeypatch.setattr(
        frame.Program, "get_command", lambda self, ctx, name: probe if name == "probe" else found(self, ctx, name)
    )
    monkeypatch.setattr(frame.Program, "list_commands", lambda self, ctx: [*listed(self, ctx), "probe"])
    yield


def error_of(words: list[str], capsys: pytest.CaptureFixture[str], status: int) -> str:
    """Run and return the one line on stderr; stdout stays empty."""
    assert cli.main(words) == status
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("exo-sim: ")
    assert printed.err.count("\n") == 1
    return printed.err


@pytest.mark.parametrize(
    ("words", "status", "says"),
    [
        (["prob"], 2, 'did you mean "probe"?'),
        (["probe"], 2, "missing argument"),
        (["probe", "x", "--paylod", "3 kg"], 2, 'did you mean "--payload"?'),
        (["probe", "x", "--assist", "ventd"], 2, 'did you mean "vented"?'),
        (["probe", "x", "--payload", "34"], 2, "'--payload': \"34\" has no unit"),
        (["probe", "x", "--payload", "50 kg"], 2, 'at most "45 kg"'),
        (["probe", "x", "--payload=-1 kg"], 2, 'at least "0 kg"'),
        (["probe", "x", "--seed", "-1"], 2, "--seed"),
        (["probe", "bad"], 2, "bore"),
        (["probe", "diverged", "--json"], 5, "diverged at 1.2 s"),
        (["probe", "fault"], failures.OUR_FAULT, "a fault of exo-sim"),
        (["probe", "lacking"], 2, "the package pint is not installed"),
        (["probe", "interrupt"], 130, "interrupted; 2 s are kept in walk.rrd"),
    ],
)
def test_what_goes_wrong_is_one_line_and_a_status(
    words: list[str], status: int, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert says in error_of(words, capsys, status)


def test_a_missing_file_is_answered_with_its_neighbour(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bench.toml").write_text("")
    assert 'did you mean "bench.toml"' in error_of(["probe", "x", "--rig", str(tmp_path / "bensh.toml")], capsys, 2)
    assert "is a folder" in error_of(["probe", "x", "--rig", str(tmp_path)], capsys, 2)


def test_debug_shows_the_traceback(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["probe", "fault", "--debug"]) == failures.OUR_FAULT
    assert "Traceback" in capsys.readouterr().err


def test_json_is_one_object_and_has_no_nan(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["probe", "x", "--payload", "2000 g", "--json", "--seed", "7"]) == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out) == {"payload": 2.0, "seed": 7, "nan": None}
    assert printed.err == ""


def test_out_gets_what_would_be_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["probe", "x", "--out", str(tmp_path / "answer.txt")]) == 0
    assert capsys.readouterr().out == ""
    assert (tmp_path / "answer.txt").read_text() == "20.0 kg\n"


def test_a_verb_decides_its_status(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["probe", "status"]) == 4


def test_help_ends_with_an_example(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["probe", "--help"]) == 0
    assert "Example:\n  exo-sim probe 3" in capsys.readouterr().out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--version"]) == 0
    assert capsys.readouterr().out == f"exo-sim {exo_sim.__version__}\n"


def test_a_table_puts_numbers_to_the_right() -> None:
    assert printing.table([["a", "1.5"], ["bcd", "12"]], ["name", "m"]) == "name    m\na     1.5\nbcd    12"


def existing_verbs() -> list[click.Command]:
    context = click.Context(frame.program)
    verbs: list[click.Command] = []
    for name in frame.VERBS:
        command = frame.program.get_command(context, name)
        verbs += list(command.commands.values()) if isinstance(command, click.Group) else [command] if command else []
    return verbs


def test_every_verb_has_the_common_options_and_an_example() -> None:
    for command in existing_verbs():
        assert isinstance(command, frame.Verb)
        known = {name for parameter in command.params for name in parameter.opts}
        assert {"--json", "--out", "--quiet", "--debug"} <= known, command.name
        assert command.examples, command.name
        assert all(example.startswith("exo-sim ") for example in command.examples), command.name


def test_listing_the_verbs_imports_nothing_heavy() -> None:
    heavy = ("numpy", "mujoco", "numba", "rerun", "matplotlib", "scipy", "pyarrow", "pint", "optuna", "jinja2")
    code = (
        "import sys; from exo_sim.cli import main; main(['--help'])\n"
        f"sys.exit(', '.join(name for name in {heavy!r} if name in sys.modules) or None)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "exo-sim VERB" in done.stdout


def test_a_reader_that_leaves_makes_no_noise() -> None:
    command = f'"{sys.executable}" -m exo_sim --help | true; exit ${{PIPESTATUS[0]}}'
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert done.returncode in (0, failures.BROKEN_PIPE)  # 0 where the pipe had taken the text before its reader left
