"""Fourier series: what is put in comes out, and derivatives are derivatives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.gait import fourier

numbers = st.lists(st.floats(-3, 3), min_size=3, max_size=3)


@given(st.floats(-5, 5), numbers, numbers)
def test_a_fit_gives_the_series_back(mean, cosine, sine):
    series = fourier.Series(mean, np.array(cosine), np.array(sine))
    found = fourier.fit(series(np.arange(16) / 16), 3)
    assert found.mean == pytest.approx(mean, abs=1e-12)
    np.testing.assert_allclose(found.cosine, cosine, atol=1e-12)
    np.testing.assert_allclose(found.sine, sine, atol=1e-12)


@given(numbers, numbers, st.floats(0, 1))
def test_derivatives_match_differences(cosine, sine, phase):
    series = fourier.Series(0.3, np.array(cosine), np.array(sine))
    h = 1e-5
    for order in (1, 2):
        difference = (series(phase + h, order - 1) - series(phase - h, order - 1)) / (2 * h)
        assert series(phase, order) == pytest.approx(float(difference), abs=2e-3)


def test_the_integral_has_the_series_as_its_slope():
    series = fourier.Series(0.0, np.array([0.4, -1.0]), np.array([2.0, 0.1]))
    phase = np.linspace(0, 1, 7)
    np.testing.assert_allclose(series.integral()(phase, 1), series(phase), atol=1e-12)


def test_too_few_samples_are_refused():
    with pytest.raises(ValueError, match="samples"):
        fourier.fit(np.zeros(6), 4)
    with pytest.raises(ValueError, match="derivative"):
        fourier.Series(0.0, np.zeros(1), np.zeros(1))(0.0, 3)
