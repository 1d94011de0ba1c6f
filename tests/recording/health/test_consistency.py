"""A velocity is held against the rate of its position: sign, unit and likeness."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.recording import Recording
from exo_sim.recording.health import consistency
from exo_sim.recording.noise import floor

TIME = np.arange(4000.0) * 1e-3
POSITION, VELOCITY = 0.05 * np.sin(3.0 * TIME), 0.15 * np.cos(3.0 * TIME)


def says(velocity: np.ndarray, spoilt: tuple[str, ...] = ()) -> list[str]:
    columns = {"slide.position": POSITION, "slide.velocity": velocity}
    noise = {key: floor(values, TIME) for key, values in columns.items()}
    return [one.says for one in consistency.check(Recording("r", TIME, columns, {}), noise, spoilt)]


def test_the_derivative_itself_is_nothing() -> None:
    assert says(VELOCITY) == [] and says(1.05 * VELOCITY) == []


@pytest.mark.parametrize(("factor", "shown"), [(-1.0, "-1 times"), (1e3, "1e+03 times"), (57.3, "57.3 times")])
def test_another_sign_or_unit_is_said_with_its_factor(factor: float, shown: str) -> None:
    (sentence,) = says(factor * VELOCITY)
    assert shown in sentence


def test_something_else_does_not_follow_and_a_spoilt_column_is_not_asked() -> None:
    other = 0.15 * np.cos(7.3 * TIME + 1.0)
    assert "does not follow" in says(other)[0] and says(other, ("slide.velocity",)) == []
