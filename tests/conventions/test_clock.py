"""A clock is converted where the recording itself shows its unit; where a size in the rig explains the same, both are named."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from exo_sim.conventions.clock import CLOCKS, either, is_shown
from exo_sim.conventions.machine import Machine
from exo_sim.conventions.signs import in_order
from exo_sim.machine.rig_model import load
from exo_sim.recording import reader
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig, read
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions


def at(rate: float, **columns: np.ndarray) -> Recording:
    return Recording("r", np.arange(2000) / rate, {key.replace("__", "."): values for key, values in columns.items()}, {})


@pytest.mark.parametrize(
    ("rate", "unit", "shown"),
    [
        (1.0, "milliseconds", True),  # 1 kHz in ms
        (1e6, "seconds, not milliseconds", True),
        (6e3, "minutes", True),  # 100 Hz in minutes: no logger has 6 kHz
        (6e4, "minutes", True),
        (1e3, "minutes", False),  # a usual rate, and 16.7 Hz are none
        (1e3, "milliseconds", False),
        (1e3, "seconds, not milliseconds", False),
    ],
)
def test_a_rate_that_no_logger_has_shows_the_unit(rate: float, unit: str, shown: bool) -> None:
    assert is_shown(at(rate), CLOCKS[unit], 1.2) is shown
    assert not is_shown(at(rate), CLOCKS[unit], 8.0), "the valve that is left over is none of the rig's"


def test_a_recorded_velocity_shows_the_unit() -> None:
    true = np.arange(2000) / 1e3
    moved = {"slide__position": np.sin(true), "slide__velocity": np.cos(true)}
    assert is_shown(at(1e3 * 60.0 / 0.7, **moved), 60.0 / 0.7, 1.0)  # no usual rate, either way
    assert not is_shown(at(1e3, **moved), 60.0, 1.0)


def test_a_clock_that_fits_another_cylinder_is_not_asked() -> None:
    rig = cast(Rig, SimpleNamespace(path=Path("j.toml")))
    both = either(at(1e3), "minutes", ["left"], 87.4, rig)
    assert both.refused and "87 times faster" in both.says and "minutes" in both.says and "cylinders.left of j.toml" in both.says
    size = either(at(1e3), "", ["left"], 0.01, rig)
    assert size.refused and "100 times slower" in size.says and "minutes" not in size.says and "correct bore" in size.says


def test_minutes_are_put_right(tmp_path: Path) -> None:
    (path,) = write_case(make_case("bench", [], 31, 1.0, Conditions(duration=12.0)), tmp_path)
    rig, recorded = read(tmp_path / "rig.toml"), reader.read(path).recording
    settled, (check,) = in_order(replace(recorded, time=recorded.time / 60.0), Machine.of(rig, load(rig)))
    assert check.what == "unit" and "Taken as minutes" in check.says
    assert np.allclose(settled.time, recorded.time)
