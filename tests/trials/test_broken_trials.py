"""Trials that were altered, torn or answered in nonsense: one line, nothing burnt, nobody else's score lost, nothing left running."""

from __future__ import annotations

import errno
import json
import os
import shutil
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.cli import main
from exo_sim.errors import ExoSimError, OutputError, TrialError
from exo_sim.outputs import alone_in
from exo_sim.trials import protocol
from exo_sim.trials.answer import tidied
from exo_sim.trials.case_mix import draw_plans
from exo_sim.trials.judge import judge
from exo_sim.trials.score import score
from exo_sim.trials.seal import new_key, write_key
from exo_sim.trials.tool import run_tool
from exo_sim.trials.verdict_chain import START, VerdictChain

ANSWER = """
import json, pathlib
pathlib.Path("out").mkdir()
pathlib.Path("out/diagnosis.json").write_text('{"verdict": "consistent", "effects": []}')
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    root = tmp_path_factory.mktemp("trial")
    protocol.make(root / "trial", draw_plans(2, 11), root / "key", duration=4.0, quiet=True)
    (root / "tool.py").write_text(ANSWER)
    shutil.copytree(root / "trial", root / "undone")
    protocol.run(root / "trial", f"{sys.executable} {root / 'tool.py'}", quiet=True)
    return root


@pytest.fixture
def trial(made, tmp_path):
    shutil.copytree(made, tmp_path / "copy")
    return tmp_path / "copy"


def is_burnt(key: Path) -> bool:
    return "opened_at" in json.loads(key.read_text())


def test_a_wrong_key_is_not_burnt_and_neither_is_the_right_one_on_another_trial(trial):
    other = trial / "other"
    shutil.copytree(trial / "trial", other)
    manifest = json.loads((other / "manifest.json").read_text())
    write_key(trial / "wrong", new_key(), manifest)
    with pytest.raises(TrialError, match="wrong key"):
        score(trial / "trial", trial / "wrong")
    assert not is_burnt(trial / "wrong")
    (other / "manifest.json").write_text(json.dumps(manifest | {"count": 3}))
    with pytest.raises(TrialError, match="the key of another trial"):
        score(other, trial / "key")
    assert not is_burnt(trial / "key")
    score(trial / "trial", trial / "key")
    assert is_burnt(trial / "key")


def test_a_key_made_before_keys_belonged_to_a_manifest_still_opens(trial):
    held = json.loads((trial / "key").read_text())
    del held["manifest"]
    (trial / "key").write_text(json.dumps(held))
    assert score(trial / "trial", trial / "key")["figures"]["cases"] == 2


def test_an_empty_manifest_burns_nothing(trial):
    path = trial / "trial" / "manifest.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"cases": {}}))
    (trial / "trial" / "verdicts.jsonl").unlink()
    with pytest.raises(TrialError, match="no case"):
        score(trial / "trial", trial / "key")
    assert not is_burnt(trial / "key")


HASH = "0" * 64
FILES = {"rig.toml": HASH}
NO_MANIFESTS = [
    b"[]", b"null", b"{", b"\xff\xfe", b'{"cases": []}', b'{"cases": {"a": 1}}', b'{"cases": {"a": {}}}', b"[" * 100_000,
    b'{"cases": {"a": {"files": {"rig.toml": 1}, "commitment": "", "sealed": ""}}}', b'{"count": ' + b"9" * 5000 + b"}",
    *(json.dumps({"cases": {name: {"files": FILES, "commitment": HASH, "sealed": HASH}}}).encode()
      for name in ("../a", "/etc", "a/b", "", ".git", "a" * 200, "a\n")),
    *(json.dumps({"cases": {"a": {"files": {**FILES, name: HASH}, "commitment": HASH, "sealed": HASH}}}).encode()
      for name in ("../../x", "/etc/passwd", "..")),
]  # fmt: skip


@pytest.mark.parametrize("content", NO_MANIFESTS)
@pytest.mark.parametrize("verb", ["run", "score"])
def test_what_is_no_manifest_is_one_line(tmp_path, capsys, content, verb):
    (tmp_path / "trial").mkdir()
    (tmp_path / "trial" / "manifest.json").write_bytes(content)
    assert main(["trial", verb, str(tmp_path / "trial")]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1


@pytest.mark.parametrize("content", [
    b"{}", b"[]", b"null", b"\xff", b"{", b'{"key": 1}', b'{"key": "x", "opened_at": 1}', b'{"key": "x", "opened_at": {}}',
    b'{"key": "\xc3\xa9", "manifest": 3}', b'{"key": "no fernet key"}', b'{"key": "\\ud800"}', b"[" * 100_000,
])  # fmt: skip
def test_what_is_no_key_is_one_line(trial, capsys, content):
    (trial / "bad").write_bytes(content)
    assert main(["trial", "score", str(trial / "trial"), "--key", str(trial / "bad")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert (trial / "bad").read_bytes() == content


@pytest.mark.parametrize("line", [
    b"{}", b"[]", b"null", b"7", b"\xff", b"{", b'{"case": "case_0001"}', b"[" * 100_000, b'{"number": ' + b"9" * 5000 + b"}",
    b'{"case": 1, "previous": 2, "signer": 3, "hash": 4, "signature": 5}',
    b'{"case": "a", "previous": "b", "signer": "c", "hash": "d", "signature": "e"}',
    b'{"case": "a", "previous": "b", "signer": "c", "hash": "d", "signature": "e", "wall_s": NaN}',
])  # fmt: skip
def test_what_is_no_ledger_is_one_line(trial, capsys, line):
    path = trial / "trial" / "verdicts.jsonl"
    path.write_bytes(line + b"\n" + path.read_bytes())
    for verb in ("run", "score"):
        assert main(["trial", verb, str(trial / "trial"), "--key" if verb == "score" else "--tool", str(trial / "key")]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert not is_burnt(trial / "key")


@pytest.mark.parametrize("cut", [1, 10, 200])
def test_a_verdict_that_was_torn_off_comes_again(trial, cut):
    """A full disk, or a kill while writing, leaves half a line at the end of the ledger."""
    folder, tool = trial / "undone", f"{sys.executable} {trial / 'tool.py'}"
    ledger = protocol.ledger_of(folder)
    ledger.append({"case": "case_0001", "diagnosis": None})
    first = ledger.path.read_bytes()
    ledger.append({"case": "case_0002", "diagnosis": None})
    ledger.path.write_bytes(ledger.path.read_bytes()[:-cut])
    assert [record["case"] for record in ledger.records()] == ["case_0001"]
    assert protocol.run(folder, tool, quiet=True)["new"] == 1
    assert ledger.path.read_bytes().startswith(first)
    assert [record["case"] for record in ledger.records()] == ["case_0001", "case_0002"]
    assert ledger.records()[1]["previous"] == ledger.records()[0]["hash"]


def test_a_disk_that_fills_while_a_verdict_is_written_leaves_the_ledger_as_it_was(tmp_path, monkeypatch):
    ledger = VerdictChain(tmp_path / "verdicts.jsonl", tmp_path / "run" / "signing.key")
    ledger.append({"case": "a"})
    before = ledger.path.read_bytes()

    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="the disk is full"):
        ledger.append({"case": "b"})
    assert ledger.path.read_bytes() == before
    monkeypatch.undo()
    ledger.append({"case": "b"})
    assert [record["previous"] == START for record in ledger.records()] == [True, False]


@pytest.mark.parametrize("key", ["", "zz", "00", "\udcff", "00" * 33])
def test_what_is_no_signing_key_is_one_line(trial, key, capsys):
    (trial / "undone" / "run").mkdir()
    (trial / "undone" / "run" / "signing.key").write_text(key, errors="surrogateescape")
    assert main(["trial", "run", str(trial / "undone"), "--tool", "true"]) == 2
    assert "not a signing key" in capsys.readouterr().err


@pytest.mark.parametrize("tool", ["", "'", "no-such-command-anywhere", "/etc/passwd", "a\0b"])
def test_what_is_no_tool_is_one_line(trial, tool, capsys):
    assert main(["trial", "run", str(trial / "undone"), "--tool", tool or " "]) == 2
    assert capsys.readouterr().err.count("\n") == 1


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5) | st.just("piston_leakage"),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)
names = st.sampled_from(["piston_leakage", "unknown", "flow_capacity", ""]) | json_values
effects = st.fixed_dictionaries(
    {},
    optional={
        "name": names, "where": names, "kind": names, "ambiguous_with": st.lists(names, max_size=2) | json_values,
        "parameters": st.dictionaries(st.just("area"), json_values) | json_values,
        "evidence": st.fixed_dictionaries({"log10_odds": json_values}) | json_values, "probabilities": json_values,
    },
)  # fmt: skip
answers = st.fixed_dictionaries(
    {"effects": st.lists(effects | json_values, max_size=3) | json_values},
    optional={
        "verdict": json_values, "located": st.lists(st.fixed_dictionaries({"where": json_values}) | json_values, max_size=2) | json_values,
        "fit": st.fixed_dictionaries({"signal": st.dictionaries(st.text(max_size=3), json_values), "held_out": json_values}) | json_values,
    },
) | json_values  # fmt: skip

TRUTH = {
    "case": "case_0001", "cell": "single", "actual": {},
    "hidden": [{"name": "piston_leakage", "where": "piston", "kind": "missing_physics", "size": 1.0, "distance": 9.0,
                "parameters": {"area": {"value": 1e-8, "unit": "m^2"}}}],
}  # fmt: skip


@given(answers)
def test_whatever_a_rival_answers_it_is_judged_and_told_in_json(answer):
    from dataclasses import asdict

    from exo_sim.trials.oracle import over_oracle

    for truth in (TRUTH, TRUTH | {"hidden": []}):
        mark = judge(truth, tidied(answer))
        json.dumps(asdict(mark), allow_nan=False)
    over_oracle(tidied(answer), tidied(answer) or {})


@pytest.mark.parametrize("content", [
    b"\xff\xfe", b"[" * 100_000, b'{"effects": [' + b"9" * 5000 + b"]}", b"7", b'{"effects": [{"name": ["a"]}]}', b"",
])  # fmt: skip
def test_one_rivals_nonsense_costs_only_its_case(trial, content):
    (trial / "answer").write_bytes(content)
    (trial / "tool.py").write_text(
        f"import os, shutil\nos.mkdir('out')\nshutil.copy({str(trial / 'answer')!r}, 'out/diagnosis.json')\n"
    )
    protocol.run(trial / "undone", f"{sys.executable} {trial / 'tool.py'}", quiet=True)
    assert score(trial / "undone", trial / "key")["figures"]["cases"] == 2


@pytest.mark.parametrize("what", ["os.symlink('/dev/zero', 'out/diagnosis.json')", "os.mkfifo('out/diagnosis.json')",
                                  "os.mkdir('out/diagnosis.json')", "sys.stderr.buffer.write(b'\\xff\\x1b' * 99)"])  # fmt: skip
def test_an_answer_that_is_no_file_is_none(trial, what):
    (trial / "tool.py").write_text(f"import os, sys\nos.mkdir('out')\n{what}\n")
    protocol.run(trial / "undone", f"{sys.executable} {trial / 'tool.py'}", quiet=True)
    records = protocol.ledger_of(trial / "undone").records()
    assert [record["diagnosis"] for record in records] == [None, None]
    assert all(record["words"].isprintable() for record in records)


@pytest.mark.parametrize("last", ["time.sleep(60)", "sys.exit(0)"])
def test_what_a_tool_started_does_not_outlive_it(tmp_path, last):
    code = (
        "import pathlib, subprocess, sys, time\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(60)'])\n"
        f"pathlib.Path('child').write_text(str(child.pid))\n{last}\n"
    )
    ran = run_tool([sys.executable, "-I", "-S", "-c", code], tmp_path, 5.0 if "sleep" in last else 60.0)  # starts quickly under any load
    assert ran.status == (-1 if "sleep" in last else 0)
    child = int((tmp_path / "child").read_text())
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and is_running(child):
        time.sleep(0.05)
    assert not is_running(child)


def is_running(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_a_refusal_is_one_of_ours(trial):
    for path in (trial / "undone" / "cases").iterdir():
        (path / "rig.toml").unlink()
    with pytest.raises(ExoSimError, match="missing"):
        protocol.run(trial / "undone", "true", quiet=True)


def test_two_that_run_one_trial_do_not_meet(trial, capsys):
    with alone_in(trial / "undone", "trial"):
        assert main(["trial", "run", str(trial / "undone"), "--tool", "false"]) == 2
    assert "another trial is at work" in capsys.readouterr().err
    assert not (trial / "undone" / "verdicts.jsonl").exists()


def test_what_is_not_said_is_not_there():
    said: list[dict[str, Any]] = [{"evidence": {"probability": 0.9}}, {"probability": 0.2}, {"probability": "x"}]
    tidy = tidied({"effects": [{"name": "a", **one} for one in said]})
    assert tidy is not None
    assert [effect.get("probability") for effect in tidy["effects"]] == [None, 0.2, None]
    assert "probability" not in tidy["effects"][0] and tidy["effects"][0]["evidence"] == {"probability": 0.9}


@pytest.mark.parametrize("name", ["trial/verdicts.jsonl", "trial/manifest.json", "trial/sealed/case_0001.sealed", "key"])
def test_a_pipe_in_place_of_a_file_is_not_waited_for(trial, name):
    (trial / name).unlink()
    os.mkfifo(trial / name)
    with pytest.raises(TrialError):
        score(trial / "trial", trial / "key")


@pytest.mark.parametrize("name", ["verdicts.jsonl", "run/signing.key"])
def test_a_trial_does_not_wait_for_a_pipe_either(trial, name):
    path = trial / "undone" / name
    path.parent.mkdir(exist_ok=True)
    os.mkfifo(path)
    with pytest.raises(TrialError, match="it is a pipe, not a file"):
        protocol.run(trial / "undone", "false", quiet=True)
