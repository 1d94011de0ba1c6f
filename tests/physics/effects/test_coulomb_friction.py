"""Known limits of coulomb friction: closed forms and published numbers."""

from __future__ import annotations

import pytest
from physics.sliding import contact, nothing, slide


def test_stops_after_the_distance_that_its_work_allows() -> None:
    found = slide(contact(coulomb_friction={"force": 12.0}), 10.0, 0.5, nothing, 1.0, 1e-4)
    assert found[-1, 1] == pytest.approx(0.0, abs=1e-9)
    assert found[-1, 0] == pytest.approx(10.0 * 0.5**2 / (2 * 12.0), rel=5e-4)
