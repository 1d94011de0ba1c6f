"""Several candidates weighed together: effects that hide each other are found, and what is not there is not proposed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves
from scipy.linalg import cho_factor, cho_solve

from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.priors import SIGN_SLACK, WRONG_SIGN
from exo_sim.diagnosis.selection.directions import Direction
from exo_sim.diagnosis.selection.joint_proposal import _Weighing, joint_proposals
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.score_test import scores

#: Two shapes that are large and nearly opposite: their sum is small, and neither alone explains it.
CARRIER = 10.0 * np.sin(waves.AT / 17.0)
HIDDEN = {**waves.SHAPES, "one": CARRIER + np.sin(waves.AT / 4.0), "other": -CARRIER + np.sin(waves.AT / 4.0)}
ONE, OTHER, FALSE = waves.candidate("one", "one"), waves.candidate("other_one", "other"), waves.candidate("false", "quicker")
#: Whether directions have one sign only.
SIDED = (True, True, False, False)


def names(proposals: list) -> set[str]:
    return {candidate.effect for candidate in proposals[0].candidates} if proposals else set()


def test_effects_that_hide_each_other_are_proposed_together() -> None:
    model = waves.Waves(shapes=HIDDEN, one=3.0, other=3.0)
    fits = ModelFits(model, ())
    now = fits.fit(())
    alone = max(promised for promised, _ in scores(model, now, (ONE, OTHER)))
    proposals = joint_proposals(model, now, (ONE, OTHER, FALSE))
    assert names(proposals) == {"one", "other_one"}
    together = fits.fit((ONE, OTHER), now)
    assert now.fit.sse - together.fit.sse > 5.0 * alone
    for parameter, value in proposals[0].values.items():
        assert value == pytest.approx(together.fit.values[parameter], rel=0.3)


def test_noise_proposes_nothing() -> None:
    model = waves.Waves()
    assert joint_proposals(model, ModelFits(model, ()).fit(()), (waves.BASE, waves.OTHER)) == []


def test_what_is_in_the_model_and_faults_of_sensors_are_left_out() -> None:
    model = waves.Waves(slow=5.0, quick=5.0)
    now = ModelFits(model, ()).fit((waves.BASE,))
    sensor = replace(waves.candidate("sensor", "quick"), kind=Kind.SENSOR)
    assert joint_proposals(model, now, (waves.BASE, sensor)) == []


def test_nothing_is_proposed_without_what_it_comes_on_top_of() -> None:
    model = waves.Waves(quick=5.0)
    fits = ModelFits(model, ())
    assert joint_proposals(model, fits.fit(()), (waves.ON_TOP,)) == []
    assert names(joint_proposals(model, fits.fit((waves.BASE,)), (waves.BASE, waves.ON_TOP))) == {"on_top"}


def test_a_law_bends_in_all_of_its_parameters_at_once() -> None:
    model = waves.Waves(slow=2.0, quick=-2.0)
    law = waves.candidate("law", "slow", "quick")
    law = replace(law, parameters=tuple(replace(q, prior=(0.0, 1.0)) for q in law.parameters), is_law=True)
    (proposal,) = joint_proposals(model, ModelFits(model, ()).fit(()), (law,))
    assert [round(value) for value in proposal.values.values()] == [2, -2]


@pytest.mark.parametrize("size", [1.0, 3e4])
def test_subsets_that_are_weighed_at_once_have_the_evidence_of_each_alone(size: float) -> None:
    """By one Cholesky factor a subset, of signatures that are nearly alike and of any size."""
    model = waves.Waves(shapes=HIDDEN, one=3.0, other=3.0)
    now = ModelFits(model, ()).fit(())
    rng = np.random.default_rng(3)
    shared = rng.standard_normal(model.size)
    columns = [size * (shared[:, None] + 0.05 * rng.standard_normal((model.size, count))) for count in (1, 2, 1, 1)]
    asked = [Direction(waves.candidate(f"effect_{i}", "one"), {}, columns[i], SIDED[i]) for i in range(4)]
    weighing = _Weighing(model, now, asked)
    subsets = [tuple(int(i) for i in range(4) if number >> i & 1) for number in range(16)]
    for subset, found in zip(subsets, weighing.evidence(subsets), strict=True):
        at = [column for i in subset for column in weighing._of[i]]
        value = sum(asked[i].candidate.prior_log_odds for i in subset)
        if at:
            factor = cho_factor(weighing._precision[np.ix_(at, at)], lower=True)
            amplitudes = cho_solve(factor, weighing._pull[at])
            value += 0.5 * float(weighing._pull[at] @ amplitudes) - float(np.log(np.diag(factor[0])).sum())
            spreads = np.sqrt(np.diag(cho_solve(factor, np.eye(len(at)))))
            np.testing.assert_allclose(weighing.amplitudes(subset), amplitudes, rtol=1e-6)
            first = 0
            for i in subset:
                count = columns[i].shape[1]
                out = -amplitudes[first : first + count] / spreads[first : first + count]
                value -= float(np.sum((0.5 * out**2 + WRONG_SIGN / count)[out > SIGN_SLACK])) if SIDED[i] else 0.0
                first += count
        assert found == pytest.approx(value, rel=1e-9, abs=1e-6)
