"""The evidence of fitted models: of two names for two waves the true one, and none for noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.selection.evidence import price_of_parameter
from exo_sim.diagnosis.selection.fitted_evidence import FittedEvidence
from exo_sim.diagnosis.selection.linear_evidence import Spreads
from exo_sim.diagnosis.selection.model_fits import ModelFits

NOISE = Spreads(1.0, ())


def evidence(model: waves.Waves) -> FittedEvidence:
    return FittedEvidence(ModelFits(model, ()), joined([], model.size), 1.0)


def test_a_name_that_is_there_is_probable_and_one_that_is_not_is_not() -> None:
    one = evidence(waves.Waves(slow=2.0))
    final = one.fits.fit((waves.BASE, waves.OTHER))
    assert one.probability_in(waves.BASE, final, NOISE) > 0.999
    assert one.probability_in(waves.OTHER, final, NOISE) < 0.2
    true, false = (one.log_evidence(one.fits.fit((name,)), NOISE) for name in (waves.BASE, waves.OTHER))
    assert true > false + 100.0


@pytest.mark.parametrize(("size", "decisive"), [(2.0, True), (0.0, False)])
def test_names_are_decisive_where_they_are_there(size: float, decisive: bool) -> None:
    one = evidence(waves.Waves(slow=size))
    assert one.is_decisive(one.fits.fit((waves.BASE,)), one.fits.fit(()), NOISE) is decisive


def test_the_noise_of_what_is_left_is_estimated() -> None:
    one = evidence(waves.Waves(slow=6.0))
    loud, plain = (one.spreads_of(one.fits.fit(names), NOISE).noise for names in ((), (waves.BASE,)))
    assert loud > 2.0 * plain and plain == pytest.approx(1.0, abs=0.25)


def test_a_shape_of_which_the_data_say_nothing_costs_nothing_and_another_number_does(monkeypatch: pytest.MonkeyPatch) -> None:
    one = evidence(waves.Waves(shapes={**waves.SHAPES, "silent": np.zeros(waves.AT.size)}, slow=3.0))
    silent = replace(waves.parameter("base", "silent"), prior=(1.0, 0.75))
    (size,), plain = waves.BASE.parameters, one.log_evidence(one.fits.fit((waves.BASE,)), NOISE)
    more = replace(waves.BASE, form="slow+silent", parameters=(size, silent), starts=((1.0, 1.0),))
    fitted, price = one.fits.fit((more,)), price_of_parameter(one.fits.model.size)
    assert one.log_evidence(fitted, NOISE) == pytest.approx(plain - price, abs=0.1) and price > 1.0
    monkeypatch.setattr(FreeParameter, "is_shape", property(lambda q: q == silent))
    assert one.log_evidence(fitted, NOISE) == pytest.approx(plain, abs=0.1)
