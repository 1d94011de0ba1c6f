"""Which questions a recording can answer: what is not recorded, or did not happen, is said of every effect that needs it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim.conventions.answerable import Question, questions
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording
from exo_sim.rig import Rig


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> tuple[Rig, Recording]:
    rig = benches.bench(tmp_path_factory.mktemp("bench"))
    return rig, benches.recorded(rig, 1.0)


def asked(rig: Rig, recording: Recording) -> dict[tuple[str, str], Question]:
    return {(one.effect, one.where): one for one in questions(recording, rig, load(rig))}


def without(recording: Recording, *keys: str) -> Recording:
    return replace(recording, columns={key: values for key, values in recording.columns.items() if key not in keys})


def test_a_whole_recording_answers_all(bench: tuple[Rig, Recording]) -> None:
    assert [one for one in asked(*bench).values() if not one.answerable] == []


def test_without_pressures_only_what_the_command_and_position_need_not_is_left(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    found = asked(rig, without(recording, "piston.pressure_1", "piston.pressure_2"))
    assert found["piston_leakage", "piston"].missing == ("piston.pressure_1 or piston.pressure_2",)
    assert found["coulomb_friction", "slide"].missing == ("slide.external_force or piston.pressure_1",)
    assert not found["supply_droop", "supply"].answerable


def test_without_a_command_the_valve_is_not_asked(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    found = asked(rig, without(recording, "piston.valve_command"))
    assert found["valve_deadband", "piston"].missing == ("piston.valve_command",)
    assert found["coulomb_friction", "piston"].answerable


def test_a_valve_for_each_chamber_is_asked_by_both_commands(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    command = recording["piston.valve_command"]
    alone = replace(rig.cylinders["piston"], valve=replace(rig.cylinders["piston"].valve, independent=True))
    rig = replace(rig, cylinders={"piston": alone})
    both = without(recording, "piston.valve_command")
    both = replace(both, columns={**both.columns, "piston.valve_command_1": command, "piston.valve_command_2": 0.0 * command})
    assert [one for one in asked(rig, both).values() if not one.answerable] == []
    assert asked(rig, without(both, "piston.valve_command_2"))["valve_lag", "piston"].missing == ("piston.valve_command_2",)
    still = replace(both, columns={**both.columns, "piston.valve_command_1": 0.0 * command})
    assert asked(rig, still)["valve_lag", "piston"].missing == ("the valve never opens",)


def test_of_chambers_that_something_unknown_feeds_the_gas_is_not_asked(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    found = asked(rig, without(benches.recorded(rig, 4.0), "piston.valve_command"))
    assert "a command of what lets gas into piston" in found["piston_leakage", "piston"].missing
    assert found["coulomb_friction", "piston"].answerable


def test_a_machine_that_stands_still_with_closed_valves_answers_little(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    n = len(recording.time)
    still = {**recording.columns, "slide.position": np.full(n, 0.01), "piston.valve_command": np.zeros(n)}
    found = asked(rig, replace(recording, columns=still))
    assert found["viscous_friction", "slide"].missing == ("slide never moves",)
    assert "the valve never opens" in found["valve_lag", "piston"].missing
    assert found["piston_leakage", "piston"].answerable


def test_a_rig_without_cylinders_asks_of_its_joints_alone(tmp_path: Path, bench: tuple[Rig, Recording]) -> None:
    """Nothing drives it, and a column that says so is not needed: absent means none."""
    rig = benches.bench(tmp_path, cylinder=False)
    recording = without(bench[1], "piston.pressure_1", "piston.pressure_2", "piston.valve_command")
    found = asked(rig, recording)
    assert found["coulomb_friction", "slide"].answerable
    assert {where for _, where in found} <= {"slide", "supply", "exhaust"}


def test_forces_of_straps_and_ground_stand_in_for_an_outside_force(tmp_path: Path, bench: tuple[Rig, Recording]) -> None:
    rig = benches.bench(tmp_path, cylinder=False)
    alone = without(bench[1], "piston.pressure_1", "piston.pressure_2", "piston.valve_command")
    pushed = replace(alone, columns={**alone.columns, "foot.ground_force_z": np.zeros(len(alone.time))})
    assert asked(rig, pushed)["coulomb_friction", "slide"].answerable


STANDING = """
<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/><body name="frame" pos="0 0 0.5">
  <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/><joint name="slide" type="slide" axis="0 1 0"/>
  <geom type="sphere" size="0.05" mass="8" contype="0" conaffinity="0"/>
  <body name="shoe" pos="0 0 -0.4"><geom type="sphere" size="0.05" mass="1"/><site name="sole" pos="0 0 -0.05"/></body>
</body></worldbody><actuator><motor name="piston" joint="slide"/></actuator></mujoco>
"""


def test_a_machine_on_the_ground_asks_of_its_joints_only_with_the_grounds_force(tmp_path: Path, bench: tuple[Rig, Recording]) -> None:
    rig = benches.bench(tmp_path)
    rig.model.write_text(STANDING)
    found = asked(rig, bench[1])
    assert found["coulomb_friction", "slide"].missing == ("sole.ground_force_x and _z (shoe touches the ground)",)
    assert not found["viscous_friction", "piston"].answerable and found["piston_leakage", "piston"].answerable
    felt = {**bench[1].columns, "sole.ground_force_z": np.full(len(bench[1].time), 80.0)}
    assert asked(rig, replace(bench[1], columns=felt))["coulomb_friction", "slide"].answerable
    with_cell = {**bench[1].columns, "piston.force": np.ones(len(bench[1].time))}
    assert asked(rig, replace(bench[1], columns=with_cell))["viscous_friction", "piston"].answerable


def test_a_joint_and_a_cylinder_of_one_name_are_one_place(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    named = replace(rig, cylinders={"slide": replace(rig.cylinders["piston"], name="slide")})
    found = questions(replace(recording, columns={
        key.replace("piston.", "slide."): values for key, values in recording.columns.items()
    }), named, load(rig))  # fmt: skip
    pairs = [(one.effect, one.where) for one in found]
    assert len(pairs) == len(set(pairs)) and ("coulomb_friction", "slide") in pairs
