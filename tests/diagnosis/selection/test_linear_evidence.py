"""The evidence for a subset against the Gaussian density that it is, written out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from diagnosis import waves
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.linear_family import Linearisation, Term
from exo_sim.diagnosis.selection.linear_evidence import LEAST_AMPLITUDE, LinearEvidence, Spreads

ROWS = 25


def term(columns: np.ndarray, spread: tuple[float, ...], one_sided: bool = False) -> Term:
    candidate = waves.candidate("law", "slow")
    return Term(candidate, columns, np.array(spread), (one_sided,) * columns.shape[1], lambda sizes, before: {}, "law")


def problem(seed: int, one_sided: bool = False) -> tuple[LinearEvidence, np.ndarray, list[np.ndarray]]:
    rng = np.random.default_rng(seed)
    target, background = rng.standard_normal(ROWS) * 2.0, rng.standard_normal((ROWS, 2))
    terms = [rng.standard_normal((ROWS, 1)), rng.standard_normal((ROWS, 2))]
    basis = joined([("place", rng.standard_normal((ROWS, 3)), 0.7)], ROWS)
    linear = Linearisation(None, {}, target, background, (term(terms[0], (1.5,), one_sided), term(terms[1], (0.4, 2.0))))
    return LinearEvidence(linear, basis), target, [background, basis.columns, *terms]


@given(st.integers(0, 200), st.sampled_from([(), (0,), (1,), (0, 1)]), st.floats(0.4, 3.0), st.floats(0.05, 2.0))
@settings(max_examples=60)
def test_it_is_the_density_of_the_target_up_to_what_all_subsets_share(
    seed: int, subset: tuple[int, ...], noise: float, amplitude: float
) -> None:
    evidence, target, (background, basis, first, second) = problem(seed)
    covariance = noise**2 * np.eye(ROWS) + background @ background.T + amplitude**2 * basis @ basis.T
    if 0 in subset:
        covariance += 1.5**2 * first @ first.T
    if 1 in subset:
        covariance += second @ np.diag([0.4**2, 2.0**2]) @ second.T
    density = multivariate_normal(np.zeros(ROWS), covariance).logpdf(target) + 0.5 * ROWS * math.log(2.0 * math.pi)
    density -= 0.5 * (amplitude / 0.7) ** 2  # of the amplitude itself
    found = evidence.posterior(subset, Spreads(noise, (amplitude,)), 1.0)
    assert found.log_evidence == pytest.approx(density, rel=1e-9, abs=1e-7)


def test_sizes_and_errors_are_those_of_the_posterior() -> None:
    evidence, target, (background, basis, first, _) = problem(3)
    other = 0.6**2 * np.eye(ROWS) + background @ background.T + 0.2**2 * basis @ basis.T
    precision = float((first.T @ np.linalg.solve(other, first))[0, 0]) + 1.5**-2
    found = evidence.posterior((0,), Spreads(0.6, (0.2,)), 1.0, whole=True)
    assert found.sizes[0] == pytest.approx(float(first[:, 0] @ np.linalg.solve(other, target)) / precision)
    assert found.errors[0] == pytest.approx(precision**-0.5)
    everything = found.sizes[0] * first[:, 0] + background @ found.background + basis @ found.discrepancy
    np.testing.assert_allclose(found.left, target - everything, atol=1e-12)


def test_correlated_rows_count_as_fewer() -> None:
    evidence, _, (_, _, first, _) = problem(3)
    loud = Linearisation(None, {}, 40.0 * first[:, 0], np.zeros((ROWS, 0)), (term(first, (50.0,)),))
    evidence = LinearEvidence(loud, joined([], ROWS))

    def gain(correlation: float) -> float:
        with_it, without = (evidence.posterior(one, Spreads(1.0, ()), correlation).log_evidence for one in ((0,), ()))
        return with_it - without

    assert gain(5.0) == pytest.approx(gain(1.0) / 5.0, rel=0.02)


def test_a_size_of_one_sign_has_no_evidence_on_the_other_side() -> None:
    for sign in (1.0, -1.0):
        columns = np.ones((ROWS, 1))
        terms = (term(columns, (3.0,), True), term(columns, (3.0,)))
        linear = Linearisation(None, {}, sign * np.full(ROWS, 3.0), np.zeros((ROWS, 0)), terms)
        evidence = LinearEvidence(linear, joined([], ROWS))
        signed, free = (evidence.posterior(one, Spreads(1.0, ()), 1.0).log_evidence for one in ((0,), (1,)))
        assert signed == (pytest.approx(free + math.log(2.0)) if sign > 0.0 else -math.inf)


def test_spreads_are_estimated_where_the_evidence_is_greatest() -> None:
    rng = np.random.default_rng(5)
    rows = 3000
    smooth = rng.standard_normal((rows, 40))
    target = 2.5 * rng.standard_normal(rows) + smooth @ (0.8 * rng.standard_normal(40))
    evidence = LinearEvidence(Linearisation(None, {}, target, np.zeros((rows, 0)), ()), joined([("place", smooth, 2.0)], rows))
    best, spreads = evidence.estimated((), Spreads(1.0, (0.1,)), 1.0, sweeps=6)
    assert spreads.noise == pytest.approx(2.5, rel=0.15) and spreads.amplitudes[0] == pytest.approx(0.8, rel=0.35)
    assert best >= evidence.posterior((), Spreads(1.0, (0.1,)), 1.0).log_evidence
    _, quiet = LinearEvidence(
        Linearisation(None, {}, rng.standard_normal(rows), np.zeros((rows, 0)), ()), joined([("place", smooth, 2.0)], rows)
    ).estimated((), Spreads(1.0, (1.0,)), 1.0, sweeps=6)
    assert LEAST_AMPLITUDE * 2.0 <= quiet.amplitudes[0] < 0.1


def test_nothing_at_all_has_the_density_of_noise_and_no_complaint_of_lapack(capfd: pytest.CaptureFixture[str]) -> None:
    target = np.random.default_rng(5).standard_normal(ROWS)
    evidence = LinearEvidence(Linearisation(None, {}, target, np.zeros((ROWS, 0)), ()), joined([], ROWS))
    found = evidence.posterior((), Spreads(0.8, ()), 1.0)
    density = multivariate_normal(np.zeros(ROWS), 0.64 * np.eye(ROWS)).logpdf(target) + 0.5 * ROWS * math.log(2.0 * math.pi)
    assert found.log_evidence == pytest.approx(density, rel=1e-9)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("one_sided", [False, True])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_evidence_alone_is_that_of_the_posterior(seed: int, one_sided: bool) -> None:
    evidence, _, _ = problem(seed, one_sided)
    for noise, amplitude, correlation in ((0.6, 0.2, 1.0), (1.3, 0.05, 4.0)):
        spreads = Spreads(noise, (amplitude,))
        for subset in ((), (0,), (1,), (0, 1)):
            whole = evidence.posterior(subset, spreads, correlation).log_evidence
            assert evidence.log_evidence(subset, spreads, correlation) == pytest.approx(whole, rel=1e-11)


def test_the_evidence_alone_of_nothing_is_that_of_noise() -> None:
    linear = Linearisation(None, {}, np.random.default_rng(4).standard_normal(50), np.zeros((50, 0)), ())
    evidence = LinearEvidence(linear, joined((), 50))
    spreads = Spreads(0.8, ())
    assert evidence.log_evidence((), spreads, 2.0) == pytest.approx(evidence.posterior((), spreads, 2.0).log_evidence)
