"""What the final model still misses: of what there was to explain, and in the unit of the signal."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.final_residual import FinalResidual, final_residual
from exo_sim.diagnosis.selection.search import Search


def of(model: waves.Waves, *candidates: waves.Candidate) -> FinalResidual:
    search = Search(model, (), candidates, cheap=True)
    return final_residual(decide("piston", model, search.fits, search.run()))


def test_where_all_is_explained_only_noise_is_left() -> None:
    left = of(waves.Waves(slow=6.0), waves.BASE)
    assert left.share < 0.01 and left.unit == "Pa"
    assert left.error == pytest.approx(1.0, rel=0.1) and left.times_noise == left.error / left.noise


def test_of_two_waves_the_one_without_a_name_is_left() -> None:
    """Sizes 6 and 4: squares of 36 and 16 over two, beside noise of 1."""
    left = of(waves.Waves(slow=6.0, quick=4.0), waves.BASE)
    assert left.share == pytest.approx(16.0 / 52.0, rel=0.1)
    assert left.times_noise == pytest.approx(np.sqrt(1.0 + 8.0), rel=0.1)


def test_without_noise_nothing_is_counted_in_units_of_it() -> None:
    assert FinalResidual(0.2, 3.0, 0.0, "Pa").times_noise == 0.0
