"""Is every sensor in a recording well? Pure functions over a `Recording`; thresholds chosen so that clean data pass."""

from __future__ import annotations

from exo_sim.recording.finding import Finding
from exo_sim.recording.health import clock, consistency, freezing, plausibility, samples
from exo_sim.recording.health.facts import Facts
from exo_sim.recording.noise import floors
from exo_sim.recording.table import Recording

__all__ = ["Facts", "check"]


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
        found += freezing.check(recording, key, noise)
        found += plausibility.check(recording, key, noise[key], facts)
    spoilt = {finding.column for finding in found if finding.severity == "fault"}
    found += consistency.check(recording, noise, spoilt)
    order = {"fault": 0, "warning": 1, "info": 2}
    return sorted(found, key=lambda finding: order[finding.severity])
