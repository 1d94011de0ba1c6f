from dataclasses import replace

import benches
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import RecordingError
from exo_sim.simulation.replay import replay, rms
from exo_sim.simulation.replay.inputs import held, steps, window_starts


def errors(recording, out):
    return {key: rms(recording[key], out.free_run[key]) for key in out.free_run.columns}


def test_a_free_run_repeats_what_the_plug_in_did_step_by_step(tmp_path):
    rig = benches.bench(
        tmp_path,
        '[effects.coulomb_friction.piston]\nforce = "8 N"\n[effects.valve_lag.piston]\ntime_constant = "6 ms"\ndelay = "3 ms"\n'
        '[effects.line_restriction.piston]\narea = "8 mm^2"\nvolume = "4 cm^3"\nsensor = "chamber"\n'
        '[effects.viscous_friction.slide]\ncoefficient = "30 N*s/m"\n',
    )
    recording = benches.recorded(rig)
    out = replay(recording, rig)
    assert not out.imposed
    off = errors(recording, out)
    # only the start differs: the plug-in knows its state, the replay smooths what was recorded
    assert off["piston.pressure_1"] < 50.0 and off["piston.pressure_2"] < 50.0
    assert off["slide.position"] < 2e-5
    assert np.ptp(recording["slide.position"]) > 0.05 and np.ptp(recording["piston.pressure_1"]) > 1e5
    for key, bound in (("piston.pressure_1", 500.0), ("piston.pressure_2", 500.0), ("slide.position", 1e-4)):
        assert rms(recording[key], out.windowed[key]) < bound


def test_a_window_that_puts_the_piston_right_leaves_the_gas_of_a_hose_alone(tmp_path):
    hose = '[effects.line_restriction.piston]\narea = "2 mm^2"\nvolume = "60 cm^3"\nsensor = "SENSOR"\n'
    for sensor in ("chamber", "valve"):
        believed = benches.bench(tmp_path, hose.replace("SENSOR", sensor))
        recording = benches.recorded(believed)
        damped = rigs.parse(f'{believed.text}[effects.viscous_friction.slide]\ncoefficient = "60 N*s/m"\n', believed.path)
        out = replay(recording, damped, window=0.1)
        for side in (1, 2):  # a leap of the piston pressed the chamber together, and the hose took it over
            key = f"piston.pressure_{side}"
            assert rms(recording[key], out.windowed[key]) < rms(recording[key], out.free_run[key])


def test_a_valve_with_independent_edges_is_repeated_from_its_two_commands(tmp_path):
    rig = benches.bench(tmp_path, '[effects.valve_lag.piston]\ntime_constant = "6 ms"\ndelay = "3 ms"\n')
    rig = rigs.parse(rig.text.replace('area = "2 mm^2"', 'kind = "independent"\narea = "2 mm^2"\narea_exhaust_2 = "3 mm^2"'), rig.path)
    recording = benches.recorded(rig)
    out = replay(recording, rig)
    assert not out.imposed
    off = errors(recording, out)
    assert off["piston.pressure_1"] < 50.0 and off["piston.pressure_2"] < 50.0 and off["slide.position"] < 2e-5
    apart = recording["piston.valve_command_1"] + recording["piston.valve_command_2"]
    assert np.abs(apart).max() > 0.4  # what one spool could not do


def test_gas_in_a_led_piston_follows_the_adiabat(tmp_path):
    rig = benches.bench(tmp_path)
    recording = benches.led(rig)
    out = replay(recording, rig)
    assert list(out.imposed) == ["slide"] and "power" in out.imposed["slide"]
    assert set(out.free_run.columns) == {"piston.pressure_1", "piston.pressure_2"}
    for key in out.free_run.columns:
        swing = np.ptp(recording[key])
        assert rms(recording[key], out.free_run[key]) < 1e-3 * swing
        assert rms(recording[key], out.windowed[key]) < 1e-3 * swing


def test_several_clocks_give_the_same_prediction(tmp_path):
    rig = benches.bench(tmp_path)
    even = benches.led(rig)
    chance = np.random.default_rng(3)
    jitter = even.time + chance.uniform(-4e-4, 4e-4, even.time.size)
    uneven = benches.recording(jitter, {key: np.interp(jitter, even.time, values) for key, values in even.columns.items()})
    slow = benches.recording(even.time[::25], {key: values[::25] for key, values in even.columns.items()})
    for recording in (uneven, slow):
        out = replay(recording, rig, motion="recorded")
        assert rms(recording["piston.pressure_1"], out.free_run["piston.pressure_1"]) < 0.01 * np.ptp(even["piston.pressure_1"])


def test_a_mass_without_cylinder_obeys_the_recorded_force(tmp_path):
    rig = benches.bench(tmp_path, cylinder=False)
    time = np.arange(3000) / 1000.0
    force = 20.0 * np.cos(3.0 * time)
    position = 20.0 / 8.0 / 9.0 * (1.0 - np.cos(3.0 * time))
    recording = benches.recording(time, {"slide.position": position, "slide.external_force": force})
    out = replay(recording, rig)
    assert set(out.free_run.columns) == {"slide.position"} and not out.imposed
    assert rms(position, out.free_run["slide.position"]) < 2e-5
    assert rms(position, out.windowed["slide.position"]) < 2e-6


def test_a_noisy_position_lets_a_run_stray_by_no_more_than_its_noise(tmp_path):
    rig = benches.bench(tmp_path, cylinder=False)
    time = np.arange(3000) / 1000.0
    position = 20.0 / 8.0 / 9.0 * (1.0 - np.cos(3.0 * time)) + 0.2 * time  # at 0.2 m/s from the first sample on
    noisy = position + 1e-3 * np.random.default_rng(8).standard_normal(time.size)
    columns = {"slide.position": noisy, "slide.external_force": 20.0 * np.cos(3.0 * time)}
    out = replay(benches.recording(time, columns), rig)
    assert rms(position, out.free_run["slide.position"]) < 4e-2  # from 15 ms of samples a rate of 0.12 m/s more or less: 0.2 m
    assert rms(position, out.windowed["slide.position"]) < 1e-3


def test_sensors_of_the_rig_are_taken_off_before_and_put_on_after(tmp_path):
    plain = benches.bench(tmp_path)
    true = benches.recorded(plain)
    late = np.interp(true.time - 0.004, true.time, true["slide.position"])
    columns = dict(true.columns) | {"piston.pressure_1": 1.05 * true["piston.pressure_1"] + 8e3, "slide.position": late}
    seen = benches.recording(true.time, columns)
    rig = benches.bench(
        tmp_path,
        '[effects.sensor_bias."piston.pressure_1"]\nvalue = "8 kPa"\n[effects.sensor_scale."piston.pressure_1"]\nfactor = 1.05\n'
        '[effects.sensor_delay."slide.position"]\nseconds = "4 ms"\n',
    )
    known, unknown = replay(seen, rig, motion="predicted"), replay(seen, plain, motion="predicted")
    for key, bound in (("piston.pressure_1", 900.0), ("piston.pressure_2", 900.0), ("slide.position", 2e-4)):
        assert rms(seen[key], known.windowed[key]) < bound
        assert rms(seen[key], unknown.windowed[key]) > 3.0 * rms(seen[key], known.windowed[key])


def test_a_joint_that_its_cylinder_moves_is_not_taken_for_led_even_with_late_or_offset_sensors(tmp_path):
    rig = benches.bench(tmp_path)
    true = benches.recorded(rig)
    late = np.interp(true.time - 0.02, true.time, true["slide.position"])
    for changed in ({"slide.position": late}, {"piston.pressure_2": true["piston.pressure_2"] - 101325.0}):
        assert not replay(replace(true, columns=dict(true.columns) | changed), rig).imposed


def test_a_joint_that_never_moves_is_held(tmp_path):
    rig = benches.bench(tmp_path)
    true = benches.recorded(rig)
    still = replace(true, columns=dict(true.columns) | {"slide.position": np.zeros_like(true.time)})
    assert replay(still, rig).imposed == {"slide": "it never moves, so something holds it"}


def test_no_window_runs_across_a_jump_of_the_clock():
    time = np.concatenate([np.arange(1000) / 1000.0, 5.0 + np.arange(700) / 1000.0])
    pieces = steps(time, 1e-3)
    assert [len(piece.time) for piece in pieces] == [1000, 700]
    starts = window_starts(pieces, 0.5, time, ())
    assert list(starts) == [0, 500, 1000]
    assert list(window_starts(pieces, np.inf, time, ())) == [0, 1000]


def test_a_held_command_keeps_its_mean_on_other_steps():
    time = np.array([0.0, 0.0013, 0.0021, 0.0048, 0.006])
    values = np.array([1.0, -1.0, np.nan, 0.5, 0.5])
    out = held(steps(np.array(time), 1e-3), time, values)
    assert out[0] == pytest.approx(1.0)
    assert out[1] == pytest.approx(0.3 * 1.0 - 0.7)
    assert out[:6].sum() * 1e-3 == pytest.approx(0.0013 - 0.0035 + 0.5 * 0.0012)


def test_missing_samples_and_jumps_leave_the_rest_predicted(tmp_path):
    rig = benches.bench(tmp_path)
    true = benches.recorded(rig)
    columns = {key: values.copy() for key, values in true.columns.items()}
    columns["piston.pressure_1"][500:620] = np.nan
    columns["slide.position"][1000:1004] = np.nan
    time = np.where(np.arange(3000) >= 2000, true.time + 40.0, true.time)
    recording = replace(true, time=time, columns=columns)
    out = replay(recording, rig, motion="predicted")
    assert rms(columns["slide.position"], out.windowed["slide.position"]) < 1e-3
    assert np.isfinite(out.free_run["piston.pressure_1"]).all()


def test_what_leaves_all_bounds_is_not_a_number_and_no_crash(tmp_path):
    rig = benches.bench(tmp_path, cylinder=False)
    time = np.arange(1000) / 1000.0
    force = np.where(time > 0.3, 1e12, 0.0)
    recording = benches.recording(time, {"slide.position": 0.01 * np.sin(time), "slide.external_force": force})
    out = replay(recording, rig)
    assert np.isnan(rms(recording["slide.position"], out.free_run["slide.position"]))
    assert np.isfinite(out.free_run["slide.position"][:300]).all()


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ({"piston": "pistn"}, 'no valve command and no pressure of cylinder "piston".*did you mean "pistn"'),
        ({"piston": "wheel", "slide": "axle"}, "it holds wheel, axle, but the rig .* has piston, slide"),
    ],
)
def test_the_recording_of_another_machine_is_refused_in_one_line(tmp_path, names, words):
    rig = benches.bench(tmp_path)
    true = benches.recorded(rig, 0.2)
    columns = {f"{names.get(key.split('.')[0], key.split('.')[0])}.{key.split('.')[1]}": v for key, v in true.columns.items()}
    with pytest.raises(RecordingError, match=words) as error:
        replay(benches.recording(true.time, columns), rig)
    assert "\n" not in str(error.value)


def test_without_a_position_nothing_can_be_predicted(tmp_path):
    rig = benches.bench(tmp_path)
    true = benches.recorded(rig, 0.2)
    columns = {key: values for key, values in true.columns.items() if key != "slide.position"}
    with pytest.raises(RecordingError, match="nothing in it can be predicted"):
        replay(benches.recording(true.time, columns), rig)


def test_a_clock_that_is_not_in_seconds_is_refused(tmp_path):
    rig = benches.bench(tmp_path)
    true = benches.recorded(rig, 0.2)
    with pytest.raises(RecordingError, match="is its clock in seconds"):
        replay(replace(true, time=true.time * 1e6), rig)
