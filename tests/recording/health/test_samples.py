"""Single samples: holes, lone spikes and coarse steps are each one finding with their rows."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.recording import Recording
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.health import samples
from exo_sim.recording.noise import floor

TIME = np.arange(2000.0) * 1e-3
CLEAN = 3e5 + 5e4 * np.sin(3.0 * TIME) + np.random.default_rng(1).normal(0.0, 100.0, TIME.size)


def checked(values: np.ndarray) -> list[Finding]:
    table = Recording("r", TIME, {"piston.pressure_1": values}, {"piston.pressure_1": "Pa"})
    return samples.check(table, "piston.pressure_1", floor(values, TIME))


def test_a_clean_column_is_nothing() -> None:
    assert checked(CLEAN) == []


@pytest.mark.parametrize(("share", "severity"), [(0.01, "warning"), (0.6, "fault")])
def test_holes_are_counted_and_many_are_a_fault(share: float, severity: str) -> None:
    values = CLEAN.copy()
    values[100 : 100 + round(share * TIME.size)] = np.nan
    (found,) = (one for one in checked(values) if one.kind == "missing samples")
    assert found.severity == severity and found.rows == ((100, 100 + round(share * TIME.size)),) and found.use == "set aside"


def test_a_lone_spike_is_found_where_it_is() -> None:
    values = CLEAN.copy()
    values[700] += 8e4
    (found,) = checked(values)
    assert found.kind == "spikes" and found.rows == ((700, 701),)


def test_steps_coarser_than_the_noise_are_said_with_their_size() -> None:
    (found,) = checked(np.round(CLEAN / 5e3) * 5e3)
    assert found.kind == "quantised" and "5000 Pa" in found.says
