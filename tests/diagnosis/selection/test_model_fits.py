"""Fits of a linear subsystem: the values, errors and log-likelihoods of ordinary least squares, each set fitted once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.waves import AT, BASE, OTHER, SHAPES, Array, Waves, candidate, parameter

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.selection.model_fits import ModelFits

COLUMNS = np.stack([SHAPES["slow"], SHAPES["quicker"]], axis=1)


def expected(model: Waves) -> np.ndarray:
    """Return what ordinary least squares makes of the two waves, shape (2,)."""
    return np.linalg.lstsq(COLUMNS, -model.residual_of(model.nominal), rcond=None)[0]


@pytest.mark.parametrize("cheap", [False, True])
def test_values_are_those_of_least_squares(cheap: bool) -> None:
    model = Waves(slow=3.0, quicker=-2.0)
    fits = ModelFits(model, (), cheap=cheap)
    found = fits.refined(fits.fit((BASE, OTHER)))
    values = [found.fit.values[q] for one in (BASE, OTHER) for q in one.parameters]
    np.testing.assert_allclose(values, expected(model), rtol=1e-6)


def test_standard_errors_are_about_those_of_least_squares_where_the_noise_is_white() -> None:
    """Blocks of time stand for the correlation, so they may differ, but not by half."""
    fits = ModelFits(Waves(slow=3.0, quicker=-2.0), ())
    found = fits.refined(fits.fit((BASE, OTHER)))
    white = np.sqrt(np.diag(np.linalg.inv(COLUMNS.T @ COLUMNS)))
    errors = [fits.standard_errors(found)[q] for one in (BASE, OTHER) for q in one.parameters]
    np.testing.assert_allclose(errors, white, rtol=0.5)


def test_a_fit_that_goes_on_is_no_worse_keeps_what_is_free_and_takes_the_place_of_the_one_before() -> None:
    model = Waves(slow=3.0, quicker=-2.0)
    fits = ModelFits(model, ())
    first = fits.look((BASE, OTHER), fits.fit(()))
    on = fits.carried_on(first)
    assert on.fit.sse <= first.fit.sse and on.fit.parameters == first.fit.parameters
    assert fits.fit((OTHER, BASE)) is on
    np.testing.assert_allclose([on.fit.values[q] for one in (BASE, OTHER) for q in one.parameters], expected(model), rtol=1e-2)


def test_a_set_is_fitted_once_in_whatever_order() -> None:
    fits = ModelFits(Waves(slow=3.0), ())
    bare = fits.fit(())
    assert fits.fit((BASE, OTHER), bare) is fits.fit((OTHER, BASE), bare)
    both = fits.fit_all([((BASE, OTHER), bare), ((OTHER,), bare), ((OTHER, BASE), bare)])
    assert both[0] is both[2] and both[1].candidates == (OTHER,)


def test_a_worse_fit_does_not_replace_a_better_one() -> None:
    fits = ModelFits(Waves(slow=3.0), ())
    best = fits.refined(fits.fit((BASE,)))
    assert fits.fit((BASE,), fits.fit(()), again=True).fit.sse <= best.fit.sse * (1.0 + 1e-9)


def test_nuisance_parameters_come_along_and_priors_hold_them() -> None:
    zero = parameter("zero", "level", prior=(0.0, 0.01))
    free = parameter("zero", "level", prior=(0.0, 100.0))
    model = Waves(level=1.0)
    held, loose = (ModelFits(model, (q,)).fit(()).fit.values[q] for q in (zero, free))
    assert abs(held) < 0.1 and loose == pytest.approx(1.0, abs=0.2)


def test_a_deficit_is_a_difference_of_log_likelihoods() -> None:
    fits = ModelFits(Waves(slow=3.0), ())
    bare, full = fits.fit(()), fits.fit((BASE,))
    assert fits.deficit(bare, full) == -fits.deficit(full, bare) > 0.0
    assert fits.deficit(full, full) == 0.0
    assert fits.effective_sample_size((bare, full)) == AT.size / fits.correlation_time(full.fit.residual)


def test_only_what_comes_near_is_fitted_to_the_end() -> None:
    """Beside waves of both kinds a set without the larger is far off, and one without the smaller near."""
    fits = ModelFits(Waves(slow=8.0, quicker=0.05), ())
    both = fits.refined(fits.fit((BASE, OTHER), fits.fit(())))
    far, near = fits.fit_rivals([((OTHER,), both), ((BASE,), both)], both)
    assert far.fit.sse > 10.0 * both.fit.sse and near.fit.sse < 1.5 * both.fit.sse
    assert fits.fit((OTHER,), both) is not far and fits.fit((BASE,), both) is near


@pytest.mark.parametrize("cheap", [False, True])
def test_what_is_least_missed_is_left_out_first(cheap: bool) -> None:
    fits = ModelFits(Waves(slow=3.0, quicker=0.4), (), cheap=cheap)
    both = fits.refined(fits.fit((BASE, OTHER), fits.fit(())))
    (first, bare), (second, _) = fits.each_without((BASE, OTHER), both)
    assert (first, second) == (OTHER, BASE)
    assert bare is fits.fit((BASE,), both)


def test_a_look_does_not_replace_a_better_fit() -> None:
    fits = ModelFits(Waves(slow=3.0, quicker=-2.0), ())
    both = fits.refined(fits.fit((BASE, OTHER), fits.fit(())))
    assert fits.look((BASE, OTHER), fits.fit(()), again=True) is both


def test_a_number_that_a_candidate_held_is_not_forgotten_where_the_candidate_is_left_out() -> None:
    """What stands for the same number in every fit begins where the candidate had it, inside its own bounds."""
    (size,) = BASE.parameters
    healthy = parameter("healthy", "slow", (0.0, 1.0))
    healthy = replace(healthy, parameter=size.parameter, high=2.0)
    fits = ModelFits(Waves(slow=3.0), (healthy,))
    found = fits.fit((BASE,))
    assert fits._starts((), found)[1][0][healthy] == 2.0
    assert fits._starts((BASE,), found)[1][0][healthy] == found.fit.values[healthy]


def test_a_candidate_whose_number_was_refitted_already_begins_where_that_ended() -> None:
    """At its own start it would leave far more than there was, and where one does not feel it, never come back."""
    (size,) = BASE.parameters
    healthy = replace(parameter("healthy", "slow", (0.0, 1.0)), parameter=size.parameter, high=2.0)
    fits = ModelFits(Waves(slow=3.0), (healthy,))
    bare = fits.fit(())
    begun = [option[size] for option in fits._starts((BASE,), bare)[1]]
    assert begun == [1.0, pytest.approx(bare.fit.values[healthy])] and begun[1] > 1.9
    assert len(fits._starts((OTHER,), bare)[1]) == 1


def test_a_new_effect_begins_with_less_where_its_usual_size_leads_astray() -> None:
    model = Waves(slow=3.0, quick=2.0)
    fits = ModelFits(model, ())
    now = fits.refined(fits.fit((BASE,), fits.fit(())))
    large = replace(candidate("other", "quick"), starts=((9.9,),))
    (size,) = large.parameters
    begin = {**now.fit.values, size: 9.9}
    residual = fits._residual_of((BASE, large))
    assert np.sum(residual(begin) ** 2) > 10.0 * now.fit.sse
    less = fits._not_astray(residual, begin, (BASE, large), now)
    assert less[size] == pytest.approx(9.9 / 4.0) and np.sum(residual(less) ** 2) < 10.0 * now.fit.sse
    assert fits._not_astray(residual, begin, (BASE, replace(large, proportional=False)), now) == begin


class _Shy(Waves):
    """Waves of which a size below 1 counts as 1: nothing says there that it should be larger."""

    def residual_of(self, plant: PlantParameters) -> Array:
        felt = {name: max(value, 1.0) for name, value in plant.sensors.items()}
        return super().residual_of(PlantParameters(plant.world, plant.cylinder, felt))


def test_a_law_that_is_not_felt_where_it_begins_best_is_fitted_from_where_it_is() -> None:
    model = _Shy(slow=4.0)
    law = replace(candidate("hose", "slow"), starts=((0.5,), (9.0,), (9.5,)), is_law=True)  # 0.5 leaves least, and leads nowhere
    assert np.sum(model.residual({law.parameters[0]: 0.5}) ** 2) < np.sum(model.residual({law.parameters[0]: 9.0}) ** 2)
    fits = ModelFits(model, ())
    found = fits.fit((law,), fits.fit(()))
    assert found.fit.values[law.parameters[0]] == pytest.approx(4.0, abs=0.2)


def test_what_is_held_stays_where_it_is_and_the_rest_makes_up_for_it() -> None:
    model = Waves(shapes={**SHAPES, "again": SHAPES["slow"]}, slow=3.0)
    held, free = parameter("base", "slow"), parameter("base", "again")
    fits = ModelFits(model, (held, free))
    found = fits.fit_holding(fits.fit(()), {held: 1.0})
    assert found.fit.values[held] == 1.0 and found.fit.parameters == (free,)
    assert found.fit.values[free] == pytest.approx(2.0, abs=0.2)
