"""Somebody's own gait: read from every format, counted as the machine counts, and walked."""

import json

import numpy as np
import pytest

from exo_sim.api.simulating import what_to_do
from exo_sim.cli import main
from exo_sim.errors import ExoSimError, RecordingError, ScenarioError
from exo_sim.gait import labels, own_gait, recorded_gait, scenario, scenario_file
from exo_sim.gait.own_gait import GaitFile
from exo_sim.gait.walking_trial import JOINTS
from exo_sim.machine.person import Person

STRIDES, PERIOD = 4, 1.1


def walked(time):
    """Both legs of the recorded mean stride, left half a stride later [rad]."""
    gait = recorded_gait.load("falisse")
    out = {}
    for side, shift in (("r", 0.0), ("l", 0.5)):
        phase = time / PERIOD + shift
        tilt = gait.recorded["tilt"](phase)
        out[f"hip_{side}"] = gait.recorded["thigh"](phase) - tilt
        out[f"knee_{side}"] = gait.recorded["knee"](phase)
        out[f"ankle_{side}"] = gait.recorded["ankle"](phase)
    out["tilt"] = gait.recorded["tilt"](time / PERIOD)
    return out


@pytest.fixture(scope="module")
def trial():
    time = np.arange(0.0, STRIDES * PERIOD, 0.01)
    return time, walked(time)


OPENSIM = {"hip": "hip_flexion", "knee": "knee_angle", "ankle": "ankle_angle"}


def write_mot(path, time, angles, degrees=True, rename=None, drop=()):
    names = {key: "pelvis_tilt" if key == "tilt" else f"{OPENSIM[key[:-2]]}_{key[-1]}" for key in angles}
    names = {key: (rename or {}).get(name, name) for key, name in names.items() if key not in drop}
    factor = 180 / np.pi if degrees else 1.0
    rows = "\n".join("\t".join(f"{v:.8f}" for v in (t, *(factor * angles[key][i] for key in names))) for i, t in enumerate(time))
    says = "inDegrees=yes\n" if degrees else "inDegrees=no\n"
    path.write_text(f"Coordinates\nversion=1\nnRows={len(time)}\nnColumns={len(names) + 1}\n{says}endheader\n"
                    + "\t".join(["time", *names.values()]) + f"\n{rows}\n")  # fmt: skip
    return path


def write_csv(path, time, columns):
    rows = "\n".join(",".join(f"{v:.8f}" for v in (t, *(values[i] for values in columns.values()))) for i, t in enumerate(time))
    path.write_text(",".join(["time [s]", *columns]) + f"\n{rows}\n")
    return path


def assert_same_gait(figures, tolerance=0.035):
    phase = np.arange(100) / 100
    assert figures.period == pytest.approx(PERIOD, abs=0.01)
    knee = recorded_gait.load("falisse").recorded["knee"](phase)
    late = min(np.arange(-8, 9), key=lambda n: np.abs(figures.recorded["knee"](phase + n / 100) - knee).max())
    for name in ("thigh", "knee", "ankle"):
        wanted = recorded_gait.load("falisse").recorded[name](phase)
        assert np.abs(figures.recorded[name](phase + late / 100) - wanted).max() < tolerance, name


@pytest.mark.parametrize("degrees", [True, False])
def test_an_opensim_motion_gives_back_the_stride_that_is_in_it(tmp_path, trial, degrees):
    figures, remarks = own_gait.figures_of(GaitFile(write_mot(tmp_path / "walk.mot", trial[0], trial[1], degrees=degrees)))
    assert_same_gait(figures)
    assert 0.55 < figures.stance_end < 0.72
    assert figures.stride == pytest.approx(recorded_gait.load("falisse").stride, rel=0.1)
    assert "strides by the angles" in remarks[-1]


def test_angles_that_count_otherwise_are_turned_about_and_said(tmp_path, trial):
    time, angles = trial
    turned = {k: -v if k.startswith("knee") else v + np.pi / 2 if k.startswith("ankle") else v for k, v in angles.items()}
    figures, remarks = own_gait.figures_of(GaitFile(write_mot(tmp_path / "walk.sto", time, turned)))
    assert_same_gait(figures)
    assert any("knee flexion is positive" in words for words in remarks) and any("right angle" in words for words in remarks)
    turned = {k: -v if k.startswith(("hip", "ankle", "tilt")) else v for k, v in angles.items() if k != "tilt"}
    figures, remarks = own_gait.figures_of(GaitFile(write_mot(tmp_path / "other.mot", time, turned)))
    assert sum("turned about" in words for words in remarks) == 2


def test_joint_columns_of_the_contract_and_foreign_ones_are_the_same_gait(tmp_path, trial):
    time, angles = trial
    plain = {f"{'torso_pitch' if k == 'tilt' else k}.position [deg]": np.degrees(v) for k, v in angles.items()}
    first, _ = own_gait.figures_of(GaitFile(write_csv(tmp_path / "plain.csv", time, plain)))
    assert_same_gait(first)
    names = {"hip": "H", "knee": "K", "ankle": "A"}
    foreign = {f"{k[-1]} {names[k[:-2]]}": np.degrees(-v if "knee" in k else v) for k, v in angles.items() if k != "tilt"}
    foreign["tilt"] = np.degrees(angles["tilt"])
    path = write_csv(tmp_path / "foreign.csv", time, foreign)
    path.write_text(path.read_text().replace("time [s]", "t", 1))
    lines = [f'"{name}" = "{joint}_{name[0]}.position [deg]"' for joint, letter in names.items() for name in (f"l {letter}", f"r {letter}")]
    lines = [line if "knee" not in line else line.replace(' = ', ' = { column = ').rstrip() + ", scale = -1.0 }" for line in lines]
    named = tmp_path / "mine.toml"
    named.write_text("\n".join(["strides = 3", "[gait]", 'file = "foreign.csv"', "[gait.columns]", '"t" = "time [s]"',
                               '"tilt" = "torso_pitch.position [deg]"', *lines]))  # fmt: skip
    found = scenario_file.read(named)
    assert found.cycles == 3
    again = found.motion(Person())
    np.testing.assert_allclose(again.position, scenario_of(first).position, atol=1e-6)


def scenario_of(figures):
    from exo_sim.gait.walking import walking_as

    return walking_as(figures, Person())


def test_a_label_is_given_in_the_gait_table(tmp_path, trial):
    write_mot(tmp_path / "walk.mot", trial[0], trial[1], rename={"knee_angle_l": "coordinate7"})
    with pytest.raises(ScenarioError, match=r"no column for knee_l .*\[gait\]"):
        own_gait.figures_of(GaitFile(tmp_path / "walk.mot"))
    (tmp_path / "mine.toml").write_text('[gait]\nfile = "walk.mot"\nknee_l = "coordinate7"\n')
    assert scenario.find(str(tmp_path / "mine.toml")).motion(Person()).period == pytest.approx(PERIOD, abs=0.01)
    (tmp_path / "mine.toml").write_text('[gait]\nfile = "walk.mot"\nknee_l = "coordinate8"\n')
    with pytest.raises(ScenarioError, match='did you mean "coordinate7"'):
        scenario.find(str(tmp_path / "mine.toml"))


@pytest.mark.parametrize("labels", ["ground_force_vy\t1_ground_force_vy", "ground_force_r_vy\tground_force_l_vy", "1_grf_vy\t2_grf_vy"])
def test_forces_of_the_ground_tell_the_strides(tmp_path, trial, labels):
    time, angles = trial
    path = write_mot(tmp_path / "walk.mot", time, angles)
    load = {side: np.where(((time / PERIOD + shift) % 1.0) < 0.63, 600.0, 0.0) for side, shift in (("r", 0.0), ("l", 0.5))}
    force = tmp_path / "grf.mot"
    rows = "\n".join(f"{t:.4f}\t{load['r'][i]:.1f}\t{load['l'][i]:.1f}" for i, t in enumerate(time))
    force.write_text(f"grf\nendheader\ntime\t{labels}\n{rows}\n")
    figures, remarks = own_gait.figures_of(GaitFile(path, force))
    assert "by the ground's force" in remarks[-1]
    assert figures.stance_end == pytest.approx(0.63, abs=0.02) and figures.period == pytest.approx(PERIOD, abs=0.01)
    assert_same_gait(figures)
    force.write_text("grf\nendheader\ntime\tground_force_vy\n50\t1\n51\t2\n")
    with pytest.raises(ScenarioError, match="same trial on the same clock"):
        own_gait.figures_of(GaitFile(path, force))


def test_plug_in_gait_angles_of_a_c3d(tmp_path, trial):
    ezc3d = pytest.importorskip("ezc3d")
    time, angles = trial
    names = [f"{side.upper()}{joint.title()}Angles" for side in "lr" for joint in ("hip", "knee", "ankle")]
    points = np.zeros((4, len(names) + 1, len(time)))
    for i, name in enumerate(names):
        values = np.degrees(angles[f"{name[1:].lower().removesuffix('angles')}_{name[0].lower()}"])
        points[0, i] = -values if "Knee" in name else values
        points[1, i] = 1.0
    points[0, -1], points[1, -1] = -np.degrees(angles["tilt"]), 1.0
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = [*names, "LPelvisAngles"]
    file["data"]["points"] = points
    file.write(str(tmp_path / "walk.c3d"))
    figures, _ = own_gait.figures_of(GaitFile(tmp_path / "walk.c3d"))
    assert_same_gait(figures)


@pytest.mark.parametrize(
    ("label", "meant"),
    [
        ("hip_flexion_r", "hip_r"), ("/jointset/knee_l/knee_angle_l/value", "knee_l"), ("/jointset/knee_l/knee_angle_l/speed", None),
        ("knee_angle_r_beta", None), ("hip_adduction_r", None), ("LKneeAngles", "knee_l"), ("Right Ankle", "ankle_r"),
        ("knee_l.position", "knee_l"), ("pelvis_tilt", "tilt"), ("pelvis_tx", "pelvis_x"), ("torso_pitch.position", "tilt"),
        ("knee_l.velocity", None), ("hip_flexion_r_moment", None), ("lumbar_extension", None), ("RAnkleAngle", "ankle_r"),
    ],
)  # fmt: skip
def test_what_labels_mean(label, meant):
    assert labels.meaning(label) == meant


@pytest.mark.parametrize(
    ("change", "hint"),
    [
        (dict(time=0.2), "no whole stride|rows of angles"),
        (dict(drop=("knee_r",)), "no column for knee_r"),
        (dict(factor=180 / np.pi), "inDegrees=yes"),
        (dict(factor=0.0), "moves by more than 3 degrees|which no leg"),
    ],
)
def test_what_cannot_be_walked_is_one_line(tmp_path, capsys, trial, change, hint):
    time, angles = trial
    keep = time < change.get("time", np.inf)
    angles = {k: change.get("factor", 1.0) * v[keep] for k, v in angles.items()}
    path = write_mot(tmp_path / "bad.mot", time[keep], angles, degrees=False, drop=change.get("drop", ()))
    with pytest.raises(ExoSimError, match=hint):
        own_gait.figures_of(GaitFile(path))
    assert main(["run", "--gait", str(path), "--out", str(tmp_path / "x.rrd")]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1 and "bad.mot" in said.err


def test_rows_without_a_number_are_said_with_row_and_time(tmp_path, trial):
    time, angles = trial
    gaps = {key: values.copy() for key, values in angles.items()}
    gaps["hip_l"][100:109] = np.nan
    gaps["knee_r"][300] = np.nan
    columns = {f"{key}.position [rad]": values for key, values in gaps.items() if key != "tilt"}
    _, remarks = own_gait.figures_of(GaitFile(write_csv(tmp_path / "gaps.csv", time, columns)))
    (said,) = [one for one in remarks if "has no number" in one]
    assert "hip_l has no number in 9 of 440 rows, first in row 101 (1 s)" in said
    assert "knee_r has no number in 1 of 440 rows, first in row 301 (3 s)" in said
    path = tmp_path / "word.csv"
    path.write_text((tmp_path / "gaps.csv").read_text().replace("nan", "lost", 1))
    assert any('"hip_l.position [rad]" holds words in 1 of 440 rows' in one for one in own_gait.figures_of(GaitFile(path))[1])


def test_remarks_on_a_gait_are_said_before_it_cannot_be_walked(tmp_path, capsys, trial):
    time, angles = trial
    columns = {f"{key}.position [rad]": (2.2 if "hip" in key else -1.5) * values for key, values in angles.items() if key != "tilt"}
    path = write_csv(tmp_path / "bad.csv", time, columns)
    assert main(["run", "--gait", str(path), "--out", str(tmp_path / "x.rrd")]) == 2
    *remarks, last = capsys.readouterr().err.splitlines()
    assert "no lean of the trunk" in last
    assert any("knee flexion is positive there" in one for one in remarks) and any("strides by the angles" in one for one in remarks)


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("strides = 3", r"one of \[gait\]"),
        ('like = "squatt"', 'did you mean "squat"'),
        ('like = "squat"\nstride = 3', "stride is not a key"),
        ("[gait]\n", "gait.file is missing"),
        ('[gait]\nfile = "none.mot"', "no such gait file"),
        ('[standing]\nperiod = "3 s"\nknee = ["-10 deg"]\nankle = "7 deg"', "standing.lean is missing"),
        ('[standing]\nperiod = "3 s"\nknee = ["60 deg"]\nankle = "7 deg"\nlean = "5 deg"', "flexion is negative"),
        ('like = "stand"\n[added]\nmass = "20"', "no unit"),
        ("like = 3", "text in quotes"),
        ("= 3", "is not TOML"),
    ],
)
def test_a_scenario_file_that_cannot_be_is_one_line(tmp_path, text, hint):
    (tmp_path / "mine.toml").write_text(text)
    with pytest.raises(ScenarioError, match=hint) as error:
        scenario_file.read(tmp_path / "mine.toml")
    assert "\n" not in str(error.value) and "mine.toml" in str(error.value)


def test_a_scenario_file_of_a_standing_motion(tmp_path):
    (tmp_path / "dip.toml").write_text(
        'summary = "dips"\nstrides = 2\n[standing]\nperiod = "2 s"\nknee = ["-10 deg", "-60 deg"]\n'
        'ankle = ["7 deg", "17 deg"]\nlean = "10 deg"\n'
        '[added]\nmass = "5 kg"\nat = 1.0\n'
    )
    found = scenario_file.read(tmp_path / "dip.toml")
    motion = found.motion(Person())
    assert found.added is not None
    assert (found.summary, found.cycles, motion.period, found.added.mass) == ("dips", 2, 2.0, 5.0)
    assert np.degrees(motion.position[:, 4].min()) == pytest.approx(-60.0, abs=0.1)


def test_a_speed_is_a_factor_or_in_metres_a_second():
    usual = scenario.motion("level_walk", Person(), 1.0)
    pace = usual.advance / usual.period
    faster = scenario.motion("level_walk", Person(), "1.3 m/s")
    assert faster.advance / faster.period == pytest.approx(1.3)
    assert faster.period / usual.period == pytest.approx((1.3 / pace) ** -0.58)
    assert scenario.cadence(usual, "1.1") == 1.1
    assert scenario.cadence(usual, f"{3.6 * pace} km/h") == pytest.approx(1.0)
    for speed, hint in (("3 m/s", "times the recorded"), ("2", "0.7 to 1.3"), ("fast", "not a quantity"), ("1.2 kg", "m/s")):
        with pytest.raises(ScenarioError, match=hint):
            scenario.cadence(usual, speed)
    with pytest.raises(ScenarioError, match="goes nowhere"):
        scenario.motion("squat", Person(), "1 m/s")


def test_a_table_with_foreign_names_takes_a_column_map(tmp_path, trial):
    time, angles = trial
    names = {f"{name[-1].upper()} {name[:-2]}": name for name in JOINTS}
    rows = np.column_stack([time, *(np.degrees(angles[name]) for name in names.values())])
    np.savetxt(tmp_path / "lab.csv", rows, delimiter=";", header=";".join(["t", *names]), comments="")
    columns = {"t": "time [s]", **{foreign: f"{name}.position [deg]" for foreign, name in names.items()}}
    with pytest.raises(RecordingError, match='no column "time'):
        what_to_do(None, tmp_path / "lab.csv", None)
    called, found = what_to_do(None, tmp_path / "lab.csv", None, columns=columns)
    assert called == "lab" and found is not None and any("strides" in words for words in found.remarks)
    for gait, hint in (("walk.mot", r"\[gait\] table"), (None, "name the gait")):
        with pytest.raises(ScenarioError, match=hint):
            what_to_do(None, gait, None, columns=columns)


def test_angles_of_an_rrd_without_units_are_taken_as_radian_and_that_is_said(tmp_path, trial):
    rr = pytest.importorskip("rerun")
    time, angles = trial
    with rr.RecordingStream("lab") as stream:
        stream.save(tmp_path / "lab.rrd")
        for name in JOINTS:
            stream.send_columns(
                f"{name}/position", [rr.TimeColumn("time", duration=time)], rr.Scalars.columns(scalars=angles[name])
            )
    found, _ = own_gait.read(GaitFile(tmp_path / "lab.rrd"))
    np.testing.assert_allclose(found.angles["knee_l"], angles["knee_l"], atol=1e-9)
    (said,) = found.remarks
    assert "no unit is said there" in said and "hip_l.position [rad]" in said


def test_other_ground_in_a_scenario_file_and_what_is_refused_of_it(tmp_path):
    def read(text):
        (tmp_path / "mine.toml").write_text(text)
        return scenario.find(str(tmp_path / "mine.toml"))

    slow = read('like = "level_walk"\nspeed = "0.9 m/s"\ngrade = -0.05\n[hung]\nthigh_l = "2 kg"\n')
    motion = scenario.motion(slow, Person(), 1.0)
    assert np.hypot(motion.advance, motion.climb) / motion.period == pytest.approx(0.9)
    assert motion.climb == pytest.approx(-0.05 * motion.advance) and slow.hung == {"thigh_l": 2.0}
    down = scenario.motion(read('[stairs]\nrise = "-150 mm"\ntread = "300 mm"\n'), Person(), 1.0)
    assert (down.advance, down.climb) == pytest.approx((0.6, -0.3))
    for text, hint in (
        ('like = "level_walk"\ngrade = 0.5\n', "write -0.15 to 0.15"),
        ('like = "level_walk"\n[hung]\nthigh_l = "90 kg"\n', "hung.thigh_l = 90 kg"),
        ('[stairs]\nrise = "170 mm"\n', "stairs.tread is missing"),
        ('[stairs]\nrise = "170 mm"\ntread = "0 mm"\n', "write -0.15 to 0.15|which a foot fits"),
        ('[stairs]\nrise = "170 mm"\ntread = "300 mm"\nperiod = "9 s"\n', "0.8 s to 5 s"),
    ):
        with pytest.raises(ScenarioError, match=hint):
            read(text)
    for line in ("grade = 0.05", 'speed = "1 m/s"'):
        with pytest.raises(ScenarioError, match="the mean stride of a level walk"):
            scenario.motion(read(f'like = "squat"\n{line}\n'), Person(), 1.0)


def test_a_gait_file_is_walked(tmp_path, capsys, trial):
    path = write_mot(tmp_path / "mine.mot", *trial)
    given = ["--strides", "3", "--assist", "vented", "--json", "--speed", "1.1 m/s", "--out", str(tmp_path / "w.rrd")]
    assert main(["run", "--gait", str(path), *given]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["scenario"] == "mine" and any("strides" in words for words in data["remarks"])
    assert data["mean_ground_force_n"] + data["strap_load_n"]["vertical_mean"] == pytest.approx(data["supported_weight_n"], rel=5e-3)
    # what was simulated is a gait file itself; the machine, vented, swings into step in its first stride
    again, _ = own_gait.figures_of(GaitFile(tmp_path / "w.parquet"))
    assert again.period == pytest.approx(data["simulated_s"] / 3, rel=0.03)


@pytest.mark.real_data
def test_the_recorded_opensim_trial_gives_the_strides_of_fit_gait(shared_data):
    folder = shared_data / "walking_opensim"
    files = GaitFile(folder / "subject01_walk_IK.mot", folder / "subject01_walk_grf.mot")
    figures, _ = own_gait.figures_of(files)
    known = recorded_gait.load("opensim")
    assert figures.period == pytest.approx(known.period, rel=2e-3)
    assert figures.stance_end == pytest.approx(known.stance_end, abs=0.01)
    assert figures.stride == pytest.approx(known.stride, rel=0.05)
    phase = np.arange(100) / 100
    for name in ("thigh", "knee", "ankle"):
        assert np.abs(figures.recorded[name](phase) - known.recorded[name](phase)).max() < np.radians(1.0)
