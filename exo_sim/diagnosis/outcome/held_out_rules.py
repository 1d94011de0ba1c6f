"""What held-out time says of one finding: the rules by which it may fall, in the order in which they are asked.

1. `is_refuted`: it explains hardly anything of what is missing without it. It is not asked again, and every subsystem is searched anew.
2. `doubt`: its name is more likely wrong than right whatever its odds. The rest is fitted anew without it.
3. `too_small`: without it the machine is missed by no more than healthy machines are, or where it acts by no more than the noise. It is
   listed beside the findings.

A finding beside something unknown has passed a harder rule before, with which its search ended (`selection.decision`): its odds leave no
doubt, and held-out time is predicted better with it, block for block.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.findings import Finding, Kind
from exo_sim.diagnosis.outcome.finding_probability import is_doubtful, is_weighed_physics
from exo_sim.diagnosis.outcome.finding_size import errors_from_nil, may_be_nil
from exo_sim.diagnosis.policy import validation
from exo_sim.diagnosis.policy.acceptance import RELIEF
from exo_sim.diagnosis.policy.probability import LEAST_ERRORS
from exo_sim.diagnosis.selection.held_out_gain import HeldOutGain
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel


def is_refuted(drop: float, log10_odds: float, gain: HeldOutGain | None = None, together: bool = False) -> bool:
    """Return whether validation speaks against a finding: it hardly explains anything there, and its odds are not great.

    A fall of the error by a seventh may be all that is missing, where the rest is noise. Where more than noise is missing without it, the
    share of that counts. What is surely there is not useless, however little it is of all that is missing; and an error that rises by
    chance, where the change may be there or not, does not refute.

    Where hardly more than noise is missing without it, or others were weighed beside it, the error says little. Then it is refuted only if
    that time speaks against the change itself, and its odds are not great with that counted in. Where it tells nothing of the change, the
    error is all there is.

    Args:
        drop: The share by which the validation error falls with it.
        log10_odds: Its odds.
        gain: What it gains; None where nothing was compared.
        together: Whether it was weighed beside all others at once: then others explain most of what it would explain alone.
    """
    least = validation.LEAST_DROP_TOGETHER if together else validation.LEAST_DROP
    explains = gain.share if gain is not None and gain.is_plain and not together else drop
    useless = explains < least and log10_odds < validation.REFUTABLE_ODDS and not (gain is not None and gain.is_shown)
    harmful = drop < -validation.MOST_RISE and log10_odds < validation.REFUTABLE_RISE_ODDS and (gain is None or gain.is_absent)
    if gain is not None and gain.tells and (together or not gain.is_plain):
        return (useless or harmful) and gain.log10_odds < 0.0 and not _is_certain(log10_odds, gain)
    return useless or harmful


def _is_certain(log10_odds: float, gain: HeldOutGain) -> bool:
    """Return whether a finding is certain with what held-out time says of its change counted in."""
    return log10_odds + gain.log10_odds >= validation.CERTAIN_ODDS


def doubt(finding: Finding, share: float | None, compared: bool = True, beside_unknown: bool = False) -> str:
    """Return why a name is more likely wrong than right whatever its odds, "" where nothing says so.

    Odds alone do not do: where held-out time tests nothing and the number may be nil, neither speaks for the name. A sensor that is off
    is off at all times: one that held-out time does not show stands in for something else. Where laws that fit as well leave a number
    anywhere about nil, the law is in doubt and not the number alone; unless the odds against every account without it are great (the
    height of a dip at rest may be anything where no speed is low enough, and the dip is there; how much of a lag is its time constant may
    be anything beside the dead time of a healthy valve), or it explains nearly all that is missing.

    Args:
        finding: With its odds.
        share: Of the squared error beyond the noise that is missing without it, what it explains of held-out time; None where nothing
            was tested.
        compared: Whether there was held-out time with its signals, and the machine without it differs: a lag that a healthy valve's lag
            would take the place of is not left out.
        beside_unknown: Whether something without a name acts in its subsystem: what may be nil then stands in for a part of that.
    """
    if beside_unknown and may_be_nil(finding):
        return "beside something without a name its numbers may all be nil: it stands in for a part of that"
    is_open = is_weighed_physics(finding) and errors_from_nil(finding) < LEAST_ERRORS
    if is_open and finding.log10_odds < validation.REFUTABLE_ODDS and (share is None or share < validation.BORNE_OUT):
        return "laws of what the rig has that fit as well need none of it: its number is smaller than its own standard error"
    if share is None:
        untested = "time that no number was fitted to does not test it"
        if compared and finding.kind is Kind.SENSOR:
            return f"{untested}, where a sensor at fault would be as much at fault as before"
        vague = may_be_nil(finding) and (compared or finding.log10_odds < validation.REFUTABLE_ODDS)
        return f"{untested}, and the interval of its number holds nil" if vague else ""
    if not is_doubtful(share):
        return ""
    return (
        f"it explains {100 * share:.0f} % of what is missing without it, on time that no number was fitted to: "
        "names that explain so little are mostly wrong"
    )


def too_small(
    one: SubsystemResult[SubsystemModel], left: Mapping[str, float], where_acting: Mapping[str, float],
    beyond_healthy: Mapping[str, float], tested: Mapping[str, HeldOutGain], relief: Mapping[str, float] = MappingProxyType({}),
) -> tuple[Finding, ...]:  # fmt: skip
    """Return the findings of a subsystem without which it is missed by no more than healthy machines are, also in held-out time.

    Whatever their odds: what mends a little of what every model gets wrong has great odds in a long recording. Names of a balance of
    forces are weighed beside that already, and a dip of friction acts in few rows: they are small where noise explains what is left
    without them, in held-out time as a whole and in the rows that they change, and where they change these by no more than the laws of
    a healthy machine get wrong; or where they change them by next to nothing of that, whatever misses these rows. Noise is what the
    sensors' data sheets and a floor say, or, of what is larger than healthy laws are off, what is left in fact: the floor may be three
    times that.

    Args:
        one: Of one subsystem.
        left: By `effect@where`, the error of the time that was fitted without it [units of the noise].
        where_acting: By the same, the error without it in rows that it changes, of held-out time if it changes that [the most that noise
            leaves by itself].
        beyond_healthy: By the same, how much it changes the rows of the time that was fitted [what laws of a healthy machine get wrong];
            not asked of what is not in it.
        tested: Those that held-out time tests, and what they gain there: without them it is missed by more than the noise, and their
            predictions differ. A name of a gas that is not certain with that counted in is small all the same: what healthy machines
            leave has no particular shape, and every candidate explains a little of it.
        relief: By the same, how much nearer to their data sheets the rig's numbers are with it: what surely makes them right is not small.
    """

    def is_small(finding: Finding) -> bool:
        key = finding.key
        relieves = relief.get(key, 0.0) > RELIEF and finding.log10_odds >= validation.CERTAIN_ODDS
        if left.get(key, math.inf) > one.model.discrepancy_bound or relieves:
            return False
        if one.search.weighed_together and beyond_healthy.get(key, math.inf) < validation.NEGLIGIBLE:
            return True
        if key in tested:
            return not (one.search.weighed_together or _is_certain(finding.log10_odds, tested[key]))
        missed, beyond = where_acting.get(key, math.inf) / validation.LEAST_MISSED, beyond_healthy.get(key, 0.0)
        seen = missed >= min(rms(one.final.fit.residual), 1.0) and beyond >= validation.EXCEEDS_HEALTHY
        return not (one.search.weighed_together and (missed >= 1.0 or seen or beyond >= validation.BEYOND_HEALTHY))

    def said(finding: Finding) -> str:
        unsure = finding.key in tested and not _is_certain(finding.log10_odds, tested[finding.key])
        return wording.unsure(finding.name) if unsure else wording.small(finding.name, False)

    small = [finding for finding in one.findings if is_small(finding)]
    names = {finding.at for finding in small}
    borne = {(c.prerequisite, c.where) for c in one.named if c.prerequisite and c.at not in names}
    return tuple(replace(finding, says=said(finding)) for finding in small if finding.at not in borne)
