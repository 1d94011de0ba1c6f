"""What the sensors of a rig make of what was simulated, and what they saw, from what they showed."""

from __future__ import annotations

import importlib
from dataclasses import replace
from typing import Any

from exo_sim.errors import RigError, nearest
from exo_sim.physics.effects.declaration import declared
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


def seen_through(recording: Recording, rig: Rig) -> tuple[Recording, tuple[str, ...]]:
    """Return the recording with what the rig knows of its sensors taken off, and the columns that this put right."""
    columns = dict(recording.columns)
    sensing = [setting for setting in rig.effects if setting.name in ORDER and setting.where in columns]
    for setting in sorted(sensing, key=lambda each: -ORDER.index(each.name)):
        columns[setting.where] = _module(setting).truth(columns[setting.where], recording.time, **setting.parameters)
    return replace(recording, columns=columns), tuple(dict.fromkeys(setting.where for setting in sensing))


def _module(setting: EffectSetting) -> Any:
    return importlib.import_module(f"exo_sim.physics.effects.{setting.name}")
