"""Cases cut down from others, on a ramp of ten seconds."""

from __future__ import annotations

import numpy as np

from exo_sim.recording import Recording
from exo_sim.trials.real.case import BALANCE, TAIL, Known, RealCase
from exo_sim.trials.real.cut_down import THIN, ends, first, halved, rest, thinned


def ramp(name: str, seconds: float = 10.0) -> Recording:
    time = np.arange(0.0, seconds, 0.01)
    return Recording(name, time, {"slide.position": time / 10.0}, {"slide.position": "m"})


def case(measure: str, *recordings: Recording, held: tuple[Recording, ...] = ()) -> RealCase:
    return RealCase("ramps", "make", "rig", recordings, held, measure, "predicted", Known((), (), False, {}, "here"))


def test_first_and_rest_are_the_whole() -> None:
    whole = ramp("whole")
    begun, left = first(whole, 0.7), rest(whole, 0.7)
    assert set(begun.time) | set(left.time) == set(whole.time)
    assert begun.time[-1] <= left.time[0]


def test_a_slower_logger_skips_samples_and_smooths_nothing() -> None:
    whole = ramp("whole")
    slow = thinned(case(BALANCE, whole))
    assert (slow.name, slow.variant_of) == ("ramps_20hz", "ramps")
    (run,) = slow.recordings
    np.testing.assert_allclose(np.median(np.diff(run.time)), 1.0 / THIN)
    assert np.isin(run["slide.position"], whole["slide.position"]).all()


def test_half_is_of_the_whole_where_a_tail_is_held_out() -> None:
    whole = ramp("whole")
    assert halved(case(TAIL, first(whole, 0.7), held=(whole,))).recordings[0].time[-1] == first(whole, 0.5).time[-1]
    assert halved(case(BALANCE, whole)).recordings[0].time[-1] == first(whole, 0.5).time[-1]


def test_ends_are_the_first_and_the_last() -> None:
    assert [run.name for run in ends(case(BALANCE, *map(ramp, "abc"))).recordings] == ["a", "c"]
