"""Printed cylinders: the published friction of their seals, and how fast they lose their gas."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recording.faultless import quiet

from exo_sim.recording.foreign.seals import read_friction, read_pressure_decay


@pytest.mark.real_data
@pytest.mark.parametrize("seal,published", [("O-ring", (3.9, 5.5, 6.9, 7.8)), ("KDN", (5.6, 5.7, 6.2, 6.8))])
def test_half_the_hysteresis_of_the_seals(shared_data: Path, seal: str, published: tuple[float, ...]) -> None:
    area = np.pi * 0.0125**2
    for bar, half in zip((1, 3, 5, 7), published):
        recording = read_friction(shared_data / "seals" / "friction" / f"{seal}_{bar}bar.csv")
        quiet(recording)
        rod = -(recording["slide.external_force"] + (recording["piston.pressure_1"] - 101325.0) * area)
        speed = np.gradient(np.convolve(recording["slide.position"], np.ones(21) / 21, "same"), recording.time)
        found = 0.5 * (np.median(rod[speed < -2e-3]) - np.median(rod[speed > 2e-3]))
        assert found == pytest.approx(half, abs=0.6)  # friction resists both ways: + when turned round right


@pytest.mark.real_data
def test_pressure_decay(shared_data: Path) -> None:
    control = read_pressure_decay(shared_data / "seals" / "pressure_decay" / "Aluminium.csv")
    assert (np.diff(control.time) > 0).all()
    assert control.duration == pytest.approx(151.3, abs=0.1)
    assert control["piston.pressure_1"][[0, -1]] == pytest.approx([832825.0, 829825.0], abs=500.0)
    leaking = read_pressure_decay(shared_data / "seals" / "pressure_decay" / "Ultimaker_015.csv")
    assert leaking["piston.pressure_1"][-1] == pytest.approx(101325.0 + 7200.0, abs=100.0)
