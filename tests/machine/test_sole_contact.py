"""Soles that are soft at first: how deep they lie under a load, flat and tilted."""

import numpy as np
import pytest

from exo_sim.machine import sole_contact
from exo_sim.machine.sole_contact import FIRM, PAD, STIFFNESS, depth_under, force_at, heel_depth


def test_a_sole_stiffens_up_to_its_stiffness():
    depth = np.linspace(1e-4, 2.0 * FIRM, 200)
    stiffness = force_at(depth) / depth
    assert (np.diff(stiffness[depth < FIRM]) > 0.0).all()
    np.testing.assert_allclose(stiffness[depth >= FIRM], STIFFNESS)
    assert stiffness[0] < 0.08 * STIFFNESS
    assert force_at(np.array(-1e-3)) == 0.0  # the ground does not pull


@pytest.mark.parametrize("share", [0.3, 0.5, 0.8])
def test_depth_is_the_inverse_of_force(monkeypatch, share):
    """What share of the stiffness each end of the heel's pad has is nothing to ball and tip."""
    monkeypatch.setattr(sole_contact, "PAD_SHARE", share)
    load = np.linspace(0.0, 1500.0, 50)
    np.testing.assert_allclose(force_at(depth_under(load)), load, atol=1e-2)


@pytest.mark.parametrize("share", [0.3, 0.5, 0.8])
def test_both_ends_of_a_heel_pad_carry_the_load_together(monkeypatch, share):
    monkeypatch.setattr(sole_contact, "PAD_SHARE", share)
    load, tilt, scale = np.full(5, 400.0), np.radians([-12.0, -3.0, 0.0, 3.0, 25.0]), 1.1
    rear = heel_depth(load, tilt, scale)
    front = rear - PAD * scale * np.sin(tilt)
    np.testing.assert_allclose(share * (force_at(rear) + force_at(front)), load, atol=1e-2)
    assert rear[4] > rear[2] and front[4] < 0.0  # on its edge a heel sinks deeper
