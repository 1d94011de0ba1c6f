"""Cylinders at the ankles: sized like the others, asked for no more than the rig says, and no motor beside them."""

from dataclasses import replace

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import RigError
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import Ankle
from exo_sim.simulation.loop_wiring import wire
from exo_sim.simulation.torque_limits import torque_limits
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation
from exo_sim.sizing.ankle_motor import ankle_motor
from exo_sim.sizing.joint_kinds import kinds_of
from exo_sim.sizing.loads import joint_loads

MOST = 30.0
CYLINDER = """
[cylinders.ankle_{side}]
actuator = "ankle_{side}"
bore = "63 mm"
rod = "20 mm"
stroke = "160 mm"
retracted_length = "215 mm"
dead_volume_1 = "20 cm^3"
dead_volume_2 = "16 cm^3"
[cylinders.ankle_{side}.valve]
area = "20 mm^2"
"""


@pytest.fixture(scope="module")
def driven(repository, tmp_path_factory):
    """The machine that comes along with a cylinder behind each shank down to the heel."""
    folder = tmp_path_factory.mktemp("ankle")
    model, text = ((repository / "assets" / name).read_text(encoding="utf-8") for name in ("exo.xml", "exo_250_psi.toml"))
    for side in "lr":
        heel, knee = f'<site name="foot_{side}_strap_heel"', f'<site name="knee_{side}_rod"'
        model = model.replace(heel, f'<site name="ankle_{side}_rod" pos="-0.08 0 -0.03"/>{heel}')
        model = model.replace(knee, f'<site name="ankle_{side}_base" pos="-0.07 0 -0.08"/>{knee}')
        model = model.replace(f'joint="ankle_{side}"', f'tendon="ankle_{side}"')
        tendon = f'<spatial name="ankle_{side}" class="cylinder"><site site="ankle_{side}_base"/><site site="ankle_{side}_rod"/></spatial>'
        model = model.replace("</tendon>", f"{tendon}</tendon>")
        text += CYLINDER.format(side=side)
    (folder / "exo.xml").write_text(model, encoding="utf-8")
    (folder / "exo.toml").write_text(text, encoding="utf-8")
    return replace(rigs.read(folder / "exo.toml"), ankle=Ankle("powered", 0.0, MOST))


def test_ankles_are_a_kind_of_their_own(driven):
    kinds = {kind.name: kind for kind in kinds_of(driven)}
    assert kinds["ankle"].cylinders == ("ankle_l", "ankle_r") and set(kinds) == {"hip", "knee", "ankle"}
    assert kinds["ankle"].direction > 0.0  # behind the leg: a push dorsiflexes


def test_they_are_asked_for_no_more_than_the_rig_says_and_the_others_for_what_they_were(driven, exo, condition):
    found, loads = joint_loads(driven, condition), joint_loads(replace(exo, ankle=Ankle("powered", 0.0, MOST)), condition)
    assert np.abs(loads.column("ankle_r")[2]).max() > MOST and np.abs(found.column("ankle_r")[2]).max() == MOST
    for joint in ("hip_l", "knee_r"):
        assert found.column(joint)[2] == pytest.approx(loads.column(joint)[2])


def test_an_ankle_that_is_asked_for_nothing_is_refused(driven):
    with pytest.raises(RigError, match=r'ankle\.mode = "sprung" asks nothing of it: write mode = "powered"'):
        kinds_of(replace(driven, ankle=Ankle("sprung")))


def test_a_rod_at_the_ankle_has_no_motor_beside_it(driven, exo):
    walk = Simulation(driven, Request("level_walk", 34.0, 1.0, 1, law="inverse_dynamics"))
    assert list(wire(walk)[-1].ankles) == [-1, -1]
    limits = torque_limits(walk.plugin, walk.motion)[:, 5]
    link = next(one for one in linkages(driven, load(driven)) if one.cylinder == "ankle_r")
    assert link.dof == 8 and not np.allclose(np.abs(limits), MOST) and (limits[:, 0] < 0.0).all() and (limits[:, 1] > 0.0).all()
    motored = Simulation(replace(exo, ankle=Ankle("powered", 0.0, MOST)), Request("level_walk", 34.0, 1.0, 1, law="inverse_dynamics"))
    assert min(wire(motored)[-1].ankles) >= 0
    assert torque_limits(motored.plugin, motored.motion)[:, 5] == pytest.approx(np.tile([-MOST, MOST], (len(limits), 1)))


def test_a_rod_at_the_ankle_leaves_no_motor_to_buy(driven, exo, condition):
    assert ankle_motor(driven, (joint_loads(driven, condition),)) is None
    motored = replace(exo, ankle=driven.ankle)
    motor = ankle_motor(motored, (joint_loads(motored, condition),))
    assert motor is not None and motor.torque == MOST < motor.asked and 0.0 < motor.rms < MOST
