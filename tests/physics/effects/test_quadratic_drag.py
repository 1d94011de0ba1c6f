"""Known limits of quadratic drag: closed forms and published numbers."""

from __future__ import annotations

import pytest
from physics.sliding import contact, nothing, slide


def test_speed_fades_hyperbolically() -> None:
    for v in (0.5, -0.5):
        found = slide(contact(quadratic_drag={"coefficient": 100.0}), 10.0, v, nothing, 0.4, 1e-5)
        assert found[-1, 1] == pytest.approx(v / (1 + 100.0 * 0.5 * 0.4 / 10.0), rel=5e-5)
