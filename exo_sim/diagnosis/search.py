"""Which questions the data answer with yes: screened by their signatures, confirmed by full fits, accepted only if material.

A screen projects each candidate's answer clear of the believed numbers; the best few are fitted whole. Several sets are grown side
by side until one reaches the noise, because the effect that explains most alone need not be one of the two that are there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitted_set import Found, Problem, SetKey, Trial, key_of, sizeable
from exo_sim.diagnosis.fitting import FEWEST_ROWS, Fit
from exo_sim.diagnosis.intervals import spreads
from exo_sim.diagnosis.quantity import Candidate, Quantity, standing
from exo_sim.diagnosis.screening import screen
from exo_sim.diagnosis.set_fits import SetFits
from exo_sim.diagnosis.threads import ALONE, Threads
from exo_sim.diagnosis.weighing import CLEAN, Weighing, loss, passes, promises, weigh

Array = NDArray[np.float64]

#: A simpler question that explains this share of what the best one does is taken in its place.
NEARLY = 0.93
#: ... unless its log-likelihood is lower by more than this.
NO_WORSE = 12.0
#: How many of the screened candidates are fitted whole.
FINALISTS = 4
#: How many sets are grown side by side while none reaches the noise.
BEAM = 3
#: A finding stands if one of its numbers is this many standard errors from neutral.
CERTAIN = 2.5
#: ... or if the log-likelihood without it is lower by more than this: then its number is vague only beside believed ones.
PLAIN = 30.0
#: Beyond so many times what no healthy machine leaves, names are sought on only while each halves the error.
IN_VAIN = 15.0
#: How often rivals may take a finding's place in the end.
MOST_TURNS = 2


class Search:
    """A search over one problem.

    Args:
        problem: The cut.
        nuisances: Believed numbers, refitted in every comparison.
        library: The questions.
        threads: Threads; what is found does not depend on how many.
        progress: Told in a few words what is going on.
        most: The most findings.
        cheap: Whether predictions cost little: then all that are promising are fitted, from scratch, and in plainer ones' place.
        material: Drop of the root-mean-square error, in units of the noise, below which nothing is a finding.
        until: Says of a set that explains not everything whether to look no further.
    """

    def __init__(
        self,
        problem: Problem,
        nuisances: Sequence[Quantity],
        library: Sequence[Candidate],
        threads: Threads = ALONE,
        progress: Callable[[str], None] | None = None,
        most: int = 5,
        cheap: bool = False,
        material: float = 0.0,
        until: Callable[[Trial], bool] | None = None,
    ):
        self.sets = SetFits(problem, nuisances, threads, cheap)
        self.library, self.most, self.cheap, self.material = tuple(library), most, cheap, material
        self._say = progress or (lambda words: None)
        self._until = until or (lambda trial: False)
        self._whole: Trial | None = None
        self._screened: dict[SetKey, list[tuple[float, Candidate]]] = {}

    # -- weighing ---------------------------------------------------------------------------------------------------

    def weigh(self, without: Trial, with_it: Trial) -> Weighing:
        """Say how much better `with_it` explains the training time than `without`."""
        added = with_it.numbers - without.numbers
        return weigh(self.sets.problem, without.fit, with_it.fit, added, len(self.library))

    def accepts(self, without: Trial, with_it: Trial) -> bool:
        """Say whether what `with_it` has more passes every gate."""
        whole = self._whole or without
        return passes(self.weigh(without, with_it), whole.fit, without.fit, with_it.fit, self.material)

    def _ranked(self, trials: Sequence[Trial]) -> list[Trial]:
        """Return trials by what they explain for what their numbers cost, best first."""
        rows, price = self.sets.rows(trials), self._price(trials)
        return sorted(trials, key=lambda trial: loss(trial.fit, rows) + price * trial.numbers)

    def _price(self, trials: Sequence[Trial]) -> float:
        """Return the log-likelihood that one more number must bring."""
        return 0.5 * math.log(max(self.sets.rows(trials), 2.0))

    def _clean(self, trial: Trial) -> bool:
        return trial.fit.sse < CLEAN * self.sets.problem.size

    # -- screening ---------------------------------------------------------------------------------------------------

    def screen(self, now: Trial) -> list[tuple[float, Candidate]]:
        """Return the candidates that are not in a trial by how much of its error their signatures could explain, best first."""
        key = key_of(now.chosen)
        if key not in self._screened:
            self._screened[key] = screen(self.sets.problem, now, self.library, self.sets.threads)
        return self._screened[key]

    # -- the search --------------------------------------------------------------------------------------------------

    def run(self) -> Found:
        """Grow sets side by side, swap and prune, then weigh every finding and its rivals."""
        self._say("refitting believed numbers")
        if self.sets.problem.size < FEWEST_ROWS:
            start = Trial((), Fit((), {}, np.zeros(0), np.zeros((0, 0))))
            return Found(start, start)
        start = best = self._whole = self.sets.polished(self.sets.try_set(()))
        beam = [start]
        for _ in range(self.most):
            self._say(f"screening {len(self.library)} questions")
            grown = self._grown(beam)
            if not grown:
                break
            leader = self._leader(grown)
            ordered = [leader, *(trial for trial in self._ranked(grown) if trial is not leader)]
            tidied = next((trial for trial in map(self._tidied, ordered) if trial.chosen), None)
            if tidied is None or (best.chosen and self.sets.loses(tidied, best) >= 0.0):
                break
            before, best = best, tidied
            self._say(f"{len(best.chosen)} found, {best.chosen[-1].effect.replace('_', ' ')} last")
            if not self._clean(best) and self._until(best):
                return Found(start, self.sets.polished(best), halted=True)
            if self._is_in_vain(before, best):
                break
            beam = [best]
            if not self._clean(best):
                beam += [trial for trial in self._ranked(grown) if trial.keys not in (best.keys, leader.keys)][: BEAM - 1]
        found = self._judged(start, self._settled(self.sets.polished(self._pruned(best))))
        for _ in range(MOST_TURNS):
            better = self._overtaken(found)
            if better is None:
                break
            found = self._judged(start, self._settled(self.sets.polished(self._pruned(better))))
        return found

    def _is_in_vain(self, before: Trial, now: Trial) -> bool:
        """Say whether a second or later name helped little against an error that no name stands beside: another machine's recording."""
        left = math.sqrt(now.fit.sse / self.sets.problem.size)
        lowered = math.sqrt(before.fit.sse / self.sets.problem.size) - left
        return len(now.chosen) > 1 and left > IN_VAIN * self.sets.problem.sick and lowered < left

    def _tidied(self, trial: Trial) -> Trial:
        """Return a set in its plainest form, without what does not stand beside the rest."""
        return self._simplest(self._pruned(self._swapped(trial) if self.cheap else trial))

    def _overtaken(self, found: Found) -> Trial | None:
        """Return the set with the best rival in a finding's place, where that explains more."""
        by_loss = [
            (worse, candidate, rival)
            for candidate in found.end.chosen
            for rival, worse in found.rivals[candidate.key][:1]
            if (rival.effect, rival.where) not in found.end.keys
        ]
        if not by_loss:
            return None
        worse, candidate, rival = min(by_loss, key=lambda one: one[0])
        if worse > -2.0:
            return None
        return self.sets.try_set(standing(tuple(rival if c is candidate else c for c in found.end.chosen)))

    def _grown(self, beam: Sequence[Trial]) -> list[Trial]:
        """Return every accepted set that has one candidate more than one of these."""
        asked = [(now, candidate) for now in beam for candidate in self._finalists(self._promising(now))]
        grown: dict[SetKey, Trial] = {}
        for (now, candidate), trial in zip(asked, self.sets.try_sets([((*now.chosen, one), now) for now, one in asked]), strict=True):
            if self.accepts(now, trial) and sizeable(candidate, trial):
                grown[key_of(trial.chosen)] = trial
        return list(grown.values())

    def _promising(self, now: Trial) -> list[tuple[float, Candidate]]:
        """Return the screened candidates that promise enough to be fitted, best first."""
        return [(score, candidate) for score, candidate in self.screen(now) if promises(score, now.fit, self.material)]

    def _finalists(self, ranked: list[tuple[float, Candidate]], count: int = FINALISTS) -> list[Candidate]:
        if self.cheap:
            count = len(self.library)
        picked: list[Candidate] = []
        for score, candidate in ranked:
            if len(picked) >= count or score <= 0.0:
                break
            if sum(1 for other in picked if (other.effect, other.where) == (candidate.effect, candidate.where)) < 2:
                picked.append(candidate)
        return picked

    def _leader(self, grown: Sequence[Trial]) -> Trial:
        """Return the best of these sets; of two that explain nearly the same, the one with fewer numbers."""
        assert self._whole is not None
        best = self._ranked(grown)[0]
        whole = self._whole.fit.sse
        simpler = [
            one
            for one in grown
            if one.numbers < best.numbers
            and whole - one.fit.sse > NEARLY * (whole - best.fit.sse)
            and self.sets.loses(one, best) < NO_WORSE
        ]
        return self._ranked(simpler)[0] if simpler else best

    def _swapped(self, now: Trial) -> Trial:
        """Try, for every finding, whether another question in its place explains more."""
        for index in range(len(now.chosen)):
            kept = now.others(now.chosen[index])
            base = self.sets.try_set(kept, now)
            for candidate in self._finalists(self.screen(base), 4):
                if (candidate.effect, candidate.where) in now.keys or len(standing((*kept, candidate))) <= len(kept):
                    continue
                trial = self.sets.try_set((*kept, candidate), base)
                if self.sets.loses(trial, now) < -2.0 - 2.0 * max(trial.numbers - now.numbers, 0):
                    now = trial
                    break
        return now

    def _pruned(self, now: Trial) -> Trial:
        """Leave out what does not pass the gates any more beside the others."""
        shrunk = True
        while shrunk and now.chosen:
            shrunk = False
            apart = [c for c in now.chosen if len(standing(now.others(c))) == len(now.others(c))]
            for candidate, without in zip(apart, self.sets.try_sets([(now.others(c), now) for c in apart], again=True), strict=True):
                if not self.accepts(without, now) or not sizeable(candidate, now):
                    now, shrunk = without, True
                    break
        return now

    def _settled(self, now: Trial) -> Trial:
        """Leave out what the data do not tell from nothing: numbers, and whole findings, within their error of neutral.

        Numbers that are vague only because they stand in for each other stay.
        """
        while now.chosen:
            if not all(sizeable(c, now) for c in now.chosen):  # the last touch to the numbers made one healthy
                fewer = self._pruned(now)
                if fewer is not now:
                    now = self.sets.polished(fewer)
                    continue
            spread = spreads(self.sets.problem, now.fit, self.sets.correlation_time(now.fit.residual))
            vague = {q for c in now.chosen for q in c.quantities if abs(now.fit.values[q] - q.neutral) < CERTAIN * spread.get(q, 0.0)}
            plainer = self._without(now, vague)
            if plainer is None:
                break
            now = self.sets.polished(self._pruned(plainer))
        return now

    def _without(self, now: Trial, vague: set[Quantity]) -> Trial | None:
        """Return a set with less of what is vague in it, None where there is none."""
        for candidate in now.chosen:
            others = now.others(candidate)
            clear = {q.parameter for q in candidate.quantities if q not in vague}
            if len(clear) == len(candidate.quantities):
                continue
            if len(standing(others)) < len(others):
                continue
            if len(candidate.quantities) == 1:
                trial = self.sets.try_set(others, now)
                if self.sets.loses(trial, now) < PLAIN:
                    return trial
                continue
            forms = [c for c in self.library if (c.effect, c.where) == (candidate.effect, candidate.where)
                     and {q.parameter for q in c.quantities} < {q.parameter for q in candidate.quantities}
                     and clear <= {q.parameter for q in c.quantities}]  # fmt: skip
            if self.cheap:
                taken = {(c.effect, c.where) for c in now.chosen}
                forms += [c for c in self.library if len(c.quantities) < len(candidate.quantities)
                          and (c.effect, c.where) not in taken and not c.beside]  # fmt: skip
            for form in sorted(forms, key=lambda c: len(c.quantities)):
                trial = self.sets.try_set((*others, form), now)
                if self._hardly_loses(trial, now):
                    return trial
        return None

    def _simplest(self, now: Trial) -> Trial:
        """Put each finding in the form that needs fewest numbers for what it explains; where fits are cheap, in a plainer one's place."""
        for candidate in now.chosen:
            best = now
            forms = self._forms(candidate, now)
            sets = [tuple(form if c.key == candidate.key else c for c in now.chosen) for form in forms]
            for form, trial in zip(forms, self.sets.try_sets([(chosen, now) for chosen in sets]), strict=True):
                plainer = (form.effect, form.where) == (candidate.effect, candidate.where) and trial.numbers < best.numbers
                if self._ranked((trial, best))[0] is trial or (plainer and self._hardly_loses(trial, best)):
                    best = trial
            now = best
        return now

    def _forms(self, candidate: Candidate, now: Trial) -> list[Candidate]:
        """Return what may stand in a candidate's place: other forms of the same effect; where fits are cheap, plainer effects too."""
        forms = []
        for form in self.library:
            more = len(form.quantities) - len(candidate.quantities)
            same = (form.effect, form.where) == (candidate.effect, candidate.where)
            plainer = self.cheap and more < 0 and (form.effect, form.where) not in now.keys
            if form.key != candidate.key and now.bears(form) and (plainer or (same and more <= 2)):
                forms.append(form)
        return forms

    def _hardly_loses(self, one: Trial, other: Trial) -> bool:
        """Say whether the plainer form of an effect explains all but a thousandth of what the fuller one does."""
        assert self._whole is not None
        whole = self._whole.fit.sse
        return whole - one.fit.sse > 0.999 * (whole - other.fit.sse) or self.sets.loses(one, other) < NO_WORSE

    def _with_all_parts(self, candidate: Candidate, now: Trial) -> Trial | None:
        """Return a set with all numbers of a finding in it; None where they are in it, or do not fit better."""
        forms = [c for c in self.library if (c.effect, c.where) == (candidate.effect, candidate.where)]
        fullest = max(forms, key=lambda form: len(form.quantities), default=candidate)
        if len(fullest.quantities) <= len(candidate.quantities):
            return None
        whole = self.sets.polished(self.sets.try_set((*now.others(candidate), fullest), now, again=True))
        return whole if self.sets.loses(whole, now) <= 0.0 else None

    def _judged(self, start: Trial, end: Trial) -> Found:
        """Weigh each finding against leaving it out and against what could take its place."""
        found = Found(start, end)
        asked: list[tuple[Candidate | None, Candidate, Trial]] = []
        bare = self.sets.try_sets([(end.others(candidate), end) for candidate in end.chosen])
        for candidate, without in zip(end.chosen, bare, strict=True):
            found.weighings[candidate.key] = self.weigh(without, end)
            found.rivals[candidate.key] = []
            rivals = self._finalists(self.screen(without), 4)
            asked += [(candidate, r, without) for r in rivals if (r.effect, r.where) != (candidate.effect, candidate.where)]
        for candidate in (c for c in end.chosen if c.adds_up):
            whole = self._with_all_parts(candidate, end)
            if whole is not None:
                found.whole[candidate.key] = whole
        promised = {one.key: score for score, one in self.screen(end)}
        for one in self._finalists(self.screen(end), 3):
            if promises(promised[one.key], end.fit, self.material):
                asked.append((None, one, end))
            else:
                left = end.fit.sse - self.sets.problem.size  # beyond the noise
                found.runners_up.append((one, min(promised[one.key] / left, 1.0) if left > 0.0 else 0.0))
        trials = self.sets.try_sets([((*near.chosen, more), near) for _, more, near in asked])
        for (taken, more, near), trial in zip(asked, trials, strict=True):
            if taken is None:
                found.runners_up.append((more, self.weigh(near, trial).share))
            else:
                worse = self.sets.loses(trial, end) + self._price((trial, end)) * (trial.numbers - end.numbers)
                found.rivals[taken.key].append((more, worse))
        for by_worse in found.rivals.values():
            by_worse.sort(key=lambda pair: pair[1])
        found.runners_up.sort(key=lambda pair: -pair[1])
        return found
