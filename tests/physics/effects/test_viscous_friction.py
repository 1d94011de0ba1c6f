"""Known limits of viscous friction: closed forms and published numbers."""

from __future__ import annotations

import math

import pytest
from physics.sliding import contact, nothing, slide


def test_speed_fades_exponentially() -> None:
    found = slide(contact(viscous_friction={"coefficient": 40.0}), 10.0, 0.5, nothing, 0.5, 1e-5)
    assert found[-1, 1] == pytest.approx(0.5 * math.exp(-2.0), rel=5e-5)
