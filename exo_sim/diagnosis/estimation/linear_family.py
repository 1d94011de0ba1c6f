"""A family of effects that are linear in their sizes: what a subsystem's residual owes to each, all of them side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Term:
    """One way in which an effect may be present.

    Attributes:
        candidate: The effect.
        columns: What it adds to the target for each of its sizes, shape (n, k).
        spread: Standard deviation of each size where the effect is present, shape (k,).
        one_sided: Which of its sizes cannot be negative, k of them.
        parameters: Its parameters, from its sizes, shape (k,), and from the parameters of the terms before it.
        group: Terms of one group exclude each other: laws of one effect, or effects of which one is the richer form.
        alternatives: How many terms share the prior probability of the effect.
        log_prior: Logarithm of how much less probable its shape is than the one that is expected.
    """

    candidate: Candidate
    columns: Array
    spread: Array
    one_sided: tuple[bool, ...]
    parameters: Callable[[Array, Mapping[FreeParameter, float]], dict[FreeParameter, float]]
    group: str
    alternatives: int = 1
    log_prior: float = 0.0


@dataclass(frozen=True)
class Linearisation:
    """The family, linearised at one value of a parameter on which every term of it depends, and none linearly.

        target = background + terms that are present + discrepancy + noise

    Attributes:
        candidate: The effect whose parameter that is; None where the family is linearised about the nominal machine.
        values: Its parameters.
        target: What the nominal machine lacks, in units of the noise of a row, shape (n,).
        background: What the nuisance parameters add to the target, for each standard deviation of their prior, shape (n, p).
        terms: What may be present.
        alternatives: How many linearisations share the prior probability of the effect.
    """

    candidate: Candidate | None
    values: Mapping[FreeParameter, float]
    target: Array
    background: Array
    terms: tuple[Term, ...]
    alternatives: int = 1


@dataclass(frozen=True)
class LinearFamily:
    """A subsystem as a linear model.

    Attributes:
        nuisances: Nuisance parameters, p of them, each with a prior.
        linearisations: That about the nominal machine first.
        whole: Size of all that the effects stand for, also of what the nominal machine has of it, in units of the noise of a row.
        least: What is missing without a name is a finding from this root mean square on, in the same units: healthy machines have less.
        fitted_forms: Richer forms of effects that have no terms: they are weighed against the plainer one as fitted, once that is found.
        constant: The greatest constant force that zeros of sensors within their data sheets make where friction acts [N or N m].
    """

    nuisances: tuple[FreeParameter, ...]
    linearisations: tuple[Linearisation, ...]
    whole: float = 0.0
    least: float = 0.0
    fitted_forms: tuple[Candidate, ...] = ()
    constant: float = 0.0

    @property
    def by_effect(self) -> dict[str, Candidate]:
        """Its candidates by effect, of several forms the last; a family is of one place."""
        return {term.candidate.effect: term.candidate for term in self.linearisations[0].terms}
