"""A machine drawn where it was recorded to be, and shapes of every kind that a model may have."""

import mujoco
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.recording import Recording, write_rrd
from exo_sim.recording.scene import shapes_of_model
from exo_sim.simulation.machine_scene import MOST_FRAMES, recorded_scene

TETRAHEDRON = """
<mujoco>
  <asset><mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  0 0 1" face="0 2 1  0 1 3  0 3 2  1 2 3"/></asset>
  <worldbody><body name="part" pos="0 0 1"><freejoint/><geom name="wedge" type="mesh" mesh="wedge" mass="1"/></body></worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def bench(repository):
    return rigs.read(repository / "assets" / "bench.toml")


def test_the_slide_goes_where_it_was_recorded(bench):
    time = np.arange(0.0, 3.0, 0.004)
    position = 0.08 + 0.05 * np.sin(2.0 * time)
    position[100:130] = np.nan
    recording = Recording("r", time, {"slide.position": position}, {"slide.position": "m"})
    scene = recorded_scene(recording, bench)
    assert scene is not None and len(scene.times) == round(50 * (time[-1] - time[0])) + 1
    moved = scene.positions - scene.positions[:1]
    body = int(np.argmax(np.abs(moved).max(axis=(0, 2))))
    went = np.linalg.norm(moved[:, body], axis=1)
    np.testing.assert_allclose(went, np.abs(0.05 * np.sin(2.0 * scene.times)), atol=5e-4)


def test_a_machine_without_recorded_positions_is_not_drawn(bench):
    time = np.arange(0.0, 1.0, 0.01)
    assert recorded_scene(Recording("r", time, {"piston.pressure_1": 1e5 + time}, {"piston.pressure_1": "Pa"}), bench) is None


def test_a_long_recording_has_a_bounded_number_of_frames(bench, monkeypatch):
    monkeypatch.setattr("exo_sim.simulation.machine_scene.MOST_FRAMES", 50)
    time = np.arange(0.0, 60.0, 0.01)
    scene = recorded_scene(Recording("r", time, {"slide.position": 0.0 * time}, {"slide.position": "m"}), bench)
    assert scene is not None and len(scene.times) == 50 < MOST_FRAMES


def test_a_mesh_is_drawn_where_the_model_has_it(tmp_path):
    from rerun.chunk import RrdReader

    import exo_sim as exo

    rr = pytest.importorskip("rerun")
    model = mujoco.MjModel.from_xml_string(TETRAHEDRON)
    (shape,) = shapes_of_model(model)[1]
    assert shape.kind == "mesh" and shape.vertices is not None and shape.faces is not None and len(shape.faces) == 4
    data, stream = mujoco.MjData(model), rr.RecordingStream("test")
    mujoco.mj_forward(model, data)
    stream.save(tmp_path / "wedge.rrd")
    exo.log_model(model, data, stream)
    stream.disconnect()
    (found,) = [c for c in RrdReader(str(tmp_path / "wedge.rrd")).stream() if c.entity_path.endswith("part/wedge")]
    corners = np.array(found.to_record_batch().column("Mesh3D:vertex_positions")[0].as_py())
    wanted = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])  # as written in the MJCF, in the body's frame
    assert all(np.abs(corners - each).sum(axis=1).min() < 1e-6 for each in wanted)


def test_a_comparison_holds_the_machine(bench, tmp_path):
    from rerun.chunk import RrdReader

    time = np.arange(0.0, 1.0, 0.01)
    recording = Recording("r", time, {"slide.position": 0.08 + 0.01 * time}, {"slide.position": "m"})
    write_rrd(tmp_path / "r.rrd", recording, recorded_scene(recording, bench), overlays={"simulated": recording})
    entities = {chunk.entity_path for chunk in RrdReader(str(tmp_path / "r.rrd")).stream()}
    assert any(path.startswith("/scene/bodies/") for path in entities)
