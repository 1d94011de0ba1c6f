"""Known limits of return spring: closed forms and published numbers."""

from __future__ import annotations

import math

import pytest
from physics.sliding import contact, nothing, slide


def test_swings_about_its_rest() -> None:
    joint = contact(return_spring={"stiffness": 400.0, "rest": 0.02})
    half = math.pi * math.sqrt(4.0 / 400.0)
    found = slide(joint, 4.0, 0.0, nothing, half, half / 20000, q=0.05)
    assert found[-1, 0] == pytest.approx(-0.01, abs=1e-6)
