"""The one table: columns by name, spans, pieces that follow each other, and thinning."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from exo_sim.recording import write_rrd, write_table
from exo_sim.recording.table import Recording

TIME = np.arange(10.0) * 0.1
TABLE = Recording("r", TIME, {"a.x": np.arange(10.0), "b.x": -np.arange(10.0), "a.y": TIME}, {"a.x": "m", "b.x": "m", "a.y": "s"})


def test_columns_are_found_by_name_and_parts_keep_their_order() -> None:
    assert "a.x" in TABLE and "c.x" not in TABLE and TABLE.get("c.x") is None
    assert TABLE["b.x"][3] == -3.0 and TABLE.parts() == ("a", "b")
    assert TABLE.duration == pytest.approx(0.9) and Recording("e", np.zeros(0), {}, {}).duration == 0.0


def test_pieces_of_a_recording_put_together_are_the_recording() -> None:
    whole = TABLE.span(-1.0, 0.45).followed_by(TABLE.span(0.45, 9.0))
    np.testing.assert_array_equal(whole.time, TABLE.time)
    for key, values in TABLE.columns.items():
        np.testing.assert_array_equal(whole[key], values)
    assert len(TABLE.span(0.2, 0.5).time) == 3  # the end does not belong to it


@pytest.mark.parametrize(("most", "left"), [(10, 10), (9, 5), (4, 4), (1, 1)])
def test_thinning_leaves_no_more_than_asked_in_even_steps(most: int, left: int) -> None:
    thin = TABLE.thinned(most)
    assert len(thin.time) == left == len(thin["a.x"]) and (thin is TABLE) == (most == 10)
    assert len({round(step, 9) for step in np.diff(thin.time)}) <= 1


def test_a_name_that_is_no_utf8_can_be_written_everywhere(tmp_path: Path) -> None:
    odd = os.fsdecode(b"s\xff")
    recording = Recording(odd, TABLE.time, {"a.position": TABLE.time}, {"a.position": "m"}, {"scenario": odd, "rig": "a = 1\n"})
    assert recording.name == recording.metadata["scenario"] == "s\\udcff" and recording.metadata["rig"] == "a = 1\n"
    for ending in ("csv", "parquet"):
        write_table(tmp_path / f"r.{ending}", recording)
    write_rrd(tmp_path / "r.rrd", recording)
