"""A command of a valve that the rig does not have is asked about."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import pytest

from exo_sim.conventions import asked
from exo_sim.machine.rig_model import load


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
