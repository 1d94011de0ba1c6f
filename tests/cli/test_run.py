"""`exo-sim run` and `exo-sim scenarios` as a person meets them."""

import json
import signal

import pytest

from exo_sim.cli import main
from exo_sim.recording import reader


def call(capsys, *arguments):
    status = main(list(arguments))
    said = capsys.readouterr()
    return status, said.out, said.err


def test_run_prints_the_contracts_json_and_leaves_both_files(capsys, tmp_path):
    out = tmp_path / "walk.rrd"
    status, text, words = call(
        capsys,
        "run",
        "level_walk",
        "--payload",
        "34 kg",
        "--strides",
        "2",
        "--assist",
        "vented",
        "--out",
        str(out),
        "--json",
    )
    assert status == 0, words
    data = json.loads(text)
    assert data["schema"] == "exo-sim/run/1"
    keys = {"scenario", "simulated_s", "wall_s", "recording", "table", "supported_weight_n", "mean_ground_force_n",
            "strap_load_n", "wearer", "joints", "cylinders", "books"}  # fmt: skip
    assert keys <= set(data)
    assert {"vertical_mean", "torso_vertical_mean", "torso_rms", "torso_peak"} <= set(data["strap_load_n"])
    assert set(data["wearer"]["extra_moment_rms_nm"]) == {"hip", "knee", "ankle"}
    assert {"torque_peak_nm", "torque_rms_nm", "torque_error_rms_nm"} == set(data["joints"]["knee_r"])
    assert {"wearer_joints", "straps", "cylinders", "machine_damping", "ground", "residual", "closure"} <= set(data["ledger"])
    added = {"moment_rms_nm", "forward_push_n", "power_to_machine_w", "metabolic_w", "pelvis_residual", "pressure_centre_outside_share"}
    assert added <= set(data["wearer"]) and {"value", "low", "high", "model"} == set(data["wearer"]["metabolic_w"])
    assert {"no_machine", "backpack"} == set(data["compared_with"])
    assert {"pressure_peak_pa", "choked_share", "gas_kg_per_stride"} <= set(data["cylinders"]["knee_r"])
    assert out.is_file() and out.with_suffix(".parquet").is_file()
    for path in (out, out.with_suffix(".parquet")):
        table = reader.read(path).recording
        assert "hip_l.pressure_1" in table and table.metadata["assist"] == "vented"


def test_run_prints_a_report_for_people(capsys, tmp_path):
    status, text, _ = call(
        capsys,
        "run",
        "stand",
        "--payload",
        "20 kg",
        "--strides",
        "1",
        "--assist",
        "off",
        "--out",
        str(tmp_path / "s.rrd"),
    )
    assert status == 0
    assert "backpack" in text and "weight of frame and payload 528.0 N" in text


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["levelwalk"], 'did you mean "level_walk"'),
        (["level_walk", "--payload", "60 kg"], "0 to 45 kg"),
        (["level_walk", "--payload", "34"], "no unit"),
        (["level_walk", "--speed", "2"], "0.7 to 1.3"),
        (["level_walk", "--assist", "vents"], "vented"),
        (["level_walk", "--out", "walk.csv"], "ends in .rrd"),
        (["level_walk", "--rig", "none.toml"], "none.toml"),
    ],
)
def test_bad_input_is_one_line_and_status_2(capsys, arguments, hint):
    status, text, words = call(capsys, "run", *arguments)
    assert (status, text) == (2, "")
    assert hint in words and words.count("\n") == 1


def test_a_rig_without_the_machines_parts_is_refused(capsys, repository, tmp_path):
    rig = repository / "assets" / "bench.toml"
    status, _, words = call(capsys, "run", "level_walk", "--rig", str(rig), "--out", str(tmp_path / "x.rrd"))
    assert status == 2 and "torso_x" in words
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "words",
    [("--wearer", "torques"), ("--payload", "20 kg"), ("--speed", "1.2"), ("--strides", "3"), ("--assist", "off"), ("--demand", "causal"),
     ("--whole",)],
)  # fmt: skip
def test_what_says_how_somebody_walks_is_refused_along_a_motion_that_nobody_walks(capsys, tmp_path, words):
    out = tmp_path / "bench.rrd"
    status, text, said = call(capsys, "run", "motion.csv", "--rig", "bench", *words, "--out", str(out))
    assert (status, text) == (2, "") and said.count("\n") == 1
    assert f"{words[0]} says how somebody walks, and nobody wears bench" in said
    assert not out.exists()


def test_a_payload_that_the_cylinders_cannot_carry_is_said(capsys, repository, tmp_path):
    assets = repository / "assets"
    weak = (assets / "exo_250_psi.toml").read_text().replace("18.25 bar", "7 bar").replace("exo.xml", str(assets / "exo.xml"))
    (tmp_path / "weak.toml").write_text(weak)
    given = ["--rig", str(tmp_path / "weak.toml"), "--strides", "1", "--demand", "inverse_dynamics"]
    status, text, words = call(capsys, "run", "level_walk", *given, "--json", "--out", str(tmp_path / "w.rrd"))
    assert status == 0 and len(json.loads(text)["remarks"]) == 1 and words.count("\n") == 1
    assert "34 kg is more than the cylinders carry" in words and "knee_r holds 42 of 58 N m" in words
    _, text, words = call(
        capsys, "run", "level_walk", *given, "--payload", "10 kg", "--json", "--out", str(tmp_path / "w.rrd")
    )
    assert "remarks" not in json.loads(text) and words == ""


def test_scenarios_are_listed(capsys):
    status, text, _ = call(capsys, "scenarios", "--json")
    assert status == 0
    assert "level_walk" in [one["name"] for one in json.loads(text)["scenarios"]]
    assert "squat" in call(capsys, "scenarios")[1]


OWN = """import signal
class Mine:
    def reset(self, context):
        print("begins")
    def act(self, observation):
        print(observation["time"])
        if MANY and observation["time"] > 0.3:
            signal.raise_signal(signal.SIGINT)
            while True:
                pass
        return {}
"""
SHORT = ("--strides", "1", "--demand", "inverse_dynamics", "-q", "--json")


def test_what_somebodys_controller_prints_leaves_stdout_to_the_result(capsys, tmp_path):
    (tmp_path / "mine.py").write_text(OWN.replace("MANY", "False"))
    status, text, words = call(
        capsys, "run", "level_walk", "--controller", f"{tmp_path / 'mine.py'}:Mine", *SHORT, "--out", str(tmp_path / "walk.rrd")
    )  # fmt: skip
    assert status == 0 and json.loads(text)["schema"] == "exo-sim/run/1"
    assert words.startswith("begins\n0.0\n")


def test_ctrl_c_in_a_controller_that_never_comes_back_keeps_what_was_simulated(capsys, tmp_path):
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    (tmp_path / "mine.py").write_text(OWN.replace("MANY", "True"))
    try:
        status, _, words = call(
            capsys, "run", "level_walk", "--controller", f"{tmp_path / 'mine.py'}:Mine", *SHORT, "--out", str(tmp_path / "walk.rrd")
        )  # fmt: skip
    finally:
        signal.signal(signal.SIGINT, before)
    assert status == 130 and words.splitlines()[-1].startswith("exo-sim: interrupted; 0.30 s were simulated and are in ")
    table = reader.read(tmp_path / "walk.parquet").recording
    assert 0.29 < table.time[-1] < 0.31
    assert sorted(path.name for path in tmp_path.iterdir() if path.is_file()) == ["mine.py", "walk.parquet", "walk.rrd"]
