"""What `inspect` says of recordings whose contents are known."""

import json
from pathlib import Path

import numpy as np
import pytest

from exo_sim.cli import main
from exo_sim.recording import Reading, Recording, summary, summary_text, write_rrd, write_table
from exo_sim.recording.gait_events import feet

STRIDE = 1.25


def walk(seconds: float = 10.0) -> Recording:
    time = np.arange(int(1000 * seconds)) / 1000.0
    swing = 2 * np.pi * time / STRIDE
    rng = np.random.default_rng(0)
    columns = {
        "knee_r.pressure_1": 4e5 + 2e5 * np.sin(swing) + 200.0 * rng.standard_normal(len(time)),
        "knee_r.force": 300.0 * np.sin(swing),
        "knee_r.force_demanded": 300.0 * np.sin(swing) + 3.0,
        "knee_r.valve_command": np.where(np.sin(swing) > 0, 0.5, 0.0),
        "knee_r.choked": np.where(np.sin(swing) > 0, 2.0, 0.0),
        "knee_r.gas_used": 1e-4 * time,
        "knee_r.position": 0.5 * np.sin(swing),
        "knee_r.torque": 20.0 * np.sin(swing),
        "foot_r.ground_force_z": np.maximum(0.0, 900.0 * np.sin(swing - 0.3)),
        "foot_l.ground_force_z": np.maximum(0.0, -900.0 * np.sin(swing - 0.3)),
        "supply.pressure": 7e5 + 200.0 * rng.standard_normal(len(time)),
    }
    units = dict.fromkeys(columns, "N") | {
        "knee_r.pressure_1": "Pa",
        "knee_r.valve_command": "1",
        "knee_r.choked": "1",
        "knee_r.gas_used": "kg",
        "knee_r.position": "rad",
        "knee_r.torque": "N*m",
        "supply.pressure": "Pa",
    }
    return Recording("walk", time, columns, units, {"scenario": "level_walk", "rig": "a = 1\n" * 40})


def test_gait_events_of_a_known_walk() -> None:
    right, left = feet(walk())
    assert right.foot == "foot_r"
    assert right.stride_times == pytest.approx(np.full(len(right.contacts) - 1, STRIDE), abs=2e-3)
    late = STRIDE * (0.3 + np.arcsin(0.05)) / (2 * np.pi)  # when the force passes a twentieth of its peak
    assert right.contacts[0] == pytest.approx(late, abs=2e-3)
    assert left.contacts[0] - right.contacts[0] == pytest.approx(STRIDE / 2, abs=2e-3)
    assert right.stance_share == pytest.approx(0.5 - np.arcsin(0.05) / np.pi, abs=0.01)
    assert right.peak_force == pytest.approx(900.0, rel=1e-3)


def test_chatter_is_not_a_step() -> None:
    recording = walk()
    force = recording["foot_r.ground_force_z"].copy()
    force[3000:3020] = 0.0
    force[3030:3035] = 0.0
    force[3600:3605] = 300.0  # in the air
    rough = Recording("r", recording.time, {"foot_r.ground_force_z": force}, {"foot_r.ground_force_z": "N"})
    assert feet(rough)[0].contacts == feet(walk())[0].contacts


def test_stance_alone_will_do() -> None:
    time = np.arange(3000) / 1000.0
    columns = {"gait.stance_r": (np.sin(2 * np.pi * time) > 0).astype(float)}
    (foot,) = feet(Recording("r", time, columns, {"gait.stance_r": "1"}))
    assert foot.contacts == pytest.approx((0.001, 1.001, 2.001), abs=2e-3)
    assert foot.peak_force is None


def test_the_summary_adds_up() -> None:
    found = summary.summarise(Reading(walk(), ()))
    knee = found.cylinders["knee_r"]
    assert knee["force_error_rms_n"] == pytest.approx(3.0)
    assert knee["choked_share"] == pytest.approx(0.5, abs=0.01)
    assert knee["valve_closed_share"] == pytest.approx(0.5, abs=0.01)
    assert knee["gas_used_kg"] == pytest.approx(1e-3, rel=1e-3)
    assert knee["gas_used_kg_per_stride"] == pytest.approx(1e-4 * STRIDE, rel=1e-3)
    assert found.joints["knee_r"]["torque_rms"] == pytest.approx(20 / np.sqrt(2), rel=1e-3)
    (pressure,) = [entry for entry in found.signals if entry["name"] == "knee_r.pressure_1"]
    assert pressure["noise"] == pytest.approx(200.0, rel=0.1)
    assert found.findings == ()
    text = summary_text.text(found)
    assert "Nothing looks wrong." in text
    assert "1.250 +- 0.000" in text
    assert max(len(line) for line in text.splitlines()) < 130
    assert not any(line != line.rstrip() for line in text.splitlines())


def test_walking_a_long_way_is_not_millimetres() -> None:
    recording = walk()
    for way, kinds in ((1.3 * recording.time, []), (8.0 * np.sin(recording.time), ["unit"])):
        columns = {**recording.columns, "torso_x.position": way}
        moved = Recording("r", recording.time, columns, {**recording.units, "torso_x.position": "m"})
        assert [finding.kind for finding in summary.summarise(Reading(moved, ())).findings] == kinds


def test_odd_physics_is_told() -> None:
    recording = walk()
    turned = {**recording.columns, "foot_r.ground_force_z": -recording["foot_r.ground_force_z"]}
    found = summary.summarise(Reading(Recording("r", recording.time, turned, recording.units), ()))
    assert "ground pulls" in [finding.kind for finding in found.findings]
    pumped = {**recording.columns, "supply.pressure": recording["supply.pressure"] - 2e5}
    found = summary.summarise(Reading(Recording("r", recording.time, pumped, recording.units), ()))
    assert [finding.kind for finding in found.findings] == ["above supply"]


@pytest.mark.parametrize("ending", ["rrd", "parquet", "csv"])
def test_inspect(tmp_path: Path, ending: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / f"walk.{ending}"
    write_rrd(path, walk()) if ending == "rrd" else write_table(path, walk())
    assert main(["inspect", str(path), "--json"]) == 0
    shown = capsys.readouterr()
    data = json.loads(shown.out)
    assert shown.err == ""
    assert data["schema"] == "exo-sim/inspect/1"
    assert data["duration_s"] == pytest.approx(9.999)
    assert {entry["name"] for entry in data["signals"]} == set(walk().columns)
    assert main(["inspect", str(path)]) == 0
    assert "knee_r.pressure_1" in capsys.readouterr().out


def test_inspect_with_a_rig_and_a_fault(tmp_path: Path, repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.arange(3000) / 1000.0
    columns = {
        "piston.pressure_1": 3e5 * (1 + np.sin(time * 6)) + 300.0 * np.random.default_rng(0).standard_normal(3000),
        "slide.position": 80.0 + 40.0 * np.cos(time * 6),
    }
    path = tmp_path / "bench.csv"
    write_table(path, Recording("bench", time, columns, {"piston.pressure_1": "Pa", "slide.position": "m"}))
    assert main(["inspect", str(path), "--rig", str(repository / "assets" / "bench.toml"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["findings"]
    noticed = {(f["column"], f["kind"]): f["severity"] for f in found}
    assert noticed["piston.pressure_1", "gauge"] == "warning"  # it is asked, and read as what it seems to be
    assert noticed["slide.position", "unit"] == "warning"


def test_rows_that_are_missing_are_left_out_and_their_column_is_not_set_aside() -> None:
    recording = walk()
    columns = dict(recording.columns)
    columns["knee_r.pressure_1"] = np.where((recording.time > 2.0) & (recording.time < 4.0), np.nan, columns["knee_r.pressure_1"])
    said = summary_text.text(summary.summarise(Reading(Recording("walk", recording.time, columns, recording.units), ())))
    (line,) = [line for line in said.splitlines() if "has no number in" in line]
    assert line.endswith("[these rows are left out]")


def test_inspect_of_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty.csv").write_text("")
    assert main(["inspect", str(tmp_path / "empty.csv")]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and "the file is empty" in shown.err and len(shown.err.splitlines()) == 1


def test_view_without_a_display(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    write_table(tmp_path / "walk.parquet", walk(1.0))
    assert main(["view", str(tmp_path / "walk.parquet")]) == 2
    shown = capsys.readouterr()
    assert "no display" in shown.err and len(shown.err.splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["walk.parquet"]  # nothing left behind


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["noise.rrd", "--out", "a.png"], "not a whole .rrd"),
        (["short.rrd", "--out", "a.png"], "not a whole .rrd"),
        (["walk.rrd", "--out", "a.jpg"], "a picture ends in .png"),
        (["walk.rrd", "--out", "a.png", "--at", "9"], '--at 9: "walk.rrd" goes from 0 to 0.999 s'),
        (["walk.rrd", "--out", "a.png", "--at", "nan"], "--at nan"),
    ],
)
def test_what_cannot_be_viewed_is_one_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, arguments: list[str], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_rrd("walk.rrd", walk(1.0))
    Path("noise.rrd").write_bytes(np.random.default_rng(0).bytes(5000))
    Path("short.rrd").write_bytes(Path("walk.rrd").read_bytes()[:-3000])
    assert main(["view", *arguments]) == 2
    shown = capfd.readouterr()
    assert words in shown.err and len(shown.err.splitlines()) == 1 and shown.out == ""
    assert not list(tmp_path.glob("a.*"))


def wide(parts: int) -> Recording:
    time = np.arange(400) / 100.0
    columns = {f"joint_{n}.{signal}": np.sin(time + n + i) for n in range(parts) for i, signal in enumerate(("position", "velocity"))}
    return Recording("wide", time, columns, {key: "rad" if "position" in key else "rad/s" for key in columns})


def test_what_looks_wrong_stands_first_and_its_marks_are_explained() -> None:
    recording = wide(2)
    columns = {**recording.columns, "foot.ground_force_z": -500.0 - np.sin(recording.time)}
    found = summary.summarise(Reading(Recording("w", recording.time, columns, {**recording.units, "foot.ground_force_z": "N"}), ()))
    first, blank, title, *_ = summary_text.text(found).splitlines()
    assert first.startswith("w: 3.99 s, 400 samples") and blank == "" and ("looks wrong" in title or "look wrong" in title)
    assert "! may spoil results" in title


def test_of_many_columns_those_to_look_at_are_listed_and_the_others_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording = wide(20)
    columns = {**recording.columns, "joint_3.position": np.where(recording.time < 1.0, np.nan, recording["joint_3.position"])}
    gaps = Recording("w", recording.time, columns, recording.units)
    found = summary.summarise(Reading(gaps, ()))
    short, long = summary_text.text(found), summary_text.text(found, every_column=True)
    table = [line for line in short.splitlines() if line.startswith("  joint_") and ".position  " in line]
    assert [line.split()[0] for line in table if "velocity" not in line] == ["joint_3.position"]
    assert "40 columns (the numbers of each: --all)" in short and len(short.splitlines()) < 40
    assert all(f"  {name} " in long for name in columns)
    assert "joint_7.velocity" in summary_text.text(summary.summarise(Reading(wide(10), ())))  # few are listed as they are
    write_table(tmp_path / "wide.csv", wide(20))
    assert main(["inspect", str(tmp_path / "wide.csv"), "--all"]) == 0
    assert "joint_7.velocity" in capsys.readouterr().out
