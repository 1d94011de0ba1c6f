"""Signals over time, one panel for each kind: the wearer's joints apart from the machine's, so that each panel has a legend."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.api.plots import panels
from exo_sim.errors import RecordingError
from exo_sim.recording.table import Recording

JOINTS = [f"{joint}_{side}" for joint in ("hip", "knee", "ankle") for side in "lr"]
PARTS = ["torso_pitch", *JOINTS, "wearer_pitch", *(f"wearer_{joint}" for joint in JOINTS)]


def walk() -> Recording:
    columns = {f"{part}.position": np.linspace(0.0, 1.0, 5) for part in PARTS}
    return Recording("walk", np.arange(5.0), columns, dict.fromkeys(columns, "rad"))


def test_the_wearers_joints_have_a_panel_of_their_own_and_every_line_a_name() -> None:
    machine, wearer = panels([("", walk())]).axes
    assert (machine.get_title("left"), wearer.get_title("left")) == ("joint position", "joint position, wearer")
    for panel, parts in ((machine, PARTS[:7]), (wearer, PARTS[7:])):
        legend = panel.get_legend()
        assert legend is not None and [text.get_text() for text in legend.get_texts()] == parts


def test_a_signal_that_was_not_recorded_is_asked_about() -> None:
    with pytest.raises(RecordingError, match=r'no signal "hip_l\.positon" was recorded; did you mean "hip_l\.position"'):
        panels([("", walk())], ["hip_l.positon"])
