"""Cases cut down from others: less of a recording, fewer recordings, a slower logger."""

from __future__ import annotations

from dataclasses import replace

from exo_sim.recording import Recording
from exo_sim.trials.real.case import TAIL, RealCase

#: Rate to which slow recordings are thinned [Hz].
THIN = 20.0


def first(recording: Recording, share: float) -> Recording:
    """Return the first share of a recording's time."""
    return recording.span(recording.time[0], recording.time[0] + share * recording.duration)


def rest(recording: Recording, share: float) -> Recording:
    """Return what `first` leaves."""
    return replace(recording.span(recording.time[0] + share * recording.duration, recording.time[-1] + 1.0), name=f"{recording.name}_rest")


def with_given(case: RealCase, name: str, given: tuple[Recording, ...]) -> RealCase:
    """Return a case of another name whose tool gets these recordings."""
    return replace(case, name=name, recordings=given, variant_of=case.name)


def thinned(case: RealCase) -> RealCase:
    """Return a case with about `THIN` samples a second, as a slower logger takes them: nothing is smoothed."""
    return with_given(case, f"{case.name}_{THIN:g}hz", tuple(_thin(run) for run in case.recordings))


def halved(case: RealCase) -> RealCase:
    """Return a case with half of its recording: of the whole one where its tail is held out."""
    whole = case.held[0] if case.measure == TAIL else case.recordings[0]
    return with_given(case, f"{case.name}_half", (first(whole, 0.5),))


def ends(case: RealCase) -> RealCase:
    """Return a case with its first and last recording only."""
    return with_given(case, f"{case.name}_ends", (case.recordings[0], case.recordings[-1]))


def _thin(recording: Recording) -> Recording:
    every = max(1, round(1.0 / THIN / ((recording.time[-1] - recording.time[0]) / (len(recording.time) - 1))))
    return replace(recording, time=recording.time[::every], columns={key: values[::every] for key, values in recording.columns.items()})
