"""Columns that nothing reads, of a part or signal that is misspelt, where the machine lacks the column that was meant."""

from __future__ import annotations

import benches
import pytest

from exo_sim import conventions
from exo_sim.machine.rig_model import load
from exo_sim.recording.data_quality_finding import Finding
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


def test_a_misspelt_signal_that_was_set_aside_on_reading(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    left = {key: values for key, values in recording.columns.items() if key != "piston.pressure_2"}
    without = Recording(recording.name, recording.time, left, {key: recording.units[key] for key in left})
    aside = [Finding(name, "unknown column", f"{name} was set aside") for name in ("piston.presure_2 [Pa]", "camera.trigger", "[" * 400)]
    (check,) = conventions.settle(without, rig, load(rig), aside).checks
    assert (check.columns, check.meant, check.says) == (("piston.presure_2",), "piston.pressure_2", aside[0].says)
    assert conventions.settle(recording, rig, load(rig), aside).checks == ()


def test_what_was_meant_is_told_to_machines(bench: tuple[Rig, Recording]) -> None:
    rig, recording = bench
    (check,) = conventions.asked(renamed(recording, "slide.position", "piston.position"), rig, load(rig)).checks
    assert check.as_dict()["meant"] == "slide.position"
