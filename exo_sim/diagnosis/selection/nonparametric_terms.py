"""What is missing beside the names and depends on one variable in no particular form: in a subset, or in its discrepancy."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.linear_family import Term
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy import acceptance, verdicts
from exo_sim.diagnosis.selection.fitted_model import Unnamed
from exo_sim.diagnosis.selection.linear_evidence import Posterior
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing, Weighed


def nonparametric_terms(terms: Sequence[Term]) -> list[tuple[int, Term]]:
    """Return the terms that are no effect of the list, each with where its sizes begin among those of all."""
    found, first = [], 0
    for term in terms:
        if term.candidate.kind is Kind.UNKNOWN:
            found.append((first, term))
        first += term.columns.shape[1]
    return found


def unnamed(
    weighing: SubsetWeighing, basis: DiscrepancyBasis, best: Weighed, finalists: Sequence[Weighed], posterior: Posterior
) -> tuple[Unnamed, ...]:
    """Return what is missing without a name and is both probable and large, the largest first.

    The same functions are a discrepancy while they are no larger than a healthy machine's. The two hardly differ in evidence where
    something is just large enough, so what a subset leaves to its discrepancy counts as well where hardly any healthy machine has as much.

    Args:
        weighing: Of the subsets.
        basis: Of the discrepancy.
        best: The most probable subset.
        finalists: Those that were weighed to the end.
        posterior: Of the best.
    """
    family = weighing.family
    size = max(float(np.std(family.linearisations[best.point].target)), family.whole, 1e-300)
    acting: dict[str, tuple[float, NDArray[np.float64]]] = {}
    for first, term in nonparametric_terms(weighing.terms(best)):
        probability = weighing.probability_of_any(finalists, {term.candidate.at})
        acting[term.candidate.form] = probability, term.columns @ posterior.sizes[first : first + term.columns.shape[1]]
    asked = {term.candidate.form for _, term in nonparametric_terms(family.linearisations[0].terms)}
    for kind, name in enumerate(basis.names):
        ratio = best.spreads.amplitudes[kind] / float(basis.healthy[kind])
        if name in asked and name not in acting and ratio > acceptance.CERTAIN:
            own = basis.kinds == kind
            acting[name] = math.erf(ratio / math.sqrt(2.0)), basis.columns[:, own] @ posterior.discrepancy[own]
    found = []
    for name, (probability, force) in acting.items():
        acts = float(np.sqrt(np.mean(force**2)))
        if probability >= verdicts.PROBABLE and acts >= max(verdicts.LEAST_UNNAMED * size, family.least):
            found.append(Unnamed(name, probability, acts / size))
    return tuple(sorted(found, key=lambda one: -one.share))
