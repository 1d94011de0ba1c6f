"""A constant force that was fitted beside dry friction, as a rig holds it: in friction of two directions, which moves a machine as both do.

No motion tells the two apart, and no rig file holds a force without a cause. Friction of one level alone is then off by that force in
either direction, and whoever uses the rig runs the whole machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.nominal_numbers import FORCE_OFFSET
from exo_sim.diagnosis.outcome.rig_update import RigUpdate
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.physics.effects import asymmetric_friction, coulomb_friction
from exo_sim.rig import EffectEntry, EffectSetting

_ONE, _TWO = coulomb_friction.EFFECT.name, asymmetric_friction.EFFECT.name
_SAYS = "Dry friction of one size beside a constant force that no rig holds, or friction that differs with direction: both move alike."


def with_constant_force(update: RigUpdate, results: Sequence[SubsystemResult[MotionModel]]) -> RigUpdate:
    """Return an update whose dry friction holds the constant force that was fitted beside it; the same one where there is none.

    Only friction that is not told from friction of two directions, of a piston of which the rig knows none.

    Args:
        update: What was found.
        results: Of the balances of forces.
    """
    for one in (one for one in results if not one.model.is_of_joint):
        offset = sum(value for q, value in one.final.fit.values.items() if q.effect == FORCE_OFFSET)
        alike = {finding.where for finding in one.findings if finding.name == _ONE and _TWO in finding.ambiguous_with}
        places = {where for where in alike if update.rig.effect(_ONE, where) is None}
        if offset and places:
            drive = one.model.runs[0].drive
            pushed = offset / math.copysign(drive.usual_arm, float(np.median(drive.arm)))
            parts = (replace(part, entries=tuple(_pushed(entry, places, pushed) for entry in part.entries)) for part in update.parts)
            update = replace(update, parts=tuple(parts))
    return update


def _pushed(entry: EffectEntry, places: set[str], force: float) -> EffectEntry:
    """Return an entry of dry friction with a force towards larger positions [N] in it; any other as it is."""
    setting = entry.setting
    if setting.name != _ONE or setting.where not in places:
        return entry
    ways = {"forward": -force, "backward": force}
    (level,), (ends,) = setting.parameters.values(), entry.intervals.values()
    held = {name: max(level + more, 0.0) for name, more in ways.items()}
    intervals = {name: (max(ends[0] + more, 0.0), max(ends[1] + more, 0.0)) for name, more in ways.items()}
    return EffectEntry(EffectSetting(_TWO, setting.where, held, setting.turning), intervals, _SAYS)
