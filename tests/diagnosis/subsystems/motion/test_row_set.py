"""The rows of several recordings in one order, those of onsets behind all others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from diagnosis import motion_runs, starts

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.subsystems.motion.missing_force import MissingForce
from exo_sim.diagnosis.subsystems.motion.onsets import Starting, onsets_of
from exo_sim.diagnosis.subsystems.motion.row_set import RowSet

FIRST = starts.run(8.0)
RUNS = (FIRST, replace(FIRST, recording="second"))
PLANT = motion_runs.plant()


def onsets() -> list:
    return [
        (number, onsets_of(run, np.ones(len(run.time), dtype=bool), -MissingForce(run).of(PLANT), Starting(starts.DAMPING)))
        for number, run in enumerate(RUNS)
    ]


def test_rows_of_both_recordings_stand_one_behind_the_other_in_blocks_of_their_own() -> None:
    rows = RowSet.of(RUNS, Split({}), on_test=False)
    half = rows.of_motion // 2
    assert rows.scale.size == rows.blocks.size == rows.recording.size == rows.of_motion == 2 * half
    np.testing.assert_array_equal(rows.recording, np.repeat([0, 1], half))
    assert rows.blocks[:half].max() < rows.blocks[half:].min()
    missing = rows.missing(PLANT)
    np.testing.assert_array_equal(missing[:half], missing[half:])
    np.testing.assert_allclose(missing[:half], rows.rows[0].means(MissingForce(FIRST).of(PLANT)), rtol=1e-9, atol=1e-9)


def test_onsets_stand_behind_them_and_share_the_blocks_of_their_recording() -> None:
    plain = RowSet.of(RUNS, Split({}), on_test=False)
    rows = plain.with_onsets(onsets())
    behind = rows.scale.size - rows.of_motion
    assert behind == 2 * onsets()[0][1].at.size > 0 and rows.of_motion == plain.of_motion
    np.testing.assert_array_equal(rows.missing(PLANT)[: rows.of_motion], plain.missing(PLANT))
    np.testing.assert_array_equal(rows.recording[rows.of_motion :], np.repeat([0, 1], behind // 2))
    late = rows.blocks[rows.of_motion :][behind // 2 :]
    assert late.min() > plain.blocks[plain.recording == 0].max()
    assert (np.abs(rows.velocity[rows.of_motion :]) == np.abs(plain.velocity).min()).all()


def test_of_no_time_there_are_no_rows() -> None:
    rows = RowSet.of(RUNS, Split({}), on_test=True)
    assert rows.of_motion == rows.scale.size == rows.velocity.size == rows.missing(PLANT).size == 0


def test_an_onset_behind_all_motion_of_its_recording_is_in_no_block_of_the_next() -> None:
    early = RowSet.of(RUNS, Split({"recording": ((3.0, 12.0),)}), on_test=False)
    rows = early.with_onsets(onsets())
    first, second = (set(rows.blocks[rows.recording == number].tolist()) for number in (0, 1))
    assert max(first) > 8 and not first & second


def test_onsets_of_a_time_without_motion_have_a_direction() -> None:
    none = RowSet.of(RUNS, Split({}), on_test=True)
    rows = none.with_onsets(onsets())
    ways = np.concatenate([one.way for _, one in onsets()])
    np.testing.assert_array_equal(np.sign(rows.velocity), ways)
