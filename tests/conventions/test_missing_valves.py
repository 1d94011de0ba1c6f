"""A command of a valve that the rig does not have, or has of another kind, is asked about."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import pytest

from exo_sim.conventions import asked
from exo_sim.conventions.machine import Machine
from exo_sim.conventions.missing_valves import of_another_kind
from exo_sim.machine.rig_model import load
from exo_sim.rig.schema import Valve


@pytest.mark.parametrize(("area", "size", "is_asked"), [(0.0, 1.0, True), (0.0, 0.001, False), (None, 1.0, False)])
def test_a_command_that_moves_and_has_no_valve_is_asked_about(tmp_path: Path, area: float | None, size: float, is_asked: bool) -> None:
    """Not one that opens nothing, nor where there is a valve."""
    rig = benches.bench(tmp_path)
    table = benches.recorded(rig, 2.0)
    key = "piston.valve_command"
    scaled = replace(table, columns={**table.columns, key: size * table[key]})
    cylinder = rig.cylinders["piston"]
    own = replace(rig, cylinders={"piston": replace(cylinder, valve_area=cylinder.valve_area if area is None else area)})
    found = [check for check in asked(scaled, own, load(own)).checks if check.what == "valve"]
    assert bool(found) is is_asked
    assert not found or "[cylinders.piston.valve]" in found[0].says


@pytest.mark.parametrize(
    ("independent", "renamed", "says"),
    [
        (False, ("valve_command_1", "valve_command_2"), 'a 4-way valve, which takes valve_command alone; write kind = "independent" in'),
        (False, ("valve_command",), ""),
        (False, ("valve_command", "valve_command_1", "valve_command_2"), ""),
        (True, ("valve_command",), 'which takes valve_command_1 and valve_command_2; write kind = "4-way" in [cylinders.piston.valve]'),
        (True, ("valve_command_1", "valve_command_2"), ""),
    ],
)
def test_commands_of_another_kind_of_valve_are_asked_about(
    tmp_path: Path, independent: bool, renamed: tuple[str, ...], says: str
) -> None:
    rig = benches.bench(tmp_path)
    table = benches.recorded(rig, 2.0)
    columns = {key: values for key, values in table.columns.items() if key != "piston.valve_command"}
    columns |= {f"piston.{name}": table["piston.valve_command"] for name in renamed}
    cylinder = replace(rig.cylinders["piston"], valve=Valve(independent=independent))
    _, found = of_another_kind(replace(table, columns=columns), Machine.of(replace(rig, cylinders={"piston": cylinder}), load(rig)))
    assert bool(found) is bool(says)
    assert [check.columns for check in found] == [tuple(f"piston.{name}" for name in renamed)] * bool(says)
    assert not found or says in found[0].says
