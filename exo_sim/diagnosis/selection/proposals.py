"""What a search tries next: candidates by the score test, and other forms of those that it has."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.budgets import FINALISTS, FORMS_OF_ONE
from exo_sim.diagnosis.selection.evidence import could_any_be_accepted, could_be_accepted
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SetKey, key_of
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.score_test import Signatures, scores
from exo_sim.diagnosis.selection.shape_scan import best_shapes
from exo_sim.physics.declaration import declared, identification_of


class Proposals:
    """Candidates for one subsystem.

    Args:
        fits: Fits of the subsystem's models.
        candidates: All candidates; those that are asked only where a poorer form stands are kept apart, and are not among `candidates`.
        practical_significance: As in `Comparisons`.
    """

    def __init__(self, fits: ModelFits, candidates: Sequence[Candidate], practical_significance: float):
        self.fits, self.candidates = fits, tuple(one for one in candidates if not one.further)
        self._further = tuple(one for one in candidates if one.further)
        self._practical_significance = practical_significance
        self._scored: dict[SetKey, list[tuple[float, Candidate]]] = {}
        self._latest: tuple[SetKey, Signatures] | None = None

    def scored(self, now: FittedModel) -> list[tuple[float, Candidate]]:
        """Return the candidates that are not in a model with the drop in squared error that they promise, best first.

        Where fits cost much and none could be accepted, none is asked.
        """
        key = key_of(now.candidates)
        if not self.fits.cheap and not could_any_be_accepted(now.fit, self._practical_significance):
            return []
        if key not in self._scored:
            self._scored[key] = scores(self.fits.model, now, self.candidates, self.fits.threads, self._beside(now), self.fits.is_spent)
        return self._scored[key]

    def _beside(self, model: FittedModel) -> Signatures:
        """Return the signatures of candidates beside a model; only those of the latest are kept, for they take much memory."""
        key = key_of(model.candidates)
        if self._latest is None or self._latest[0] != key:
            self._latest = key, Signatures(self.fits.model, model, self.fits.signature_sizes, self.fits.promised)
        return self._latest[1]

    def promise_enough(self, promised: float, now: FittedModel) -> bool:
        """Return whether a candidate that promises such a drop is worth a full fit."""
        return could_be_accepted(promised, now.fit, self._practical_significance)

    def additions(self, now: FittedModel, later: bool = False) -> list[Candidate]:
        """Return the candidates that are worth a full fit beside what a model has, best first; or those of the next scores."""
        worth = [(score, candidate) for score, candidate in self.scored(now) if self.promise_enough(score, now)]
        first = self._finalists(worth)
        if not later:
            return first
        asked = {candidate.at for candidate in first}
        return self._finalists([pair for pair in worth if pair[1].at not in asked])

    def shaped(self, now: FittedModel) -> list[FittedModel]:
        """Return models with one more candidate whose answer is not in proportion, each where a fit of it is worth beginning.

        Also in a further form: a hose of small bore is as warm as the room, and without that does nothing for what it explains.
        """
        asked = [one for one in (*self.candidates, *self._further) if one.at not in now.named and now.meets_prerequisite(one)]
        begun = best_shapes(self.fits.model, now, asked, self.fits.threads, self.fits.is_spent)
        return [model for drop, model in begun if self.promise_enough(drop, now)]

    def shapes_of(self, candidate: Candidate) -> list[Candidate]:
        """Return the forms of a candidate that have several shapes; none where its answer is in proportion to its size."""
        return [c for c in (*self.candidates, *self._further) if c.shapes and (c.at, c.fixed) == (candidate.at, candidate.fixed)]

    def reshaped(self, candidate: Candidate, now: FittedModel, without: FittedModel) -> FittedModel | None:
        """Return where a fit begins with an effect of a model at its best shape; None where none of them promises to leave less.

        An effect that came with others was begun where its usual sizes are: a hose of a tenth of its volume is as good as none, and no
        step leads from there to what it is.

        Args:
            candidate: The effect.
            now: The model.
            without: The model without it.
        """
        forms = self.shapes_of(candidate)
        begun = best_shapes(self.fits.model, without, forms, self.fits.threads, self.fits.is_spent)
        drop, model = max(begun, key=lambda one: one[0], default=(0.0, now))
        return model if without.fit.sse - drop < now.fit.sse else None

    def alternatives(self, now: FittedModel, count: int = FINALISTS) -> list[Candidate]:
        """Return the best scored candidates beside what a model has, whatever they promise."""
        return self._finalists(self.scored(now), count)

    def successors(self, candidate: Candidate, without: FittedModel, whole: FittedModel) -> list[tuple[float, Candidate]]:
        """Return what may take a finding's place, with the drop that each promises there.

        Of a large model that is only what is declared to be mistaken for it, or it for that; but of a sensor's fault it is everything, for
        one that is off does a little of what any effect does. Signatures are those beside the whole model, where they are predicted once
        for all findings.

        Args:
            candidate: The finding.
            without: The model without it.
            whole: The model.
        """
        few = whole.is_large and candidate.kind is not Kind.SENSOR
        asked = [one for one in self.candidates if one.at != candidate.at and (not few or is_declared_alike(candidate, one))]
        return scores(self.fits.model, without, asked, self.fits.threads, self._beside(whole), self.fits.is_spent)

    def best(self, scored: Sequence[tuple[float, Candidate]]) -> list[Candidate]:
        """Return the few best of scored candidates, not too many forms of one effect among them."""
        return self._finalists(scored)

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

        Of one column all errors are tried: beside a zero that may drift, a scale looks like a bias until both are fitted.
        Of a large model they are no richer, for it was reached from proposals of every form; but for those that are asked at once where
        commands only switch, which say another thing of an effect than its poorer forms do.
        """
        forms, richer = [], 0 if now.is_large else 2
        at_once = [set(form) for form in identification_of(candidate.effect).switched]
        for form in self.candidates:
            more = len(form.parameters) - len(candidate.parameters)
            column = form.where == candidate.where and form.kind is candidate.kind is Kind.SENSOR and form.at not in now.named
            same = form.at == candidate.at or column
            simpler = self.fits.cheap and more < 0 and form.at not in now.named
            usual = more <= richer or _names(form.parameters) in at_once
            if form.key != candidate.key and now.meets_prerequisite(form) and (simpler or (same and usual)):
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

    def further(self, candidate: Candidate, now: FittedModel) -> list[Candidate]:
        """Return forms in which the law of a finding goes on, to begin where it ended."""
        own, found = set(candidate.parameters), []
        for form in (c for c in self._further if c.at == candidate.at and set(candidate.fixed) <= set(c.fixed)):
            new = set(form.parameters) - own
            if own < set(form.parameters) and _names(new) <= form.further:
                starts = dict.fromkeys(
                    tuple(value if q in new else now.fit.values[q] for q, value in zip(form.parameters, start, strict=True))
                    for start in form.starts
                )
                found.append(replace(form, starts=tuple(starts)))
        return found

    def laws(self, now: FittedModel) -> list[Candidate]:
        """Return the laws by which what a model has may act, and that it does not have."""
        return [one for one in self.candidates if one.is_law and one.at not in now.named and now.meets_prerequisite(one)]

    def forms_of(self, candidate: Candidate) -> list[Candidate]:
        """Return the other forms of a candidate's effect, also those in which its law goes on."""
        return [one for one in (*self.candidates, *self._further) if one.at == candidate.at and one.key != candidate.key]

    def fullest(self, candidate: Candidate) -> Candidate:
        """Return the form of a candidate's effect with the most parameters."""
        return max((c for c in self.candidates if c.at == candidate.at), key=lambda form: len(form.parameters), default=candidate)


def is_declared_alike(one: Candidate, other: Candidate) -> bool:
    """Return whether one of two effects is declared to be mistaken for the other."""
    return any(a.effect in declared() and b.effect in declared()[a.effect].mistaken_for for a, b in ((one, other), (other, one)))


def _names(parameters: Collection[FreeParameter]) -> set[str]:
    return {q.parameter for q in parameters}
