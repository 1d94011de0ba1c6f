"""The protocol end to end, with a tool that says what it is made to: what is altered or opened early is found out."""

from __future__ import annotations

import json
import shutil
import sys

import pytest

from exo_sim.cli import main
from exo_sim.errors import TrialError
from exo_sim.machine.rig_model import load
from exo_sim.rig import read
from exo_sim.trials import protocol
from exo_sim.trials.case_mix import draw_plans
from exo_sim.trials.judge import judge
from exo_sim.trials.score import score
from exo_sim.trials.score_statistics import clopper_pearson, figures, nine_of_ten
from exo_sim.trials.seal import new_key, open_with, seal, unseal, write_key
from exo_sim.trials.verdict_chain import START, VerdictChain

TOOL = """
import json, pathlib, sys
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
given = {p.name for p in pathlib.Path(".").iterdir() if not p.name.startswith("recording")}
assert given in ({"rig.toml", "words", "bench.xml"}, {"rig.toml", "words", "leg.xml"}), given
out.mkdir()
(out / "diagnosis.json").write_text(json.dumps({"verdict": "consistent", "effects": []}))
model = next(name for name in given if name.endswith(".xml"))
(out / "improved.toml").write_text(pathlib.Path("rig.toml").read_text().replace(model, f"../{model}"))
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    root = tmp_path_factory.mktemp("trial")
    protocol.make(root / "trial", draw_plans(4, 11), root / "key", duration=4.0, quiet=True)
    (root / "tool.py").write_text(TOOL)
    return root


@pytest.fixture
def trial(made, tmp_path):
    root = tmp_path / "copy"
    shutil.copytree(made, root)
    return root


@pytest.fixture
def done(trial):
    protocol.run(trial / "trial", f"{sys.executable} {trial / 'tool.py'}", quiet=True)
    return trial


def test_an_improved_rig_can_be_read_where_the_trial_keeps_it(done):
    found = sorted((done / "trial" / "run").glob("*/improved.toml"))
    assert len(found) == 4
    for path in found:
        assert load(read(path)).njnt > 0
        assert read(path).model.resolve().parent == (done / "trial" / "cases" / path.parent.name).resolve()


def test_an_honest_trial_is_scored(done, capsys):
    assert main(["trial", "score", str(done / "trial"), "--key", str(done / "key"), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["figures"]["cases"] == 4
    assert result["figures"]["answered"]["share"] == 1.0
    page = (done / "trial" / "score.html").read_text()
    assert "sealed cases" in page and "<script" not in page
    # a second look at the same verdicts is no crime
    before = (done / "trial" / "score.json").read_bytes()
    score(done / "trial", done / "key")
    assert (done / "trial" / "score.json").read_bytes() == before


def test_truth_is_not_in_the_folder(trial):
    from exo_sim.trials.hidden_effects import EFFECTS

    names = {effect.name.encode() for effect in EFFECTS.values() if not effect.known and effect.kind != "calibration"}
    names -= {b"wall_heat_transfer", b"coulomb_friction", b"viscous_friction"}  # may be known to the owner
    for path in (trial / "trial").rglob("*"):
        if path.is_file() and path.suffix != ".parquet":
            assert not [name for name in names if name in path.read_bytes()]


def test_scoring_before_the_last_verdict_is_refused_and_keeps_the_key(trial):
    with pytest.raises(TrialError, match="4 verdicts are still to come"):
        score(trial / "trial", trial / "key")
    assert "opened_at" not in json.loads((trial / "key").read_text())


def test_opening_early_is_found_out(trial):
    open_with(trial / "key", protocol.read_manifest(trial / "trial"), START, 0, lambda key: None)
    protocol.run(trial / "trial", f"{sys.executable} {trial / 'tool.py'}", quiet=True)
    with pytest.raises(TrialError, match="opened early, after 0 verdicts"):
        score(trial / "trial", trial / "key")


@pytest.mark.parametrize("edit", [
    lambda text: text.replace('"status": 0', '"status": 3', 1),
    lambda text: "\n".join(text.splitlines()[1:]) + "\n",
    lambda text: "\n".join(reversed(text.splitlines())) + "\n",
])  # fmt: skip
def test_an_edited_verdict_is_found_out(done, edit):
    ledger = done / "trial" / "verdicts.jsonl"
    ledger.write_text(edit(ledger.read_text()))
    with pytest.raises(TrialError, match="altered"):
        score(done / "trial", done / "key")


def test_an_edited_diagnosis_is_found_out(done):
    path = next((done / "trial" / "run").glob("*/diagnosis.json"))
    path.write_text(path.read_text().replace("consistent", "mismatch"))
    with pytest.raises(TrialError, match="not the diagnosis that was signed"):
        score(done / "trial", done / "key")


def test_a_ledger_written_anew_does_not_bear_the_noted_head(done):
    folder = done / "trial"
    head = protocol.ledger_of(folder).head()
    (folder / "verdicts.jsonl").unlink()
    protocol.run(folder, f"{sys.executable} {done / 'tool.py'}", quiet=True)
    with pytest.raises(TrialError, match="rewritten"):
        score(folder, done / "key", head)


def test_a_closed_ledger_takes_nothing_more(done):
    with pytest.raises(TrialError, match="closed"):
        protocol.ledger_of(done / "trial").append({"case": "case_0001"})


def test_altered_inputs_and_seals_are_found_out(trial):
    tool = f"{sys.executable} {trial / 'tool.py'}"
    rig = trial / "trial" / "cases" / "case_0002" / "rig.toml"
    kept = rig.read_text()
    rig.write_text(kept + "\n")
    with pytest.raises(TrialError, match=r"rig\.toml was altered"):
        protocol.run(trial / "trial", tool, quiet=True)
    rig.write_text(kept)
    protocol.run(trial / "trial", tool, quiet=True)
    sealed = trial / "trial" / "sealed"
    (sealed / "case_0001.sealed").write_bytes((sealed / "case_0002.sealed").read_bytes())
    with pytest.raises(TrialError, match="altered"):
        score(trial / "trial", trial / "key")


def test_an_exchanged_truth_does_not_fit_its_commitment():
    key = new_key()
    stored, commitment = seal({"hidden": []}, key)
    assert unseal(stored, commitment, key, "a") == {"hidden": []}
    with pytest.raises(TrialError, match="exchanged"):
        unseal(seal({"hidden": []}, key)[0], commitment, key, "a")
    with pytest.raises(TrialError, match="wrong key"):
        unseal(stored, commitment, new_key(), "a")


def test_run_goes_on_where_it_stopped_and_order_does_not_depend_on_workers(trial, tmp_path):
    folder = trial / "trial"
    tool = f"{sys.executable} {trial / 'tool.py'}"
    other = tmp_path / "other"
    shutil.copytree(folder, other)
    ledger = protocol.ledger_of(folder)
    entry = protocol.read_manifest(folder)["cases"]["case_0001"]
    ledger.append({"case": "case_0001", "tool": tool, **protocol.diagnose_one(folder, "case_0001", entry, tool, 60.0)})
    assert protocol.run(folder, tool, quiet=True)["new"] == 3
    protocol.run(other, tool, jobs=2, quiet=True)
    records = ledger.check([f"case_000{i}" for i in (1, 2, 3, 4)])
    kept = [(record["case"], record["diagnosis"]) for record in records]
    assert kept == [(record["case"], record["diagnosis"]) for record in protocol.ledger_of(other).records()]


def test_a_tool_that_fails_or_hangs_costs_only_its_case(trial):
    protocol.run(trial / "trial", f'{sys.executable} -c "import time; time.sleep(60)"', timeout=0.3, jobs=4, quiet=True)
    result = score(trial / "trial", trial / "key")
    assert result["figures"]["answered"]["hits"] == 0
    assert result["figures"]["exact_set"]["hits"] == 0


def test_bad_input_is_one_line(tmp_path, capsys):
    assert main(["trial", "run", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    (tmp_path / "key").write_text("{")
    with pytest.raises(TrialError, match="not a key"):
        open_with(tmp_path / "key", {}, START, 0, lambda key: None)
    write_key(tmp_path / "key", new_key(), {})
    with pytest.raises(TrialError, match="never written over"):
        protocol.make(tmp_path / "t", draw_plans(1, 0), tmp_path / "key", quiet=True)


def test_a_closed_ledger_that_lost_a_verdict_asks_for_no_further_run(tmp_path):
    ledger = VerdictChain(tmp_path / "v.jsonl", tmp_path / "k")
    for case in ("a", "b"):
        ledger.append({"case": case, "diagnosis": "1"})
    whole = (tmp_path / "v.jsonl").read_bytes()
    (tmp_path / "v.jsonl").write_bytes(whole[:-40])
    with pytest.raises(TrialError, match="1 verdicts are still to come, the first on b; trial run first"):
        ledger.check(["a", "b"])
    ledger.close()
    with pytest.raises(TrialError, match="closed, and it lost 1 verdicts since, the first on b: bring back a copy of it"):
        ledger.check(["a", "b"])


def test_a_forged_signature_is_found_out(tmp_path):
    """Whoever rewrites a verdict and the hashes after it still lacks the signing key."""
    from exo_sim.trials.seal import canonical, digest

    ledger = VerdictChain(tmp_path / "v.jsonl", tmp_path / "k")
    record = ledger.append({"case": "a", "diagnosis": "1"})
    body = {key: value for key, value in record.items() if key not in ("hash", "signature")} | {"diagnosis": "2"}
    forged = {**body, "hash": digest(canonical(body)), "signature": record["signature"]}
    (tmp_path / "v.jsonl").write_text(json.dumps(forged) + "\n")
    with pytest.raises(TrialError, match="no valid signature"):
        ledger.check(["a"])


def truth(*names, kind="missing_physics", where="piston", also=(), cell="single", distance=50.0, **parameters):
    hidden = [
        {"name": name, "variant": "", "where": where, "also": list(also), "kind": kind, "size": 1.0,
         "times_limit": 10.0,
         "distance": distance, "parameters": {key: {"value": v, "unit": "N"} for key, v in parameters.items()}}
        for name in names
    ]  # fmt: skip
    return {"case": "case_0001", "cell": cell, "hidden": hidden, "actual": {"flow_capacity": 1.25}}


def finding(name, where="piston", kind="missing_physics", odds=20.0, rivals=(), **parameters):
    return {"name": name, "where": where, "kind": kind, "parameters": parameters, "ambiguous_with": list(rivals),
            "evidence": {"log10_odds": odds}}  # fmt: skip


def verdict(*effects, located=(), kind="mismatch"):
    return {"verdict": kind, "located": [{"where": w, "equation": e} for w, e in located], "effects": list(effects)}


def test_the_right_name_with_its_parameter():
    force = {"value": 10.5, "low": 9.0, "high": 12.0, "unit": "N"}
    mark = judge(truth("coulomb_friction", force=10.0), verdict(finding("coulomb_friction", force=force),
                 located=[("piston", "force balance")]))  # fmt: skip
    assert mark.exact and mark.found == (True,) and mark.located and mark.probability == 1.0
    assert mark.parameters == ((pytest.approx(0.05), True, "coulomb_friction.force"),)


def test_a_wrong_name_a_wrong_place_and_a_hedge():
    leak = verdict(finding("piston_leakage"), located=[("piston/chamber_1", "mass balance")])
    wrong = judge(truth("coulomb_friction"), leak)
    assert not wrong.exact and not wrong.located and wrong.confidently_wrong == ("piston_leakage",)
    elsewhere = judge(truth("coulomb_friction"), verdict(finding("coulomb_friction", where="knee")))
    assert not elsewhere.exact
    hedge = judge(truth("coulomb_friction"), verdict(finding("presliding", rivals=["coulomb_friction"])))
    assert not hedge.exact and hedge.class_exact and not hedge.confidently_wrong and hedge.probability == 0.5


def test_calibrations_are_no_false_alarm_and_unknown_is_right_outside_the_list():
    nothing = judge(truth(cell="nothing"), verdict(finding("flow_capacity", kind="calibration"), kind="calibration"))
    assert nothing.exact and not nothing.false_alarm
    alarm = judge(truth(cell="nothing"), verdict(finding("valve_lag")))
    assert alarm.false_alarm and alarm.confidently_wrong == ("valve_lag",)
    outside = judge(truth("relief_valve", kind="outside", cell="outside"), verdict(finding("unknown", kind="unknown")))
    assert outside.found == (True,) and outside.exact
    off = judge(truth("flow_capacity", kind="calibration", factor=1.3), verdict(
        finding("flow_capacity", kind="calibration",
                factor={"value": 1.25, "low": 1.2, "high": 1.3, "unit": "1"})))  # fmt: skip
    assert off.exact and off.parameters[0][:2] == (0.0, True)


def test_viscous_friction_and_a_damper_that_was_believed_wrong_are_one_number():
    bent = truth("viscous_friction", coefficient=18.0) | {"bench": {"damping": 32.0}, "believed": {"damping": 45.0}}
    both = {"value": 5.5, "low": 4.5, "high": 6.5, "unit": "N s/m"}
    mark = judge(bent, verdict(finding("viscous_friction", coefficient=both)))
    assert mark.exact and mark.parameters[0][:2] == (pytest.approx(0.1), True)
    spare = truth(cell="nothing") | {"bench": {"damping": 32.0}, "believed": {"damping": 28.0}}
    assert not judge(spare, verdict(finding("viscous_friction"))).named
    assert judge(truth(cell="nothing"), verdict(finding("viscous_friction"))).named


@pytest.mark.parametrize("first", ["clean", "hidden"])
def test_a_cell_that_holds_clean_machines_too_is_counted_by_its_names_whichever_comes_first(first):
    clean = judge(truth(cell="leg"), verdict(kind="consistent"))
    hit = judge(truth("piston_leakage", cell="leg"), verdict(finding("piston_leakage")))
    miss = judge(truth("valve_lag", cell="leg"), verdict(finding("piston_leakage")))
    cell = figures([clean, hit, miss] if first == "clean" else [hit, miss, clean])["cells"]["leg"]
    assert (cell["exact_set"]["hits"], cell["exact_set"]["of"]) == (2, 3)
    assert set(figures([clean])["cells"]["leg"]) == {"right", "false_alarms"}


def test_no_answer_is_no_hit_and_cannot_tell_counts_only_where_likelihood_agrees():
    assert not judge(truth(cell="nothing"), None).exact
    assert judge(truth("backlash", distance=1.0), verdict(kind="undetermined")).undetermined_right
    assert not judge(truth("backlash", distance=9.0), verdict(kind="undetermined")).undetermined_right


def test_clopper_pearson_of_the_textbook():
    assert clopper_pearson(0, 50) == pytest.approx((0.0, 0.0711217), abs=1e-6)
    assert clopper_pearson(49, 50)[0] == pytest.approx(0.893530, abs=1e-5)
    assert clopper_pearson(0, 0) == (0.0, 1.0)


def test_nine_of_ten_finds_the_knee():
    import dataclasses

    import numpy as np

    base = judge(truth("backlash"), verdict(finding("backlash")))
    rng = np.random.default_rng(2)
    sizes = np.exp(rng.uniform(np.log(0.3), np.log(12), 400))
    chance = 1 / (1 + np.exp(-4 * np.log(sizes / 1.5)))
    marks = [
        dataclasses.replace(base, sizes=((float(s), 5.0),), found=(bool(hit),))
        for s, hit in zip(sizes, rng.random(400) < chance)
    ]
    assert nine_of_ten(marks) == pytest.approx(1.5 * 9 ** (1 / 4), rel=0.25)
    assert figures(marks)["detection"]["curve"][-1]["share"] > 0.9
    assert nine_of_ten([dataclasses.replace(mark, found=(False,)) for mark in marks]) is None


@pytest.mark.slow
def test_a_scheduler_gives_the_same_verdicts(trial, tmp_path):
    from distributed import LocalCluster

    tool = f"{sys.executable} {trial / 'tool.py'}"
    other = tmp_path / "other"
    shutil.copytree(trial / "trial", other)
    protocol.run(trial / "trial", tool, quiet=True)
    with LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as cluster:
        protocol.run(other, tool, scheduler=cluster.scheduler_address, quiet=True)
    kept = [
        [(record["case"], record["diagnosis"]) for record in protocol.ledger_of(folder).records()]
        for folder in (trial / "trial", other)
    ]
    assert kept[0] == kept[1]


def test_the_same_seed_makes_the_same_cases(tmp_path):
    one, two = (
        protocol.make(tmp_path / name, draw_plans(3, 5), tmp_path / f"{name}.key", duration=4.0, jobs=jobs, quiet=True)
        for name, jobs in (("a", 1), ("b", 2))
    )
    assert [entry["files"] for entry in one["cases"].values()] == [entry["files"] for entry in two["cases"].values()]
    assert one["cases"]["case_0001"]["commitment"] != two["cases"]["case_0001"]["commitment"]
