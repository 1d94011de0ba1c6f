"""`import exo_sim as exo`: objects in, objects out; what the command says, said by the same functions."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import benches
import numpy as np
import pytest

import exo_sim as exo
from exo_sim import cli
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions

#: What no type checker would let through.
NO_PATH: Any = 3


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> tuple[exo.Rig, exo.Recording]:
    """A bench and a recording of it, in memory."""
    rig = benches.bench(tmp_path_factory.mktemp("bench"))
    return exo.Rig.load(rig.path), exo.Recording.of(benches.recorded(rig, 1.5))


def test_importing_loads_nothing_heavy() -> None:
    heavy = ("numpy", "mujoco", "numba", "pyarrow", "rerun", "matplotlib", "pandas", "click", "pint")
    code = f"import sys, exo_sim as exo; dir(exo); print([name for name in {heavy} if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"


def test_the_stub_names_what_is_there() -> None:
    """Editors and type checkers read the stub; it must not drift from the module."""
    stub = (Path(exo.__file__).parent / "__init__.pyi").read_text()
    named = {line.rsplit(" as ", 1)[1] for line in stub.splitlines() if " as " in line}
    module: Any = exo
    assert named == set(module._API)
    for name in named:
        assert getattr(exo, name) is not None
    with pytest.raises(AttributeError):
        module.nothing  # noqa: B018


def test_a_rig_goes_out_and_comes_back(tmp_path: Path, bench: tuple[exo.Rig, exo.Recording]) -> None:
    rig, _ = bench
    saved = exo.Rig.load(rig.save(tmp_path / "deep" / "down" / "rig.toml"))
    assert saved.cylinders == rig.cylinders and saved.model.resolve() == rig.model.resolve()
    assert saved.mujoco_model().nq == rig.mujoco_model().nq
    other = rig.changed({"supply.pressure": "6 bar", "effects.piston_leakage.piston.area": "0.03 mm^2", "name": "other"})
    assert (other.supply.pressure, other.name) == (6e5, "other") and rig.supply.pressure != 6e5
    leak = other.effect("piston_leakage", "piston")
    assert leak is not None and leak.parameters["area"] == pytest.approx(3e-8)
    assert not other.changed({"effects": None}).effects
    for words in (str(other), repr(other), other._repr_html_()):
        assert "other" in words


def test_a_rig_whose_text_is_no_longer_true_is_not_saved(tmp_path: Path) -> None:
    from dataclasses import replace

    with pytest.raises(exo.ExoSimError, match=r"rig\.changed"):
        replace(exo.Rig.included("bench"), heat_capacity_ratio=1.3).save(tmp_path / "rig.toml")


@pytest.mark.parametrize("call, says", [
    (lambda: exo.Rig.load("absent.toml"), "no such rig"),
    (lambda: exo.Rig.included("benhc"), 'did you mean "bench"'),
    (lambda: exo.Rig.included("bench").changed({"supply.pressure": "6 barg"}), "gauge"),
    (lambda: exo.Rig.included("bench").changed({"supply.presure": "6 bar"}), "presure"),
    (lambda: exo.Rig.included("bench").changed({"name.first": "x"}), "holds a value"),
    (lambda: exo.Rig.included("bench").changed({"gas.colour": None}), "no such key"),
    (lambda: exo.Recording.load("absent.csv"), "no such recording"),
    (lambda: exo.Recording.from_columns({"time [s]": range(20), "p.pressure_1 [Pa]": range(19)}), "shape"),
    (lambda: exo.Recording.from_columns({"time [s]": range(20), "p.pressure_1 [Pa]": ["x"] * 20}), "no number"),
    (lambda: exo.Recording.from_columns({"p.pressure_1 [Pa]": range(20)}), "time"),
    (lambda: exo.Recording("r", np.arange(3.0), {"p.pressure_1": np.arange(3.0)}, {}), "no unit"),
    (lambda: exo.effects["wall_heat"], 'did you mean "wall_heat_transfer"'),
    (lambda: exo.simulate(payload="34 m"), "payload"),
    (lambda: exo.simulate(payload=-1.0), "payload"),
    (lambda: exo.simulate(scenario="level_wlak"), 'did you mean "level_walk"'),
    (lambda: exo.simulate(rig=NO_PATH), "a rig is a path"),
    (lambda: exo.compare(NO_PATH, exo.Rig.included("bench")), "a recording is a path"),
    (lambda: exo.diagnose([], exo.Rig.included("bench")), "no recording"),
    (lambda: exo.size(jobs=0), "jobs"),
])  # fmt: skip
def test_errors_are_one_line_that_says_what_to_do(call: Callable[[], object], says: str) -> None:
    with pytest.raises(exo.ExoSimError, match=says) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_tables_in_memory_become_recordings_and_back(bench: tuple[exo.Rig, exo.Recording]) -> None:
    pandas = pytest.importorskip("pandas")
    _, recording = bench
    frame = recording.to_pandas()
    assert frame.index.name == "time [s]" and "piston.pressure_1 [Pa]" in frame
    again = exo.Recording.from_pandas(frame, name="mine")
    assert again.name == "mine" and again.units == recording.units
    np.testing.assert_array_equal(again["piston.pressure_1"], recording["piston.pressure_1"])
    foreign = pandas.DataFrame({"t": 1e3 * recording.time, "P1": recording["piston.pressure_1"] / 1e5 - 1.01325})
    columns = {"t": "time [ms]", "P1": {"column": "piston.pressure_1 [bar]", "offset": 1.01325}}
    mapped = exo.Recording.from_pandas(foreign, columns=columns)
    np.testing.assert_allclose(mapped["piston.pressure_1"], recording["piston.pressure_1"])
    np.testing.assert_allclose(mapped.time, recording.time)


def test_xarray_knows_units(bench: tuple[exo.Rig, exo.Recording]) -> None:
    pytest.importorskip("xarray")
    data = bench[1].to_xarray()
    assert data["piston.pressure_1"].attrs["units"] == "Pa" and data.sizes["time"] == len(bench[1])


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_a_recording_goes_out_and_comes_back(tmp_path: Path, bench: tuple[exo.Rig, exo.Recording], ending: str) -> None:
    _, recording = bench
    again = exo.Recording.load(recording.save(tmp_path / f"r{ending}"))
    assert isinstance(again.span(0.1, 0.2), exo.Recording)
    for key in recording.columns:
        np.testing.assert_array_equal(again[key], recording[key])


def test_a_comparison_says_what_the_command_says(
    tmp_path: Path, bench: tuple[exo.Rig, exo.Recording], capsys: pytest.CaptureFixture[str]
) -> None:
    rig, recording = bench
    found = exo.compare(recording, rig)
    recording.save(tmp_path / "recorded.parquet")
    words = ["compare", str(tmp_path / "recorded.parquet"), "--rig", str(rig.path), "--out", str(tmp_path / "c.rrd"), "--json"]
    assert cli.main([*words, "--quiet"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert {key: printed[key] for key in found.summary} == json.loads(json.dumps(found.summary))
    assert "piston.pressure_1" in str(found) and "piston.pressure_1" in found._repr_html_()
    assert found.plot()._repr_png_().startswith(b"\x89PNG")


def test_text_in_a_notebook_is_escaped(bench: tuple[exo.Rig, exo.Recording]) -> None:
    rig, recording = bench
    assert "<script>" not in rig.changed({"name": "<script>"})._repr_html_()
    assert "<td>piston.pressure_1</td>" in recording._repr_html_()


@pytest.mark.slow
def test_a_recording_in_memory_is_diagnosed_and_the_better_rig_is_a_rig(tmp_path: Path) -> None:
    """What leaks is found without a file in between; the improved rig runs, saves and loads."""
    case = make_case("case", effects=("piston_leakage",), seed=11, size=1.0, conditions=Conditions(known=(), duration=12.0))
    write_case(case, tmp_path / "case", "csv", open_truth=True)
    truth = json.loads((tmp_path / "case" / "truth.json").read_text())["hidden"][0]["parameters"]["area"]["value"]
    frame = exo.Recording.load(tmp_path / "case" / "recording.csv").to_pandas()
    recording, nominal = exo.Recording.from_pandas(frame), exo.Rig.load(tmp_path / "case" / "rig.toml")
    found = exo.diagnose(recording, nominal)
    assert found.verdict == "mismatch" and "piston_leakage" in [one.name for one in found.findings]
    assert found.nominal is found.believed and found.nominal.effects == nominal.effects
    leak = found.rig.effect("piston_leakage", "piston")
    assert leak is not None and leak.parameters["area"] == pytest.approx(truth, rel=0.05)
    assert all(one.after < one.before for key, one in found.fit.items() if key.startswith("piston.pressure"))
    better, worse = exo.compare(recording, found.rig), exo.compare(recording, nominal)
    key = "piston.pressure_1"
    assert better.signals[key]["windowed_rms"] < 0.5 * worse.signals[key]["windowed_rms"]
    folder = found.save(tmp_path / "elsewhere" / "found")
    assert {path.name for path in folder.iterdir()} == {"report.html", "improved.toml", "comparison.rrd", "diagnosis.json"}
    saved = exo.Rig.load(folder / "improved.toml")
    assert saved.effects == found.rig.effects and saved.mujoco_model().nq == nominal.mujoco_model().nq
    assert "piston leakage" in str(found) and "leakage" in found._repr_html_()
    assert found.plot()._repr_png_().startswith(b"\x89PNG")


@pytest.mark.slow
def test_a_walk_in_memory_is_the_walk_of_the_command(tmp_path: Path) -> None:
    ran = exo.simulate(payload="20 kg", strides=2)
    written = exo.simulate(payload=20.0, strides=2, out=tmp_path / "walk.rrd")
    assert ran.summary.keys() == written.summary.keys()
    assert ran.summary["joints"] == written.summary["joints"]
    np.testing.assert_array_equal(ran.recording["knee_r.torque"], written.recording["knee_r.torque"])
    ran.save(tmp_path / "again.rrd")
    assert exo.Recording.load(tmp_path / "again.rrd")["knee_r.position"].shape == ran.recording.time.shape
    written.save(tmp_path / "copy.rrd")
    assert (tmp_path / "copy.parquet").read_bytes() == (tmp_path / "walk.parquet").read_bytes()
    assert "knee_r" in str(ran) and ran.plot()._repr_png_()


def test_the_doctor_finds_what_is_there_and_says_what_is_not(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from importlib import metadata

    found = {check.what: check for check in exo.doctor().checks}
    assert found["numpy"].state == "ok" and found["numpy"].says == np.__version__
    assert found["included machine"].state == "ok"

    def absent(name: str) -> str:
        if name in ("click", "pandas"):
            raise metadata.PackageNotFoundError(name)
        return "0.0.1" if name == "numpy" else "999.0"

    monkeypatch.setattr(metadata, "version", absent)
    monkeypatch.setattr(metadata, "requires", lambda name: ["click>=8.2", "numpy>=2.0", 'pandas>=2.2; extra == "notebook"'])
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("EXO_SIM_CACHE", str(tmp_path / "file"))
    ill = exo.doctor()
    state = {check.what: (check.state, check.says) for check in ill.checks}
    assert state["click"][0] == state["numpy"][0] == "fault" and ">=2.0" in state["numpy"][1]
    assert state["pandas"][0] == "missing" and "exo-sim-pneumatic[notebook]" in state["pandas"][1]
    assert state["compiled code"][0] == "missing" and "EXO_SIM_CACHE" in state["compiled code"][1]
    assert ill.exit_status == 2 and not ill.summary["works"]


def test_the_doctor_says_which_part_a_python_cannot_have(monkeypatch: pytest.MonkeyPatch) -> None:
    from importlib import metadata

    def absent(name: str) -> str:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "requires", lambda name: ['dm-control>=1.0.50; python_version < "3"', 'numpy>=2.0; python_version > "3"'])
    monkeypatch.setattr(metadata, "version", absent)
    state = {check.what: (check.state, check.says, check.needed_by) for check in exo.doctor().checks}
    assert state["dm-control"][0] == "missing" and "cannot be installed on Python 3" in state["dm-control"][1]
    assert state["dm-control"][2] == "environments.load (dm_env)"
    assert state["numpy"][:2] == ("fault", "pip install 'numpy>=2.0'")


def test_a_bench_follows_a_motion_in_memory(tmp_path: Path) -> None:
    time = np.arange(0.0, 1.0, 0.01)
    motion = exo.Recording.from_columns({"time [s]": time, "slide.position [mm]": 80.0 + 30.0 * np.sin(3.0 * time)}, name="swing")
    ran = exo.simulate(exo.Rig.included("bench"), motion)
    assert "slide" in str(ran) and ran.path is None
    saved = exo.Recording.load(ran.save(tmp_path / "swing.rrd"))
    assert np.abs(np.interp(time[50:], saved.time, saved["slide.position"]) - motion["slide.position"][50:]).max() < 5e-3


class Open:
    """A controller that opens every valve a little, now and then."""

    def reset(self, context: Any) -> None:
        self.cylinders = context.cylinders

    def act(self, observation: dict[str, float]) -> dict[str, float]:
        return dict.fromkeys(self.cylinders, 0.1 if observation["time"] % 0.2 < 0.1 else -0.1)


def test_a_controller_of_ones_own_moves_the_bench() -> None:
    time = np.arange(0.0, 0.5, 0.01)
    motion = exo.Recording.from_columns({"time [s]": time, "slide.position [mm]": np.full(50, 80.0)}, name="hold")
    ran = exo.simulate(exo.Rig.included("bench"), motion, controller=Open)
    assert set(np.unique(np.round(ran.recording["piston.valve_command"], 6))) <= {-0.1, 0.0, 0.1}


def test_commands_far_beyond_full_are_told_after_a_walk() -> None:
    class Torques:
        def reset(self, context: Any) -> None: ...

        def act(self, observation: dict[str, float]) -> dict[str, float]:
            return {"knee_r": 3.0}

    said: list[str] = []
    ran = exo.simulate(scenario="level_walk", strides=1, demand="inverse_dynamics", controller=Torques(), tell=said.append)
    (words,) = [each for each in said if "beyond -1 to 1" in each]
    assert '"knee_l.torque"' in words and words in ran.summary["remarks"] and said == list(ran.remarks)


@pytest.mark.parametrize("named", [True, False], ids=["a stream", "the recording in use"])
def test_a_model_is_logged_by_itself_and_read_back(tmp_path: Path, named: bool) -> None:
    """A ball that falls: its pose is in the file at every time that it was logged, its shape once."""
    import mujoco
    import rerun as rr
    from rerun.chunk import RrdReader

    text = "<mujoco><worldbody><body name='ball' pos='0 0 1'><freejoint/><geom size='0.1'/></body></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    data, stream = mujoco.MjData(model), rr.RecordingStream("test")
    stream.save(tmp_path / "ball.rrd")
    with stream:
        for _ in range(5):
            mujoco.mj_step(model, data, 10)
            exo.log_model(model, data, stream) if named else exo.log_model(model, data)
    stream.flush()
    stream.disconnect()
    chunks = [chunk for chunk in RrdReader(str(tmp_path / "ball.rrd")).stream() if "ball" in chunk.entity_path]
    assert sum(chunk.to_record_batch().num_rows for chunk in chunks if not chunk.is_static) == 5
    assert sum(chunk.is_static for chunk in chunks) == 1
