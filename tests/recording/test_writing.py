"""What is written comes back, in every format; tables are the same byte for byte."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.errors import OutputError, RecordingError
from exo_sim.recording import Arrows, DrawnCylinder, Recording, Scene, Shape, read, write_rrd, write_table
from exo_sim.recording.blueprint import tabs, words
from exo_sim.recording.rrd_file import gait_lanes, turns
from exo_sim.recording.rrd_scene import _turning_z_to
from exo_sim.recording.scene import Kind

UNITS = {
    "knee_r.valve_command": "1",
    "knee_r.pressure_1": "Pa",
    "knee_r.force": "N",
    "knee_r.position": "rad",
    "hip_r.position": "rad",
    "hip_r.torque": "N*m",
    "foot_r.ground_force_z": "N",
    "foot_r.pressure_centre": "m",
    "torso.strap_force_z": "N",
    "supply.pressure": "Pa",
    "gait.stance_r": "1",
    "gait.phase": "1",
}


def walk(n: int = 500, seed: int = 0) -> Recording:
    rng = np.random.default_rng(seed)
    columns = {key: rng.standard_normal(n) for key in UNITS}
    columns["gait.stance_r"] = (np.arange(n) % 100 < 60).astype(float)
    columns["knee_r.force"][20:30] = np.nan
    metadata = {"rig": 'name = "exo"\n[supply]\npressure = "7 bar"\n', "scenario": "level_walk", "seed": "0"}
    return Recording("walk", np.arange(n) / 1000.0, columns, UNITS, metadata)


def scene(times: np.ndarray) -> Scene:
    n = len(times)
    line = np.stack((times, np.zeros(n), np.ones(n)), axis=1)
    turn = np.zeros((n, 2, 4))
    turn[..., 0] = 1.0
    kinds: tuple[Kind, ...] = ("sphere", "capsule", "ellipsoid", "cylinder", "box")
    shapes = [Shape(k, 1, k, np.full(3, 0.1), np.zeros(3), np.array([1.0, 0, 0, 0])) for k in kinds]
    return Scene(
        times,
        ("world", "torso"),
        np.stack((0.0 * line, line), axis=1),
        turn,
        shapes,
        [DrawnCylinder("knee_r", line, line - [0.0, 0.0, 0.3], 0.2, 0.04, 0.016)],
        [Arrows("foot_r", line, 800.0 * line)],
        follow="torso",
    )


def same(one: Recording, other: Recording) -> None:
    np.testing.assert_array_equal(one.time, other.time)
    assert set(one.columns) == set(other.columns)
    for key, values in one.columns.items():
        # pressures stand in bar in an .rrd
        np.testing.assert_allclose(other[key], values, rtol=5e-16 if one.units[key] == "Pa" else 0.0, atol=0.0)
        assert other.units[key] == one.units[key]


@pytest.mark.parametrize("ending", ["parquet", "csv", "rrd"])
def test_round_trip(tmp_path: Path, ending: str) -> None:
    recording = walk()
    path = tmp_path / f"walk.{ending}"
    if ending == "rrd":
        write_rrd(path, recording, scene(recording.time[::10]))
    else:
        write_table(path, recording)
    reading = read(path)
    assert reading.findings == ()
    same(recording, reading.recording)
    if ending != "csv":
        assert reading.recording.metadata == recording.metadata
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@given(runs=st.lists(st.tuples(st.sampled_from([0.0, 1.0, -2.5, np.nan]), st.integers(1, 9)), min_size=2, max_size=12))
def test_a_line_through_the_turns_is_the_signal(runs: list[tuple[float, int]]) -> None:
    values = np.concatenate([np.full(count, value) for value, count in runs])
    kept, time = turns(values), np.arange(len(values)) / 7.0
    if kept is None:
        between = (values[1:-1] == values[:-2]) & (values[1:-1] == values[2:])
        assert 2 * np.count_nonzero(~between) + 4 >= len(values)
        return
    assert kept[0] and kept[-1]
    np.testing.assert_array_equal(np.interp(time, time[kept], values[kept]), values)


def averaged(path: Path) -> dict[str, bool]:
    """Return of which signals the viewer may average neighbours before it draws them."""
    from rerun.chunk import RrdReader

    found = {}
    for chunk in RrdReader(str(path)).stream():
        names = chunk.to_record_batch().schema.names
        if "SeriesLines:names" in names:
            found[".".join(chunk.entity_path.strip("/").rsplit("/", 1))] = "SeriesLines:aggregation_policy" not in names
    return found


def test_what_keeps_its_value_is_written_by_its_turns(tmp_path: Path) -> None:
    recording = walk(4000)
    held = np.repeat(np.random.default_rng(1).uniform(-1.0, 1.0, 40), 100)
    steps = {"supply.pressure": np.full(4000, 7e5), "knee_r.valve_command": held, "hip_r.torque": 5.0 * held}
    recording = replace(recording, columns={**recording.columns, **steps})
    write_rrd(tmp_path / "held.rrd", recording)
    write_rrd(tmp_path / "moving.rrd", walk(4000))
    assert averaged(tmp_path / "held.rrd") == {
        key: key not in ("supply.pressure", "hip_r.torque", "gait.stance_r") for key in recording.columns
    }  # the first column holds the clock, and is whole
    assert (tmp_path / "held.rrd").stat().st_size < 0.85 * (tmp_path / "moving.rrd").stat().st_size
    back = read(tmp_path / "held.rrd")
    same(back.recording, recording)
    assert not back.findings


def test_a_machine_that_rests_keeps_its_clock(tmp_path: Path) -> None:
    recording = walk(2000)
    still = {key: np.repeat([1.0, 2.0], 1000) * (1.0 + number) for number, key in enumerate(UNITS)}
    recording = replace(recording, columns=still)
    write_rrd(tmp_path / "still.rrd", recording)
    same(read(tmp_path / "still.rrd").recording, recording)


@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_tables_are_the_same_byte_for_byte(tmp_path: Path, ending: str) -> None:
    first, second = tmp_path / f"a.{ending}", tmp_path / f"b.{ending}"
    write_table(first, walk())
    write_table(second, walk())
    assert first.read_bytes() == second.read_bytes()


def test_the_first_column_of_a_table_is_the_time(tmp_path: Path) -> None:
    write_table(tmp_path / "a.csv", walk())
    heading = (tmp_path / "a.csv").read_text().splitlines()[0].replace('"', "").split(",")
    assert heading[:3] == ["time [s]", "knee_r.valve_command [1]", "knee_r.pressure_1 [Pa]"]


def test_overlays_do_not_hide_what_was_recorded(tmp_path: Path) -> None:
    recording, before, after = walk(), walk(400, 1), walk(500, 2)
    path = tmp_path / "comparison.rrd"
    write_rrd(path, recording, overlays={"before": before, "after": after}, lanes={"heat": [(0.0, ""), (0.1, "here")]})
    same(recording, read(path).recording)
    from rerun.chunk import RrdReader

    entities = {chunk.entity_path for chunk in RrdReader(str(path)).stream()}
    assert {f"/knee_r/pressure_1/{leaf}" for leaf in ("recorded", "before", "after")} <= entities
    assert "/lanes/heat" in entities
    assert RrdReader(str(path)).blueprints()


def test_a_foreign_rrd(tmp_path: Path) -> None:
    """Other clocks, paths with slashes and no units: said, and used."""
    import rerun as rr

    path = tmp_path / "foreign.rrd"
    stream = rr.RecordingStream("other", recording_id="1")
    stream.save(path)
    fast, slow = np.arange(200) * 1e-3, np.arange(0, 200, 4) * 1e-3
    for name, times in (("piston/pressure_1", fast), ("slide.position", slow), ("piston.valve_command", slow + 5e-4)):
        index = rr.TimeColumn("time", duration=times)
        stream.send_columns(name, indexes=[index], columns=rr.Scalars.columns(scalars=1.0 + times))
    stream.disconnect()
    reading = read(path)
    assert {(f.column, f.kind) for f in reading.findings} == {
        ("piston.pressure_1", "unit"),
        ("slide.position", "unit"),
        ("slide.position", "clock"),
        ("piston.valve_command", "clock"),
    }
    recording = reading.recording
    assert recording.units["slide.position"] == "m"
    np.testing.assert_allclose(recording["slide.position"][:190], 1.0 + fast[:190])
    assert recording["piston.valve_command"][7] == pytest.approx(1.0045)  # held, not interpolated


def test_an_rrd_without_signals(tmp_path: Path) -> None:
    import rerun as rr

    path = tmp_path / "empty.rrd"
    stream = rr.RecordingStream("other", recording_id="1")
    stream.save(path)
    stream.log("words", rr.TextLog("hello"))
    stream.disconnect()
    with pytest.raises(RecordingError, match="holds scalars over time"):
        read(path)


def test_tabs_are_joints() -> None:
    assert list(tabs(walk())) == ["knee_r", "hip_r", "ground", "straps", "supply"]
    more = {**walk().columns, "ankle_r.position": np.zeros(500), "torso_x.position": np.zeros(500)}
    assert tabs(Recording("w", walk().time, more, {}))["other joints"] == [
        "hip_r.position",
        "hip_r.torque",
        "ankle_r.position",
        "torso_x.position",
    ]
    bench = Recording("b", np.arange(3.0), {k: np.zeros(3) for k in ("piston.pressure_1", "slide.position")}, {})
    assert tabs(bench) == {"piston and slide": ["piston.pressure_1", "slide.position"]}


def test_gait_lanes() -> None:
    lanes = gait_lanes(walk(250))
    assert lanes == {
        "right foot": [(0.0, "stance"), (0.06, "swing"), (0.1, "stance"), (0.16, "swing"), (0.2, "stance")]
    }


def test_cylinders_point_from_cap_to_end() -> None:
    rng = np.random.default_rng(0)
    along = rng.standard_normal((50, 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    along[0] = (0.0, 0.0, -1.0)
    x, y, z, w = _turning_z_to(along).T
    turned = np.stack((2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)), axis=1)
    np.testing.assert_allclose(turned, along, atol=1e-9)


def test_writing_where_one_cannot(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError):
        write_table(tmp_path / "file" / "a.parquet", walk())
    with pytest.raises(OutputError, match=r"ends in \.parquet, \.csv or \.sto"):
        write_table(tmp_path / "a.xlsx", walk())
    with pytest.raises(OutputError):
        write_rrd(tmp_path / "file" / "a.rrd", walk())


def test_a_recording_that_finds_no_room_is_one_error_and_leaves_nothing(tmp_path: Path) -> None:
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, before[1]))
    try:
        with pytest.raises(OutputError, match=r'cannot write ".*walk.rrd": .*write elsewhere'):
            write_rrd(tmp_path / "walk.rrd", walk(20000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_is_said_and_nobody_waits() -> None:
    with pytest.raises(OutputError, match='"/dev/full": the disk is full'):
        write_rrd("/dev/full", walk(40000))


def test_what_cannot_be_drawn_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no such lane"):
        write_rrd(tmp_path / "walk.rrd", walk(), lanes={"heat": _Broken([(0.0, "here")])})
    assert not list(tmp_path.iterdir())


class _Broken(list[tuple[float, str]]):
    def __iter__(self) -> Iterator[tuple[float, str]]:
        raise ValueError("no such lane")


@pytest.mark.parametrize(("names", "thin"), [(("before", "after"), "recorded"), (("simulated", "free_run"), "simulated")])
def test_the_overlay_that_the_viewer_draws_last_is_thin(tmp_path: Path, names: tuple[str, ...], thin: str) -> None:
    """It draws in the order of names; a thick line on top would hide the others."""
    from rerun.chunk import RrdReader

    time = np.arange(50) / 100.0
    recording = Recording("r", time, {"p.pressure_1": 1e5 + time}, {"p.pressure_1": "Pa"})
    write_rrd(tmp_path / "a.rrd", recording, overlays=dict.fromkeys(names, recording))
    widths = {}
    for chunk in RrdReader(str(tmp_path / "a.rrd")).stream():
        batch = chunk.to_record_batch()
        if "SeriesLines:widths" in batch.schema.names and chunk.entity_path.replace("\\", "").startswith("/p/pressure_1/"):
            widths[chunk.entity_path.rsplit("/", 1)[-1]] = batch.column("SeriesLines:widths")[0].as_py()[0]
    drawn = {name: width for name, width in widths.items() if name in ("recorded", *names)}
    assert set(drawn) == {"recorded", *names}
    assert min(drawn, key=drawn.__getitem__) == thin == max(drawn)


def test_plots_name_their_units() -> None:
    assert words("knee_r.position", "rad") == "knee_r: joint position, rad"
    assert words("knee_r.valve_command", "1") == "knee_r: valve command"
