"""When feet touch and leave the ground, from recorded ground forces or from a recorded gait phase."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.table import Recording

#: Vertical force from which a foot stands, as a share of its greatest, and at least this many newtons.
CONTACT_SHARE, CONTACT_FORCE = 0.05, 20.0
#: Contacts and flights shorter than this, seconds, are chatter.
SHORTEST = 0.08


@dataclass(frozen=True)
class FootEvents:
    """Contacts of one foot.

    Attributes:
        foot: The site that was recorded.
        contacts: Seconds at which it touches the ground.
        leaves: Seconds at which it leaves it.
        stance_share: Share of the time on the ground.
        peak_force: Greatest vertical force, N; None where only stance was recorded.
    """

    foot: str
    contacts: tuple[float, ...]
    leaves: tuple[float, ...]
    stance_share: float
    peak_force: float | None

    @property
    def stride_times(self) -> NDArray[np.float64]:
        """Seconds from each contact to the next, shape (strides,)."""
        return np.diff(self.contacts)


def feet(recording: Recording) -> tuple[FootEvents, ...]:
    """Return the contacts of every foot whose vertical ground force or stance was recorded."""
    found = []
    for key in recording.columns:
        part, signal = key.rsplit(".", 1)
        values = recording[key]
        if signal == "ground_force_z":
            peak = float(np.nanmax(values))
            stands = values > max(CONTACT_FORCE, CONTACT_SHARE * peak)
            found.append(_events(part, recording.time, stands, peak))
    if found:
        return tuple(found)
    for side, name in (("stance_r", "right foot"), ("stance_l", "left foot")):
        stance = recording.get(f"gait.{side}")
        if stance is not None:
            found.append(_events(name, recording.time, stance > 0.5, None))
    return tuple(found)


def _events(foot: str, time: NDArray[np.float64], stands: NDArray[np.bool_], peak: float | None) -> FootEvents:
    on = _without_chatter(time, stands)
    turns = np.flatnonzero(np.diff(on.astype(np.int8)))
    contacts = tuple(float(time[i + 1]) for i in turns if on[i + 1])
    leaves = tuple(float(time[i + 1]) for i in turns if not on[i + 1])
    weights = np.gradient(time)
    return FootEvents(foot, contacts, leaves, float((on * weights).sum() / weights.sum()), peak)


def _without_chatter(time: NDArray[np.float64], stands: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Close short flights first, then drop short contacts; the first and last run may be cut off and stay."""
    on = stands.copy()
    for state in (False, True):
        edges = 1 + np.flatnonzero(np.diff(on))
        for start, stop in itertools.pairwise(edges):
            if on[start] == state and time[stop] - time[start] < SHORTEST:
                on[start:stop] = not state
    return on
