"""What the sensors of a rig make of what was simulated, and what they saw, from what they showed."""

from __future__ import annotations

import importlib
import math
from dataclasses import replace
from typing import Any

import numpy as np

from exo_sim.errors import RigError, nearest
from exo_sim.physics.declaration import declared
from exo_sim.recording.table import Recording
from exo_sim.rig import EffectSetting, Rig

#: A sensor first is late, then reads in proportion, then is off: reading = factor * truth(t - delay) + bias.
ORDER = ("sensor_delay", "sensor_scale", "sensor_bias")


def observe(recording: Recording, rig: Rig) -> Recording:
    """Return the recording as the rig's sensors would have taken it; what has no sensor effect stays as it is.

    Raises:
        RigError: a sensor effect names a column that the recording does not have.
    """
    columns = dict(recording.columns)
    sensing = [setting for setting in rig.effects if declared()[setting.name].cut == "sensor"]
    for setting in sorted(sensing, key=lambda each: ORDER.index(each.name) if each.name in ORDER else len(ORDER)):
        if setting.where not in columns:
            raise RigError(
                f'{rig.path}: [effects.{setting.name}."{setting.where}"]: no such column in {recording.name}'
                f"{nearest(setting.where, columns)}"
            )
        columns[setting.where] = _module(setting).read(columns[setting.where], recording.time, **setting.parameters)
    return replace(recording, columns=columns) if sensing else recording


class Observer:
    """`observe` for a recording that comes piece by piece: what is late or early looks beyond the piece that it is in.

    Args:
        rig: Whose sensors they are.
    """

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        delays = [setting.parameters["seconds"] for setting in rig.effects if setting.name == "sensor_delay"]
        self._late, self._early = max([0.0, *delays]), max([0.0, *(-each for each in delays)])
        self._held: Recording | None = None
        self._shown = -math.inf

    def add(self, piece: Recording) -> Recording:
        """Return what can be shown once this piece is known: its rows, and those held back of the piece before it."""
        whole = piece if self._held is None else self._held.followed_by(piece)
        return self._show(whole, float(np.nextafter(whole.time[-1], math.inf)) - self._early)

    def rest(self) -> Recording | None:
        """Return what was held back until the end, if anything was."""
        if self._held is None or not self._early:
            return None
        return self._show(self._held, math.inf)

    def _show(self, whole: Recording, until: float) -> Recording:
        seen = observe(whole, self._rig).span(self._shown, until)
        if self._late or self._early:
            step = float(np.max(np.diff(whole.time))) if len(whole.time) > 1 else 0.0
            self._held = whole.span(until - self._late - 2.0 * step, math.inf)
        self._shown = until
        return seen


def seen_through(recording: Recording, rig: Rig) -> tuple[Recording, tuple[str, ...]]:
    """Return the recording with what the rig knows of its sensors taken off, and the columns that this put right."""
    columns = dict(recording.columns)
    sensing = [setting for setting in rig.effects if setting.name in ORDER and setting.where in columns]
    for setting in sorted(sensing, key=lambda each: -ORDER.index(each.name)):
        columns[setting.where] = _module(setting).truth(columns[setting.where], recording.time, **setting.parameters)
    return replace(recording, columns=columns), tuple(dict.fromkeys(setting.where for setting in sensing))


def _module(setting: EffectSetting) -> Any:
    return importlib.import_module(f"exo_sim.physics.effects.{setting.name}")
