"""A machine that nobody wears follows a motion: a bench, and a leg of two joints with cylinders on tendons."""

import json

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.cli import main
from exo_sim.errors import ModelError, RecordingError, ScenarioError
from exo_sim.recording import Recording, reader
from exo_sim.simulation import unworn_record
from exo_sim.simulation.unworn import UnwornSimulation

LEG = """
<mujoco model="leg">
  <option timestep="0.001" integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <site name="hip_base" pos="0.10 0 1.05"/>
    <body name="thigh" pos="0 0 1">
      <joint name="hip" type="hinge" axis="0 -1 0" range="-60 100"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="3"/>
      <site name="hip_rod" pos="0.04 0 -0.25"/>
      <site name="knee_base" pos="-0.05 0 -0.08"/>
      <body name="shank" pos="0 0 -0.4">
        <joint name="knee" type="hinge" axis="0 -1 0" range="-110 5"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.35" size="0.03" mass="2"/>
        <site name="knee_rod" pos="-0.04 0 -0.06"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="hip"><site site="hip_base"/><site site="hip_rod"/></spatial>
    <spatial name="knee"><site site="knee_base"/><site site="knee_rod"/></spatial>
  </tendon>
  <actuator><motor name="hip" tendon="hip"/><motor name="knee" tendon="knee"/></actuator>
</mujoco>
"""
CYLINDER = """
[cylinders.{name}]
actuator = "{name}"
bore = "32 mm"
rod = "12 mm"
stroke = "{stroke} mm"
retracted_length = "{length} mm"
dead_volume_1 = "10 cm^3"
dead_volume_2 = "10 cm^3"
[cylinders.{name}.valve]
area = "6 mm^2"
"""


@pytest.fixture(scope="module")
def bench(repository):
    return rigs.read(repository / "exo_sim" / "assets" / "bench.toml")


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    folder = tmp_path_factory.mktemp("leg")
    (folder / "leg.xml").write_text(LEG)
    parts = CYLINDER.format(name="hip", stroke=200, length=170) + CYLINDER.format(name="knee", stroke=140, length=270)
    (folder / "leg.toml").write_text(f'name = "leg"\nmodel = "leg.xml"\n[supply]\npressure = "7 bar"\n{parts}')
    return rigs.read(folder / "leg.toml")


def motion(columns, units, seconds=2.0, step=0.01):
    time = np.arange(0.0, seconds, step)
    return Recording("m", time, {key: function(time) for key, function in columns.items()}, units)


def sweep(middle, size, hertz):
    return lambda t: middle + size * np.sin(2 * np.pi * hertz * t)


SLIDE = {"slide.position": sweep(0.08, 0.04, 0.5)}


@pytest.mark.parametrize("controller", ["model", "pi"])
def test_a_bench_follows_its_motion_and_the_books_close(bench, controller):
    run = UnwornSimulation(bench, motion(SLIDE, {"slide.position": "m"}), controller).run()
    numbers = unworn_record.summarise(run)
    assert numbers["joints"]["slide"]["position_error_rms_m"] < 2e-3
    assert max(abs(value) for value in numbers["books"].values()) < 1e-9
    # the rod's force is the mass times the acceleration that was recorded
    v = run.columns["slide.velocity"]
    np.testing.assert_allclose(np.diff(v) / 1e-3, run.columns["slide.torque"][:-1] / 10.0, atol=1e-6)
    assert np.all(np.abs(run.columns["piston.valve_command"]) <= 1.0)


def test_an_outside_force_is_recorded_and_carried(bench):
    columns = {"slide.position": lambda t: 0.08 + 0 * t, "slide.external_force": lambda t: np.where(t > 1.0, -80.0, 0.0)}
    run = UnwornSimulation(bench, motion(columns, {"slide.position": "m", "slide.external_force": "N"})).run()
    assert run.columns["slide.external_force"][-1] == -80.0
    assert run.columns["piston.force"][-1] == pytest.approx(80.0, abs=1.0)
    assert run.columns["slide.position"][-1] == pytest.approx(0.08, abs=1e-3)


def test_a_leg_on_tendons_follows_both_joints(leg):
    columns = {"hip.position": sweep(0.3, 0.3, 0.5), "knee.position": sweep(-0.7, 0.4, 0.5)}
    run = UnwornSimulation(leg, motion(columns, dict.fromkeys(columns, "rad"))).run()
    joints = unworn_record.summarise(run)["joints"]
    assert max(joints[name]["position_error_rms_rad"] for name in ("hip", "knee")) < np.radians(1.5)
    assert len(unworn_record.scene(run).cylinders) == 2


def test_somebodys_controller_moves_it(bench):
    class Push:
        period = 0.002

        def reset(self, context):
            self.reference = context.reference
            assert context.joints == ("slide",) and context.cylinders == ("piston",)

        def act(self, observation):
            wanted, rate = self.reference(observation["time"])["slide"]
            off, slow = wanted - observation["slide.position"], rate - observation["slide.velocity"]
            return {"slide.torque": 4000.0 * off + 400.0 * slow}

    run = UnwornSimulation(bench, motion(SLIDE, {"slide.position": "m"}), Push()).run()
    assert unworn_record.summarise(run)["joints"]["slide"]["position_error_rms_m"] < 5e-3

    class Closed(Push):
        def act(self, observation):
            return [0.0]

    run = UnwornSimulation(bench, motion(SLIDE, {"slide.position": "m"}), Closed()).run()
    assert np.all(run.columns["piston.valve_command"] == 0.0)


@pytest.mark.parametrize(
    ("columns", "units", "hint"),
    [
        ({"slid.position": SLIDE["slide.position"]}, {"slid.position": "m"}, 'did you mean "slide"'),
        ({"slide.velocity": SLIDE["slide.position"]}, {"slide.velocity": "m/s"}, r'no column "slide\.position \[m\]"'),
        ({"slide.position": SLIDE["slide.position"]}, {"slide.position": "rad"}, "has it in m"),
        ({"slide.position": lambda t: 0.3 + 0 * t}, {"slide.position": "m"}, "zero and sign"),
        ({**SLIDE, "load.external_force": lambda t: 0 * t}, {"slide.position": "m", "load.external_force": "N"}, "acts on no joint"),
        ({"slide.position": lambda t: np.where(t > 0.8, np.nan, 0.08)}, {"slide.position": "m"}, "no samples for"),
    ],
)
def test_what_is_no_motion_of_the_machine_is_one_line(bench, columns, units, hint):
    with pytest.raises(RecordingError, match=hint) as error:
        UnwornSimulation(bench, motion(columns, units))
    assert "\n" not in str(error.value)


def test_what_cannot_be_moved_is_said(bench, repository):
    with pytest.raises(ScenarioError, match='did you mean "model"'):
        UnwornSimulation(bench, motion(SLIDE, {"slide.position": "m"}), "modl")
    still = rigs.read(repository / "exo_sim" / "assets" / "real" / "pendulum" / "rig.toml")
    with pytest.raises(ModelError, match="nothing moves the machine"):
        UnwornSimulation(still, motion(SLIDE, {"slide.position": "m"}))


def test_the_command_writes_both_files_and_the_numbers(capsys, repository, tmp_path):
    time = np.arange(0.0, 1.0, 0.01)
    rows = "\n".join(f"{t:.2f},{80 + 20 * np.sin(np.pi * t):.4f}" for t in time)
    (tmp_path / "m.csv").write_text(f"time [s],slide.position [mm]\n{rows}\n")
    rig = str(repository / "exo_sim" / "assets" / "bench.toml")
    assert main(["run", str(tmp_path / "m.csv"), "--rig", rig, "--json", "--out", str(tmp_path / "b.rrd")]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["schema"] == "exo-sim/run/1" and data["scenario"] == "m" and set(data["joints"]) == {"slide"}
    assert {"pressure_peak_pa", "choked_share", "gas_kg"} <= set(data["cylinders"]["piston"])
    for path in (tmp_path / "b.rrd", tmp_path / "b.parquet"):
        table = reader.read(path).recording
        assert {"slide.position", "piston.valve_command", "piston.pressure_1", "piston.pressure_2", "supply.pressure"} <= set(table.columns)
    assert main(["run", str(tmp_path / "none.csv"), "--rig", rig]) == 2
    assert "there is no such recording" in capsys.readouterr().err
    assert main(["run", str(tmp_path / "m.csv"), "--rig", rig, "--out", str(tmp_path / "m.csv")]) == 2
