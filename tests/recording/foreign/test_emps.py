"""EMPS: the published fit of its forces is in the table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recording.faultless import quiet

from exo_sim.recording import Recording
from exo_sim.recording.foreign.emps import read_emps


def inverse_dynamics_fit(recording: Recording) -> np.ndarray:
    """Mass, viscous and Coulomb coefficients and offset by least squares on low-passed derivatives."""
    from scipy.signal import butter, filtfilt

    time, force = recording.time, recording["slide.external_force"]
    low = butter(4, 60.0, fs=1000.0)
    position = filtfilt(*low, recording["slide.position"])
    speed = np.gradient(position, time)
    design = np.stack((np.gradient(speed, time), speed, np.sign(speed), np.ones_like(time)), axis=1)
    columns = [filtfilt(*low, column)[500:-500:10] for column in design.T]
    return np.linalg.lstsq(np.stack(columns, axis=1), filtfilt(*low, force)[500:-500:10], rcond=None)[0]


@pytest.mark.real_data
def test_emps_gives_the_published_fit(shared_data: Path) -> None:
    recording = read_emps(shared_data / "emps" / "DATA_EMPS.mat")
    quiet(recording)
    mass, viscous, coulomb, offset = inverse_dynamics_fit(recording)
    assert mass == pytest.approx(95.1089, rel=0.01)
    assert viscous == pytest.approx(203.5034, rel=0.05)
    assert coulomb == pytest.approx(20.3935, rel=0.05)
    assert offset == pytest.approx(-3.1648, rel=0.15)
    assert read_emps(shared_data / "emps" / "DATA_EMPS_PULSES.mat").name == "pulses"
