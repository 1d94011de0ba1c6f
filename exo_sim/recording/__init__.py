"""Recordings: one table of signals in memory, its readers and writers, and the rerun scene."""

from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.reader import Reading, read
from exo_sim.recording.rrd_file import write_rrd
from exo_sim.recording.scene import Arrows, DrawnCylinder, Scene, Shape, shapes_of_model
from exo_sim.recording.table import Recording
from exo_sim.recording.table_file import write_table

__all__ = [
    "Arrows",
    "DrawnCylinder",
    "Finding",
    "Reading",
    "Recording",
    "Scene",
    "Shape",
    "read",
    "shapes_of_model",
    "write_rrd",
    "write_table",
]
