"""Recordings: one table of signals in memory, its readers and writers, and the rerun scene."""

from exo_sim.recording.finding import Finding
from exo_sim.recording.reader import Reading, read
from exo_sim.recording.table import Recording

__all__ = ["Finding", "Reading", "Recording", "read"]
