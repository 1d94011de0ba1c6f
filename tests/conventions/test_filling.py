"""A recording is called slow for its gas by the samples that it has in the time in which a valve fills a chamber."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim.conventions.filling import QUICK, SLOW, filling_time, slow_for_gas
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig


@pytest.fixture
def rig(tmp_path: Path) -> Rig:
    return benches.bench(tmp_path)


def recorded(rate: float, moved: float = 0.3) -> Recording:
    time = np.arange(400) / rate
    columns = {"piston.valve_command": moved * np.sin(time), "piston.pressure_1": 3e5 + time}
    return Recording("r", time, columns, {})


def test_the_filling_time_is_that_of_a_choked_flow(rig: Rig) -> None:
    cylinder = rig.cylinders["piston"]
    dead, areas, supply = (cylinder.dead_volume_1, cylinder.dead_volume_2), (cylinder.area_1, cylinder.area_2), rig.supply
    volume = min(rest + 0.5 * area * cylinder.stroke for rest, area in zip(dead, areas, strict=True))
    mass_flow = 0.0404 / np.sqrt(supply.temperature) * supply.pressure * cylinder.valve_area
    rate = 1.4 * 287.05 * supply.temperature * mass_flow / volume
    assert filling_time(cylinder, rig) == pytest.approx((supply.pressure - rig.environment.pressure) / rate, rel=2e-3)


def test_a_slow_recording_is_told_which_rate_it_needs(rig: Rig) -> None:
    seconds = filling_time(rig.cylinders["piston"], rig)
    slow = 0.5 * SLOW / seconds
    (finding,) = slow_for_gas(recorded(slow), rig)
    assert finding.column == "piston.valve_command" and "record at" in finding.says and f"{1e3 * seconds:.0f} ms" in finding.says
    needed = float(finding.says.split("record at ")[1].split(" Hz")[0])
    assert needed > slow and slow_for_gas(recorded(needed), rig) == []
    assert slow_for_gas(recorded(QUICK), rig) == []


def test_a_valve_that_stays_as_it_is_needs_no_rate(rig: Rig) -> None:
    assert slow_for_gas(recorded(10.0, moved=0.0), rig) == []
    bare = recorded(10.0)
    assert slow_for_gas(replace(bare, columns={"piston.pressure_1": bare["piston.pressure_1"]}), rig) == []
