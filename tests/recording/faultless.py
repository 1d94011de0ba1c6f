"""What recordings of sound sensors have in common."""

from __future__ import annotations

from exo_sim.recording import Recording
from exo_sim.recording.health import check


def quiet(recording: Recording) -> None:
    assert [f for f in check(recording) if f.severity == "fault"] == []
