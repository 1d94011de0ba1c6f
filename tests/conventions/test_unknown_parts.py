"""A column of a part that the machine does not have, where a part of its own lacks that column."""

from __future__ import annotations

import benches
import pytest

from exo_sim import conventions
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> tuple[Rig, Recording]:
    rig = benches.bench(tmp_path_factory.mktemp("parts"))
    return rig, benches.led(rig, 3.0)


def renamed(recording: Recording, old: str, new: str) -> Recording:
    names = {key: key.replace(old, new) for key in recording.columns}
    columns = {names[key]: values for key, values in recording.columns.items()}
    return Recording(recording.name, recording.time, columns, {names[key]: unit for key, unit in recording.units.items() if key in names})


def said(rig: Rig, recording: Recording) -> list[str]:
    checks = conventions.asked(recording, rig, load(rig)).checks
    return [check.says for check in checks if check.what == "part"]


def test_a_recording_of_the_machine_s_own_parts_is_asked_nothing(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    assert said(rig, recording) == []


def test_the_cylinder_s_name_in_place_of_its_joint_s(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    (says,) = said(rig, renamed(recording, "slide.position", "piston.position"))
    assert says == '"piston.position": nothing reads it, the machine has no joint "piston"; did you mean "slide"?'


def test_a_misspelt_cylinder(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    (says,) = said(rig, renamed(recording, "piston.pressure_1", "pistin.pressure_1"))
    assert says == '"pistin.pressure_1": nothing reads it, the machine has no cylinder "pistin"; did you mean "piston"?'


def test_a_column_of_something_else_is_nobody_s_business(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    other = renamed(recording, "slide.position", "camera.position")
    assert said(rig, other) == []
    assert said(rig, Recording(other.name, other.time, {**other.columns, "slide.position": other["camera.position"]}, other.units)) == []


def test_inspect_lists_it(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    settled = conventions.asked(renamed(recording, "slide.position", "piston.position"), rig, load(rig))
    assert [one.use for one in conventions.findings(settled) if one.kind == "part"] == ["set aside"]
