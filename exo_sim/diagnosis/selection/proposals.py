"""What a search tries next: candidates by the score test, and other forms of those that it has."""

from __future__ import annotations

from collections.abc import Sequence

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy.budgets import FINALISTS, FORMS_OF_ONE
from exo_sim.diagnosis.selection.evidence import could_be_accepted
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SetKey, key_of
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.score_test import scores
from exo_sim.physics.declaration import declared


class Proposals:
    """Candidates for one subsystem.

    Args:
        fits: Fits of the subsystem's models.
        candidates: All candidates.
        practical_significance: As in `Comparisons`.
    """

    def __init__(self, fits: ModelFits, candidates: Sequence[Candidate], practical_significance: float):
        self.fits, self.candidates = fits, tuple(candidates)
        self._practical_significance = practical_significance
        self._scored: dict[SetKey, list[tuple[float, Candidate]]] = {}

    def scored(self, now: FittedModel) -> list[tuple[float, Candidate]]:
        """Return the candidates that are not in a model with the drop in squared error that they promise, best first."""
        key = key_of(now.candidates)
        if key not in self._scored:
            self._scored[key] = scores(self.fits.model, now, self.candidates, self.fits.threads)
        return self._scored[key]

    def promise_enough(self, promised: float, now: FittedModel) -> bool:
        """Return whether a candidate that promises such a drop is worth a full fit."""
        return could_be_accepted(promised, now.fit, self._practical_significance)

    def additions(self, now: FittedModel) -> list[Candidate]:
        """Return the candidates that are worth a full fit beside what a model has, best first."""
        return self._finalists([(score, candidate) for score, candidate in self.scored(now) if self.promise_enough(score, now)])

    def alternatives(self, now: FittedModel, count: int = FINALISTS) -> list[Candidate]:
        """Return the best scored candidates beside what a model has, whatever they promise."""
        return self._finalists(self.scored(now), count)

    def rivals(self, candidate: Candidate, without: FittedModel) -> list[tuple[float, Candidate]]:
        """Return what is declared to be mistaken for a candidate, or it for that, with the drop that each promises in its place."""
        own = declared()[candidate.effect].mistaken_for

        def is_like(one: Candidate) -> bool:
            return one.at != candidate.at and (one.effect in own or candidate.effect in declared()[one.effect].mistaken_for)

        like = [one for one in self.candidates if is_like(one)]
        return scores(self.fits.model, without, like, self.fits.threads)

    def _finalists(self, scored: Sequence[tuple[float, Candidate]], count: int = FINALISTS) -> list[Candidate]:
        if self.fits.cheap:
            count = len(self.candidates)
        picked: list[Candidate] = []
        for score, candidate in scored:
            if len(picked) >= count or score <= 0.0:
                break
            if sum(1 for other in picked if other.at == candidate.at) < FORMS_OF_ONE:
                picked.append(candidate)
        return picked

    def replacements(self, candidate: Candidate, now: FittedModel) -> list[Candidate]:
        """Return what may stand in a candidate's place: other forms of its effect; where fits are cheap, simpler effects too.

        Of a large model they are no richer: it was reached from proposals of every form.
        """
        forms, richer = [], 0 if now.is_large else 2
        for form in self.candidates:
            more = len(form.parameters) - len(candidate.parameters)
            same = form.at == candidate.at
            simpler = self.fits.cheap and more < 0 and form.at not in now.named
            if form.key != candidate.key and now.meets_prerequisite(form) and (simpler or (same and more <= richer)):
                forms.append(form)
        return forms

    def simpler(self, candidate: Candidate, now: FittedModel, keep: set[str]) -> list[Candidate]:
        """Return forms of a candidate's effect with fewer parameters, those of these names kept; where fits are cheap, others too."""
        names = {q.parameter for q in candidate.parameters}
        forms = [c for c in self.candidates if c.at == candidate.at and _names(c.parameters) < names and keep <= _names(c.parameters)]
        if self.fits.cheap:
            forms += [
                c for c in self.candidates
                if len(c.parameters) < len(candidate.parameters) and c.at not in now.named and not c.prerequisite
            ]  # fmt: skip
        return sorted(forms, key=lambda c: len(c.parameters))

    def fullest(self, candidate: Candidate) -> Candidate:
        """Return the form of a candidate's effect with the most parameters."""
        return max((c for c in self.candidates if c.at == candidate.at), key=lambda form: len(form.parameters), default=candidate)


def _names(parameters: Sequence[FreeParameter]) -> set[str]:
    return {q.parameter for q in parameters}
