"""Is every sensor in a recording well? Pure functions over a `Recording`; thresholds chosen so that clean data pass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.health import clock, consistency, plausibility, samples, stuck_or_clipped
from exo_sim.recording.health.facts import Facts
from exo_sim.recording.noise import floors
from exo_sim.recording.table import Recording

__all__ = ["Facts", "blanked", "check", "without_faults"]


def check(recording: Recording, facts: Facts | None = None) -> list[Finding]:
    """Look for sensor and clock faults.

    Args:
        recording: Signals in SI.
        facts: What is known of the machine, as plain numbers; without it fewer questions can be asked.

    Returns:
        Findings, the gravest first; none for a clean recording but "info".
    """
    facts = facts or Facts()
    noise = floors(recording)
    found = clock.check(recording)
    for key in recording.columns:
        found += samples.check(recording, key, noise[key])
        found += stuck_or_clipped.check(recording, key, noise, facts)
        found += plausibility.check(recording, key, noise[key], facts)
    spoilt = {finding.column for finding in found if finding.severity == "fault"}
    found += consistency.check(recording, noise, spoilt)
    order = {"fault": 0, "warning": 1, "info": 2}
    return sorted(found, key=lambda finding: order[finding.severity])


def without_faults(recording: Recording, findings: Sequence[Finding]) -> Recording:
    """Return a recording without what its sensors cannot have seen; a pressure that only counts from the atmosphere stays."""
    columns = dict(recording.columns)
    for finding in findings:
        if finding.severity == "fault" and finding.kind != "gauge" and finding.column in columns:
            columns[finding.column] = blanked(columns[finding.column], finding)
    return replace(recording, columns={key: values for key, values in columns.items() if np.isfinite(values).any()})


def blanked(values: NDArray[np.float64], finding: Finding) -> NDArray[np.float64]:
    """Return a column with NaN where a finding says that it must not be used: in some rows, or in all of them."""
    kept = values.copy()
    for begin, end in finding.rows or ((0, len(values)),):
        kept[begin:end] = np.nan
    return kept
