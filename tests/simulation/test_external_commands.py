"""The worn machine under somebody's controller, and step by step."""

import json

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.cli import main
from exo_sim.control import user_controller
from exo_sim.errors import ScenarioError
from exo_sim.simulation.external_commands import Stepper
from exo_sim.simulation.walk import JOINTS, Request
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def exo(repository):
    return rigs.read(repository / "exo_sim" / "assets" / "exo_250_psi.toml")


class Still:
    """Leaves all valves closed."""

    period = 0.004

    def reset(self, context):
        self.times = []
        self.context = context

    def act(self, observation):
        self.times.append(observation["time"])
        return {}


def test_closed_valves_are_the_run_without_assistance_to_the_last_bit(exo):
    controller = Still()
    driven = Simulation(exo, Request("level_walk", cycles=1, controller="Still", driven="valves"), controller).run()
    plain = Simulation(exo, Request("level_walk", cycles=1, assist="off")).run()
    for key, values in plain.columns.items():
        np.testing.assert_array_equal(driven.columns[key], values, err_msg=key)
    np.testing.assert_allclose(controller.times, np.arange(len(controller.times)) * 0.004)
    assert {"knee_l.pressure_1", "hip_r.position", "gait.phase", "foot_l.ground_force_z"} <= set(controller.context.signals)
    assert controller.context.reference(0.0)["knee_r"][0] == pytest.approx(plain.motion.position[0, 7])


def test_commands_reach_the_valves_and_torques_the_joints(exo):
    class Open(Still):
        def act(self, observation):
            return {"hip_l": 0.25, "knee_r": -2.0}

    class Push(Still):
        def act(self, observation):
            return {"knee_l.torque": 20.0}

    walk = Simulation(exo, Request("stand", cycles=1, controller="Open", driven="valves"), Open()).run()
    assert walk.columns["hip_l.valve_command"][0] == 0.0 and set(walk.columns["hip_l.valve_command"][1:]) == {0.25}
    assert set(walk.columns["knee_r.valve_command"][1:]) == {-1.0}
    walk = Simulation(exo, Request("stand", cycles=1, controller="Push", driven="valves"), Push()).run()
    assert np.all(walk.columns["knee_l.torque_demanded"][1:] == 20.0)
    assert walk.columns["knee_l.torque"][-1] == pytest.approx(20.0, abs=1.0)


def test_stepping_by_hand_is_the_same_run(exo):
    class Push(Still):
        period = 0.01

        def act(self, observation):
            return {"hip_r.torque": 30.0 * np.sin(5.0 * observation["time"])}

    request = Request("level_walk", cycles=1, controller="Push", driven="torques")
    whole = Simulation(exo, request, Push()).run()
    stepper = Stepper(Simulation(exo, request))
    context = user_controller.Context(exo, tuple(exo.cylinders), JOINTS, (), 0.01, 0.001, 1.0)
    row = stepper.reset()
    for _ in range(40):
        observation = stepper.outside.observation(row)
        stepper.outside.command(user_controller.read(Push().act(observation), context))
        row = stepper.steps(10)
    walk = stepper.walk()
    for key in ("hip_r.torque", "knee_l.pressure_1", "torso_z.position"):
        np.testing.assert_array_equal(walk.columns[key], whole.columns[key][:401], err_msg=key)
    again = stepper.reset()
    np.testing.assert_array_equal(again, stepper.rows[0][0])


@pytest.mark.parametrize("name", ["impedance.py:Impedance", "delayed_feedback.py:DelayedFeedback", "learnt_policy.py:LearntPolicy"])
def test_the_worked_controllers_walk(capsys, repository, tmp_path, name):
    file = repository / "exo_sim" / "assets" / "controllers" / name
    assert main(["run", "level_walk", "--strides", "3", "--controller", str(file), "--json", "--out", str(tmp_path / "w.rrd")]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["joints"]["hip_r"]["torque_rms_nm"] > 3.0
    assert data["mean_ground_force_n"] + data["strap_load_n"]["vertical_mean"] == pytest.approx(data["supported_weight_n"], rel=1e-2)


@pytest.mark.parametrize(
    ("controller", "hint"),
    [("modle", 'did you mean "model"'), ("none.py:Mine", "there is no file"), ("mine.py:Mine", r"mine.py:4: KeyError: 'hip'")],
)
def test_what_is_wrong_with_a_controller_is_one_line(capsys, tmp_path, monkeypatch, controller, hint):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text("class Mine:\n    def reset(self, c): pass\n    def act(self, o):\n        return o['hip']\n")
    assert main(["run", "stand", "--controller", controller, "--out", "x.rrd"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1 and hint in said.err
    assert not list(tmp_path.glob("x.*"))


def test_assistance_and_a_controller_exclude_each_other():
    with pytest.raises(ScenarioError, match="holds the valves itself"):
        Request("stand", assist="vented", controller="mine.py", driven="valves")
