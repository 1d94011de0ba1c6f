"""The gas spring: closed chambers between isothermal and adiabatic, and the force of the machine that pulls."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recording.faultless import quiet

from exo_sim import rig
from exo_sim.recording.foreign.gas_spring import read_gas_spring


@pytest.mark.real_data
def test_the_gas_spring_keeps_its_gas(shared_data: Path, repository: Path) -> None:
    """With the believed chambers both exponents of a closed gas lie between isothermal and adiabatic."""
    (path,) = (shared_data / "gas_spring").glob("*.exp")
    recording = read_gas_spring(path)
    quiet(recording)
    spring = rig.read(repository / "assets" / "real" / "gas_spring" / "rig.toml").cylinders["spring"]
    x = recording["piston.position"]
    volumes = (
        spring.dead_volume_1 + spring.area_1 * x,
        spring.dead_volume_2 + spring.area_2 * (spring.stroke - x),
    )
    for number, volume in enumerate(volumes, start=1):
        slope = np.polyfit(np.log(volume), np.log(recording[f"spring.pressure_{number}"]), 1)[0]
        assert 1.0 < -slope < 1.4
    pulled = read_gas_spring(path, with_force=True)
    assert pulled["piston.external_force"].max() == pytest.approx(6829.268 * 4.4482216152605)
