"""A linear family says what a machine is: target = background + terms + noise, solved exactly where there is no noise."""

from __future__ import annotations

import numpy as np
from diagnosis import waves

from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation, Term


def test_sizes_of_terms_beside_a_background_are_what_the_target_was_made_of() -> None:
    slow, level = waves.SHAPES["slow"][:, None], waves.SHAPES["level"][:, None]
    candidate = waves.BASE
    term = Term(candidate, slow, np.array([4.0]), (False,), lambda sizes, before: {candidate.parameters[0]: float(sizes[0])}, "base")
    offset = waves.parameter("offset", "level", prior=(0.0, 1.0))
    linear = Linearisation(None, {}, 3.0 * slow[:, 0] - 0.5 * level[:, 0], level, (term,))
    family = LinearFamily((offset,), (linear,))
    design = np.hstack([family.linearisations[0].background, term.columns])
    background, size = np.linalg.lstsq(design, family.linearisations[0].target, rcond=None)[0]
    assert np.allclose((background, size), (-0.5, 3.0))
    assert term.parameters(np.array([size]), {}) == {candidate.parameters[0]: size}
    assert family.linearisations[0].candidate is None and term.alternatives == 1
