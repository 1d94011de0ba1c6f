"""The recorded strides, as figures: what `scripts/fit_gait` computed from the recordings."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np

from exo_sim.errors import ScenarioError, nearest
from exo_sim.gait.fourier import Series


@dataclass(frozen=True)
class RecordedGait:
    """One recording's stride from heel strike to heel strike of the same leg; angles [rad], moments [N m].

    Attributes:
        source: Who measured it, and its licence.
        period: Stride time [s].
        stride: Stride length at the reference body height [m]; on a treadmill relative to the belt.
        stance_end: Phase at which the foot leaves the ground.
        ankle_offset: Added to recorded ankle angles so that the sole of a rigid foot lies flat in mid-stance [rad].
        mass: Of the person recorded [kg].
        motion: "thigh" (angle in space), "knee", "ankle", "tilt", "pelvis_x", "pelvis_z": the mean stride, moved within the spread so that
            a rigid chain's stance foot rests on the ground; pelvis_x is what is left of a steady advance.
        recorded, spread: "thigh", "knee", "ankle", "tilt": mean over trials and standard deviation between them.
        moment: "hip", "knee", "ankle": mean joint moments, signs as the angles'.
    """

    source: str
    period: float
    stride: float
    stance_end: float
    ankle_offset: float
    mass: float
    motion: dict[str, Series]
    recorded: dict[str, Series]
    spread: dict[str, Series]
    moment: dict[str, Series]


def names() -> tuple[str, ...]:
    """Return the names of the recorded gaits."""
    folder = resources.files("exo_sim.gait") / "recorded"
    return tuple(sorted(entry.name[:-5] for entry in folder.iterdir() if entry.name.endswith(".toml")))


@cache
def load(name: str) -> RecordedGait:
    """Read one recorded gait.

    Raises:
        ScenarioError: there is none of this name.
    """
    if name not in names():
        raise ScenarioError(f'no recorded gait "{name}"{nearest(name, names())}')
    return parse((resources.files("exo_sim.gait") / "recorded" / f"{name}.toml").read_text(encoding="utf-8"))


def parse(text: str) -> RecordedGait:
    """Read what `scripts/fit_gait` writes."""
    data = tomllib.loads(text)

    def series(group: str) -> dict[str, Series]:
        return {
            key: Series(entry["mean"], np.array(entry["cosine"]), np.array(entry["sine"]))
            for key, entry in data[group].items()
        }

    numbers = {key: data[key] for key in ("source", "period", "stride", "stance_end", "ankle_offset", "mass")}
    return RecordedGait(
        **numbers,
        motion=series("motion"),
        recorded=series("recorded"),
        spread=series("spread"),
        moment=series("moment"),
    )
