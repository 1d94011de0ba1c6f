"""`exo.Simulation` and controllers in `exo.simulate`."""

import numpy as np
import pytest

import exo_sim as exo
from exo_sim.errors import ScenarioError


class Push:
    """Asks for the same torque all the time."""

    period = 0.004

    def reset(self, context):
        self.begun = True

    def act(self, observation):
        return {"knee_l.torque": 15.0}


def test_a_class_an_object_and_a_file_are_the_same_controller(tmp_path):
    file = tmp_path / "push.py"
    file.write_text("class Push:\n    period = 0.004\n    def reset(self, context): pass\n"
                    "    def act(self, observation): return {'knee_l.torque': 15.0}\n")  # fmt: skip
    runs = [exo.simulate(scenario="stand", strides=1, controller=each) for each in (Push, Push(), f"{file}:Push")]
    first = runs[0].recording["knee_l.torque"]
    assert first[-1] == pytest.approx(15.0, abs=1.0)
    for run in runs[1:]:
        np.testing.assert_array_equal(run.recording["knee_l.torque"], first)
    with pytest.raises(ScenarioError, match="no method reset"):
        exo.simulate(scenario="stand", strides=1, controller=object())


def test_steps_under_commands():
    simulation = exo.Simulation(scenario="stand", payload="20 kg", strides=1, period="10 ms")
    assert simulation.observation["time"] == 0.0
    while not simulation.done:
        seen = simulation.step({"knee_l.torque": 15.0})
    assert simulation.time == pytest.approx(simulation.duration, abs=0.011)
    assert seen["knee_l.torque"] == pytest.approx(15.0, abs=1.0)
    assert simulation.summary["joints"]["knee_l"]["torque_peak_nm"] > 10.0
    assert len(simulation.recording.time) == round(simulation.time / 0.001)
    simulation.reset()
    assert simulation.time == pytest.approx(0.001)
    simulation.step([0.0, 1.0, 0.0, 0.0])
    assert simulation.observation["knee_l.valve_command"] == 1.0
    for commands, hint in (({"kne_l": 1.0}, "did you mean"), ([1.0], "1 numbers"), ({"knee_l": float("inf")}, "inf")):
        with pytest.raises(ScenarioError, match=hint):
            simulation.step(commands)
    with pytest.raises(ScenarioError, match="whole number"):
        simulation.step(steps=0)
