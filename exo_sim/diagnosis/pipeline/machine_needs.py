"""Findings that balances call too small to matter, and without which the whole machine is predicted worse.

A balance of forces knows a level of dry friction no better than the laws of healthy friction are wrong, and yet in a machine that a
controller steers that level decides where the piston sticks. So the machine itself is asked: run with the finding and without it, over
windows of the held-out time.
"""

from __future__ import annotations

import math
from dataclasses import replace

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.outcome.rig_update import rig_update
from exo_sim.diagnosis.pipeline.plan import Examination
from exo_sim.diagnosis.pipeline.rig_trial import gain
from exo_sim.diagnosis.policy.validation import NEEDED_BY_THE_MACHINE, SURELY_BETTER
from exo_sim.diagnosis.validation.machine_runs import MachineRuns
from exo_sim.errors import ModelError, RigError
from exo_sim.rig import Rig, parse
from exo_sim.simulation.replay import WINDOW


def with_what_the_machine_needs(whole: Examination, found: Examination, is_spent: IsSpent = never) -> Examination:
    """Return an examination in which small findings that the whole machine needs stand among the others again.

    Args:
        whole: With all findings.
        found: The same without its small findings, which it holds beside them.
        is_spent: Whether the time is up: then nothing is run.
    """
    for finding in found.small:
        if is_spent():
            break
        richer = whole.holding_small(tuple(one for one in found.small if one is not finding))
        if is_needed(found, richer):
            found = richer
    return found


def is_needed(without: Examination, with_it: Examination) -> bool:
    """Return whether windows of the whole machine, in held-out time, are predicted surely and plainly better by the second than the first.

    Args:
        without: An examination without some finding.
        with_it: The same with it.
    """
    data, split = without.data, without.plan.split
    try:
        poorer, richer = (_rig_of(one) for one in (without, with_it))
        runs = MachineRuns(replace(data, rig=poorer), split.deciding(), WINDOW)
        by, error = gain(runs, richer, data)
    except (RigError, ModelError):
        return False
    return by - SURELY_BETTER * error > -math.log1p(-NEEDED_BY_THE_MACHINE)


def _rig_of(examination: Examination) -> Rig:
    """Return the rig that an examination would improve its own to."""
    data = examination.data
    update = rig_update(data, examination.results.all, examination.unknown)
    return parse(update.text(data.rig.path.parent), data.rig.path)
