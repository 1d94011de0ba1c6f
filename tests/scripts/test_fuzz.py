"""What the fuzzer relies on: edits break what they should, a broken promise is noticed, and cases that once broke one are tried again."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def scripts(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(repository / "scripts"))


def test_a_case_is_one_line_and_comes_back(tmp_path):
    from fuzzing.case import Case

    (tmp_path / "bases" / "bench").mkdir(parents=True)
    (tmp_path / "bases" / "bench" / "a.csv").write_text("time [s],x [m]\n0,1\n1,2\n")
    case = Case("bench", ("inspect", "a.csv"), (["cell", "a.csv", 1, 1, "\x1b"], ["kind", "b.csv", "pipe"], ["cut", "absent", 3]))
    assert "\n" not in case.line()
    again = Case.read(case.line())
    again.lay_out(tmp_path / "bases", tmp_path / "case")
    assert (tmp_path / "case" / "a.csv").read_text() == "time [s],x [m]\n0,\x1b\n1,2\n"
    assert (tmp_path / "case" / "b.csv").is_fifo()


@pytest.mark.parametrize(
    ("edit", "after"),
    [
        (["splice", "a", 2, 1, "Z"], b"k Z 1\n[t]\nb = 2\n"),
        (["splice", "a", -1, 0, "!"], b"k = 1\n[t]\nb = 2\n!"),
        (["repeat", "a", 0, 2, 3], b"k k k = 1\n[t]\nb = 2\n"),
        (["cut", "a", 3], b"k ="),
        (["value", "a", 3, "x"], b"k = 1\n[t]\nb = x\n"),  # the fourth of two is the second
        (["key", "a", 0, "y"], b"y = 1\n[t]\nb = 2\n"),
        (["table", "a", 7, "u.v"], b"k = 1\n[u.v]\nb = 2\n"),
    ],
)
def test_edits_of_text(tmp_path, edit, after):
    from fuzzing.edits import apply

    (tmp_path / "a").write_bytes(b"k = 1\n[t]\nb = 2\n")
    apply(tmp_path, edit)
    assert (tmp_path / "a").read_bytes() == after


def test_edits_of_tables_models_and_json(tmp_path):
    from fuzzing.edits import apply

    (tmp_path / "a.csv").write_text("t,x\n0,1\n1,2\n2,3")
    apply(tmp_path, ["column", "a.csv", 1, "scale", 10.0])
    apply(tmp_path, ["rows", "a.csv", 0, 2, "backwards"])
    assert (tmp_path / "a.csv").read_text() == "t,x\n1,20\n0,10\n2,30"
    (tmp_path / "a.xml").write_text('<a b="1"><c d="2"/></a>')
    apply(tmp_path, ["attribute", "a.xml", 1, "nan"])
    apply(tmp_path, ["element", "a.xml", 0, "<e/>"])
    assert (tmp_path / "a.xml").read_text() == '<a b="1"><e/></a>'
    (tmp_path / "a.json").write_text('{"a": [1, 2]}\n{"b": 3}\n')
    apply(tmp_path, ["leaf", "a.json", 3, None])
    first, second = (json.loads(line) for line in (tmp_path / "a.json").read_text().splitlines())
    assert first == {"a": [1, None]} and second == {"b": 3}


def test_a_command_that_keeps_its_promises_breaks_none(tmp_path):
    assert _broken(tmp_path, lambda words: print("{}") or 0) == []
    assert _broken(tmp_path, lambda words: print("exo-sim: no", file=sys.stderr) or 2) == []


def _write(name, text=""):
    return lambda words: (Path(name).write_text(text) and 0) or 0


def _raise(words):
    raise RecursionError("deep")


@pytest.mark.parametrize(
    ("verb", "said"),
    [
        (lambda words: 70, "status 70"),
        (_raise, "escaped: RecursionError"),
        (lambda words: print("exo-sim: \x1b[2J", file=sys.stderr) or 2, "U+001B on stderr"),
        (lambda words: print("exo-sim: " + "a" * 2000, file=sys.stderr) or 2, "a line of 2009"),
        (lambda words: print("half") or print("exo-sim: no", file=sys.stderr) or 2, "stdout is not empty"),
        (lambda words: 2, "no line that says what is wrong"),
        (lambda words: print("Traceback (most recent call last):", file=sys.stderr) or 0, "a traceback"),
        (lambda words: print('{"a": NaN}') or 0, "no JSON"),
        (lambda words: os.write(2, b"libpng warning") and 0, "past Python: libpng"),
        (_write(".a.12@host.partial.csv"), "left .a.12@host.partial.csv behind"),
        (_write("MUJOCO_LOG.TXT"), "left MUJOCO_LOG.TXT behind"),
        (_write("in.csv", "other"), "changed its input in.csv"),
        (_write("out.json", "{"), "out.json: stdout is no JSON"),
    ],
)
def test_a_promise_that_is_broken_is_noticed(tmp_path, verb, said):
    assert any(said in words for words in _broken(tmp_path, verb)), _broken(tmp_path, verb)


def _broken(tmp_path, verb):
    from fuzzing import promises
    from fuzzing.command import run

    folder = tmp_path / "case"
    folder.mkdir(exist_ok=True)
    for path in folder.iterdir():
        path.unlink()
    (folder / "in.csv").write_text("as it was")
    return promises.broken(run(("x", "--json"), folder, verb), ("x", "--json"))


def test_what_takes_too_long_is_interrupted_as_a_person_would(tmp_path, monkeypatch):
    import time

    from fuzzing import command, promises

    monkeypatch.setattr(command, "LONGEST", 0.05)

    def sleeps(words: object) -> int:
        time.sleep(30)
        return 0

    outcome = command.run(("x",), tmp_path, sleeps)
    assert outcome.interrupted and promises.broken(outcome, ("x",))[0].startswith("escaped: KeyboardInterrupt")


def test_a_machine_that_is_sound_is_driven_and_one_that_is_not_is_one_line(repository, capsys, monkeypatch):
    from fuzzing.machine import drive

    monkeypatch.chdir(repository / "assets")
    assert drive(["machine", "bench.toml"]) == 0
    assert drive(["machine", "bench.xml"]) == 2
    assert capsys.readouterr().err.startswith("exo-sim: ")


def test_every_case_that_is_kept_can_be_read():
    from fuzzing import corpus
    from fuzzing.case import Case

    assert corpus.lines()
    for line in corpus.lines():
        assert Case.read(line).base in ("bench", "exo", "trial", "walk")
