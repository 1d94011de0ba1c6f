"""Known limits of asymmetric friction: closed forms and published numbers."""

from __future__ import annotations

import pytest
from physics.sliding import constant, contact, nothing, slide


def test_each_direction_meets_its_own_friction() -> None:
    joint = contact(asymmetric_friction={"forward": 20.0, "backward": 8.0})
    for v, force in ((0.3, 20.0), (-0.3, 8.0)):
        found = slide(joint.copy(), 10.0, v, nothing, 1.0, 1e-4)
        assert abs(found[-1, 0]) == pytest.approx(10.0 * 0.3**2 / (2 * force), rel=2e-3)
    for load, moves in ((15.0, False), (25.0, True), (-7.0, False), (-9.0, True)):
        found = slide(joint.copy(), 10.0, 0.0, constant(load), 1.0, 1e-3)
        assert bool(abs(found[-1, 0]) > 1e-3) is moves
