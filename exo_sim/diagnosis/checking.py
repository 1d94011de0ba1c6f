"""Rounds: a case is examined anew without the names that its check does not bear out, or with another part of it kept back."""

from __future__ import annotations

from dataclasses import replace

from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.examining import Doubts, Examined, Progress, examine, has_filled_in, leave_open
from exo_sim.diagnosis.proof import doubtful
from exo_sim.diagnosis.result import Finding
from exo_sim.diagnosis.split import Split, split
from exo_sim.diagnosis.threads import Threads

#: Where the check is missed by so many times what the fit leaves, it shows something that the fit never met.
SURPRISE = 3.0

#: A name that changes predictions of the check by less than this, in units of the noise, was not tested there.
FELT = 0.3

#: Where the proof is missed by so many times what the fit leaves, something acts there that has not been found.
UNMET = 8.0
#: ... and by so many where it is missed by more than any healthy machine's is.
UNMET_AND_SICK = 4.0

#: A fit that looks healthy is not believed where the check is sick, and the proof by so many times the most that a healthy machine leaves.
CLEARLY_SICK = 1.25

#: How often a case is examined without what its check did not bear out.
MOST_DOUBTS = 4


def examined_and_checked(case: Case, threads: Threads, say: Progress) -> Examined:
    """Examine a case with its end kept back, or with its beginning where the check shows what the fit never met and that is met better."""
    times = [(table.name, table.time) for table in case.recordings]
    found = _checked(case, split(times), threads, say)
    if found.surprise <= SURPRISE:
        return found
    say("the check shows what the fit never met: the beginning is kept back instead")
    return min(found, _checked(case, split(times, head=True), threads, say), key=lambda one: one.surprise)


def unmet(examined: Examined) -> list[Finding]:
    """Return a finding for every balance of which the proof shows something that the rest of the time never met.

    So it is also where the fit of a lone recording looks healthy, and check and proof are missed by more than any healthy machine's
    balance is.
    """
    found = []
    for one in examined.judged:
        missed = examined.proof.missed.get((one.cut, one.where))
        if missed is None:
            continue
        checked = examined.check.missed.get((one.cut, one.where)) if examined.check else None
        surprising = missed.ratio > (UNMET_AND_SICK if missed.is_sick() else UNMET)
        lasting = checked is not None and checked.is_newly_sick() and missed.is_newly_sick(CLEARLY_SICK)
        if not surprising and not lasting:
            continue
        if has_filled_in(one):
            leave_open(one, examined.case)
        elif not one.nameless:
            often = f"{missed.ratio:.0f} times as much as in the rest" if surprising else "by more than any healthy machine's is"
            what = "something acts there that the rest never met" if surprising else "what holds of the rest does not hold there"
            says = f"In the time kept back the {one.balance} of {one.where} is missed {often}: {what}; record more of it."
            found.append(Finding("unknown", one.where, "unknown", says, {}, missed.log10_odds, 0.0))
    return found


def _checked(gathered: Case, parts: Split, threads: Threads, say: Progress) -> Examined:
    """Examine a case, and again without the names that its check does not bear out."""
    doubted: Doubts = {}
    for _ in range(MOST_DOUBTS):
        examined = examine(gathered, parts, doubted, threads, say)
        new = _doubts(examined)
        if not new:
            return examined
        doubted = {**doubted, **new}
    for one in examined.judged:  # what still comes up is not believed either
        one.findings[:] = [finding for finding in one.findings if (finding.name, finding.where) not in doubted]
    return replace(examined, doubted=doubted)


def _doubts(examined: Examined) -> Doubts:
    if examined.check is None:
        return {}
    found: Doubts = {}
    for finding in (finding for one in examined.judged for finding in one.findings):
        key = f"{finding.name}@{finding.where}"
        drop = examined.check.drops.get(key)
        if drop is not None and examined.check.felt[key] > FELT and doubtful(drop, finding.log10_odds):
            says = "does not fall" if drop <= 0.0 else f"falls by no more than {100 * drop:.0f} %"
            found[finding.name, finding.where] = f"on time that no number was fitted to, the error {says} with it"
    return found
