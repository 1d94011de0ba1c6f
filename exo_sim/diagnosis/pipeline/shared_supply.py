"""Pressure sensors that all seem off by one gain: the supply's sensor, which they are held against, is off instead.

The gas knows pressures by their ratio to the supply's. Independent sensors are hardly ever off by the same gain; one supply that reads too
much or too little, by a gain or a zero, makes them all seem so, and forces and masses with them. The machine is then examined once more
with the supply's pressure put right, and the supply's sensor is what is said to be off. Where that leaves more, or there is no time for
it, the gains stay, as an ambiguity: nobody's sensor is said to be at fault as almost certain.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.estimation.budget import Budget
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.pipeline.plan import Examination, Progress
from exo_sim.diagnosis.pipeline.rounds import examine_until_stable
from exo_sim.diagnosis.pipeline.sorting import sort
from exo_sim.diagnosis.policy.off_nominal import SAME_GAIN
from exo_sim.diagnosis.policy.probability import UNTESTED
from exo_sim.diagnosis.policy.validation import MOST_RISE
from exo_sim.physics.effects import sensor_bias, sensor_scale
from exo_sim.recording.table import Recording

SUPPLY = "supply.pressure"


def with_supply_put_right(
    stable: Examination, threads: Threads, report: Progress, budget: Budget, as_gathered: MachineData
) -> tuple[Examination, Budget]:
    """Return an examination in which a supply's sensor that is off accuses no other, and the budget that is left.

    Args:
        stable: The examination as it came out.
        threads, report, budget: Of the diagnosis.
        as_gathered: The data before anything was found.
    """
    gains = shared_gains(stable)
    if not gains:
        return stable, budget
    if budget.left > 0.0:  # what is ended early leaves more, and does not count
        report("examining once more with the supply's pressure put right")
        again = Budget(budget.left)
        found = examine_until_stable(put_right(as_gathered, gains), threads, report, again)
        if not shared_gains(found) and not _leaves_more(stable, found):
            return found, again
    return _in_doubt(stable, gains), budget


def shared_gains(examination: Examination) -> Mapping[str, Finding]:
    """Return by column the gains of chambers' sensors that are all off by one factor, beside a supply that was recorded, or nothing."""
    measured = {
        f"{run.cylinder}.pressure_{side + 1}"
        for one in examination.results.gas
        for run in examination.data.cylinders.get(one.where, ())
        for side in range(2)
        if run.pressure[side] is not None
    }
    recorded = all(SUPPLY in table for table in examination.data.recordings)
    gains = {
        each.where: each
        for one in examination.results.gas
        for finding in one.findings
        if finding.name == sensor_scale.EFFECT.name
        for each in finding.at_each_place()
        if each.where in measured
    }
    if not recorded or len(gains) < 2 or set(gains) != measured:
        return {}
    values = [each.parameters["factor"].value for each in gains.values()]
    return gains if min(values) > 0.0 and max(values) < SAME_GAIN * min(values) else {}


def put_right(data: MachineData, gains: Mapping[str, Finding]) -> MachineData:
    """Return data whose supply is what the chambers' sensors say, with the finding that the supply's sensor is off."""
    parts = [each.parameters["factor"] for each in gains.values()]
    gain = math.exp(sum(math.log(one.value) for one in parts) / len(parts))
    low, high = (1.0 / max(one.high for one in parts), 1.0 / min(one.low for one in parts))
    columns = " and ".join(sorted(gains))
    says = (
        f"The sensor of the supply is off: {columns} would all be off by one gain of {gain:.4g} otherwise. A zero of it shows alike where "
        "the supply hardly changes, and so does one card of all the others."
    )
    odds = min(each.log10_odds for each in gains.values())
    finding = Finding(
        sensor_scale.EFFECT.name, SUPPLY, Kind.SENSOR, says, {"factor": Estimate(1.0 / gain, "1", low, high)}, odds, 0.0,
        ambiguous_with=(sensor_bias.EFFECT.name,), probability=float(UNTESTED),
    )  # fmt: skip

    def right(table: Recording) -> Recording:
        return replace(table, columns={**table.columns, SUPPLY: gain * table[SUPPLY]})

    return sort(
        MachineData(
            data.rig, data.model, data.links, data.as_read, tuple(map(right, data.recordings)), {}, {}, (*data.sensors, finding),
            data.remarks, checks=data.checks,
        )
    )  # fmt: skip


def _leaves_more(before: Examination, after: Examination) -> bool:
    """Return whether a balance is missed by more, on time that no number was fitted to."""
    pairs = [(one, after.checked.balances.get(key)) for key, one in before.checked.balances.items()]
    return any(other is not None and max(other.error, 1.0) > (1.0 + MOST_RISE) * max(one.error, 1.0) for one, other in pairs)


def _in_doubt(examination: Examination, gains: Mapping[str, Finding]) -> Examination:
    """Return an examination whose equal gains may be the supply's sensor as well: none of them is almost certain."""
    says = f"All sensors of the chambers are off by one gain: rather one error of {SUPPLY}, which they are held against; check that first."

    def doubted(finding: Finding) -> Finding:
        if finding.name != sensor_scale.EFFECT.name or not any(each.where in gains for each in finding.at_each_place()):
            return finding
        rivals = (*finding.ambiguous_with, f"{sensor_scale.EFFECT.name} at {SUPPLY}")
        return replace(finding, says=says, probability=1.0 / (1.0 + len(gains)), ambiguous_with=rivals)

    gas = tuple(replace(one, findings=tuple(map(doubted, one.findings))) for one in examination.results.gas)
    return replace(examination, results=replace(examination.results, gas=gas))
