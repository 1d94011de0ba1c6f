"""What people meet in the viewer: a tree by part, pressures in bar, one unit a plot; and the way back to a table."""

import numpy as np
import pytest

from exo_sim.errors import RecordingError
from exo_sim.recording import Recording, read, write_rrd
from exo_sim.recording.blueprint import plots, tabs
from exo_sim.recording.reader import read_overlay

UNITS = {
    "hip_l.pressure_1": "Pa", "hip_l.position": "rad", "slide.position": "m", "hip_l.torque": "N*m", "slide.external_force": "N",
    "slide.torque": "N",
}  # fmt: skip
TIME = np.arange(200) / 100.0


def machine(offset: float = 0.0) -> Recording:
    columns = {key: np.sin(TIME + i) * 1e5 ** (unit == "Pa") + offset for i, (key, unit) in enumerate(UNITS.items())}
    return Recording("r", TIME, columns, UNITS)


def chunks(path):
    from rerun.chunk import RrdReader

    return list(RrdReader(str(path)).stream())


def test_the_tree_goes_by_part_and_pressures_are_in_bar(tmp_path):
    write_rrd(tmp_path / "r.rrd", machine())
    found = {chunk.entity_path: chunk.to_record_batch() for chunk in chunks(tmp_path / "r.rrd") if not chunk.is_static}
    assert {"/hip_l/pressure_1", "/hip_l/position", "/slide/position"} <= found.keys()
    values = found["/hip_l/pressure_1"].column("Scalars:scalars").flatten().to_numpy()
    np.testing.assert_allclose(values, np.sin(TIME))  # 1e5 Pa are a bar
    units = {
        chunk.entity_path: batch.column("unit")[0].as_py()[0] for chunk in chunks(tmp_path / "r.rrd")
        if chunk.is_static and "unit" in (batch := chunk.to_record_batch()).schema.names
    }  # fmt: skip
    assert units["/hip_l/pressure_1"] == "bar" and units["/hip_l/position"] == "rad" and units["/slide/position"] == "m"


def test_no_plot_holds_two_units():
    recording = machine()
    for keys in tabs(recording).values():
        for title, shown in plots(keys, recording.units):
            assert len({recording.units[key] for key in shown}) == 1, title
    titles = [title for title, _ in plots(list(UNITS), UNITS)]
    assert titles == ["pressure, bar", "joint load, N*m", "joint load, N", "position, rad", "position, m"]


def test_what_was_simulated_is_read_back_as_well(tmp_path):
    overlays = {"before": machine(3.0), "after": machine(1.0)}
    write_rrd(tmp_path / "r.rrd", machine(), overlays=overlays)
    np.testing.assert_allclose(read(tmp_path / "r.rrd").recording["hip_l.pressure_1"], machine()["hip_l.pressure_1"], atol=1e-9)
    for name, simulated in overlays.items():
        back = read_overlay(tmp_path / "r.rrd", name).recording
        assert back.columns.keys() == simulated.columns.keys()
        np.testing.assert_allclose(back["hip_l.pressure_1"], simulated["hip_l.pressure_1"], atol=1e-9)
    with pytest.raises(RecordingError, match='holds no signal "free_run"'):
        read_overlay(tmp_path / "r.rrd", "free_run")
    with pytest.raises(RecordingError, match='did you mean "before"'):
        read_overlay(tmp_path / "r.rrd", "befor")


def test_a_part_with_a_point_in_its_name_comes_back(tmp_path):
    recording = Recording("r", TIME, {"left.arm.pressure_1": 1e5 + TIME}, {"left.arm.pressure_1": "Pa"})
    write_rrd(tmp_path / "r.rrd", recording)
    assert list(read(tmp_path / "r.rrd").recording.columns) == ["left.arm.pressure_1"]


def test_the_older_names_are_still_read(tmp_path):
    import rerun as rr

    stream = rr.RecordingStream("older")
    stream.save(str(tmp_path / "old.rrd"))
    for path in ("piston.pressure_1", "piston.pressure_2/recorded", "supply/pressure"):
        stream.log(path.removesuffix("/recorded"), rr.AnyValues(unit="Pa"), static=True)
        columns = rr.Scalars.columns(scalars=1e5 + TIME)
        stream.send_columns(path, indexes=[rr.TimeColumn("time", duration=TIME)], columns=columns)
    stream.disconnect()
    back = read(tmp_path / "old.rrd").recording
    assert set(back.columns) == {"piston.pressure_1", "piston.pressure_2", "supply.pressure"}
    np.testing.assert_array_equal(back["piston.pressure_2"], 1e5 + TIME)
