import numpy as np
from report import made_up_diagnoses as made_up

from exo_sim.recording import Recording, read
from exo_sim.report.comparison import write_comparison


def test_a_reader_gets_back_what_was_recorded_not_what_was_simulated(tmp_path):
    diagnosis = made_up.whole()
    time = diagnosis.series[0].time
    command = np.sign(np.sin(time))
    recording = Recording("monday", time, {"piston.valve_command": command}, {"piston.valve_command": "1"})
    write_comparison(tmp_path / "comparison.rrd", diagnosis, [recording])
    back = read(tmp_path / "comparison.rrd").recording
    np.testing.assert_allclose(back["piston.pressure_1"], diagnosis.series[0].recorded)
    np.testing.assert_allclose(back["piston.valve_command"], command)
    assert back.units["piston.pressure_1"] == "Pa"


def test_overlays_differences_and_lanes_are_in_the_file(tmp_path):
    from rerun.chunk import RrdReader

    write_comparison(tmp_path / "comparison.rrd", made_up.whole())
    entities = {str(chunk.entity_path).replace("\\", "") for chunk in RrdReader(str(tmp_path / "comparison.rrd")).stream()}
    for leaf in ("recorded", "before", "after"):
        assert f"/piston/pressure_1/{leaf}" in entities
    assert {"/difference/piston/pressure_1/before", "/difference/piston/pressure_1/after"} <= entities
    assert {"/lanes/piston_chamber_1_energy_balance", "/lanes/held_out"} <= entities


def test_recordings_follow_each_other_on_one_clock(tmp_path):
    names = ("monday", "tuesday")
    every = tuple(s for name in names for s in made_up.series(name))
    diagnosis = made_up.whole(recordings=names, series=every, held_out={"tuesday": ((4.2, 6.0),)})
    write_comparison(tmp_path / "comparison.rrd", diagnosis)
    back = read(tmp_path / "comparison.rrd").recording
    first = every[0]
    assert len(back.time) == 2 * len(first.time)
    assert (np.diff(back.time) > 0.0).all()
    np.testing.assert_allclose(back["piston.pressure_1"][len(first.time) :], first.recorded)


def test_a_long_recording_is_thinned_and_keeps_its_span(tmp_path, monkeypatch):
    monkeypatch.setattr("exo_sim.report.comparison.MOST_SHOWN", 500)
    write_comparison(tmp_path / "comparison.rrd", made_up.whole())
    back = read(tmp_path / "comparison.rrd").recording
    whole = made_up.series()[0]
    assert len(back.time) == 400
    np.testing.assert_allclose(back["piston.pressure_1"], whole.recorded[::3])
