"""The wearer's mass: shares that sum to one, inertia by hand, and a body whose energy grows by what is done to it."""

import numpy as np
import pytest

from exo_sim.machine import anthropometry
from exo_sim.machine.person import Person, poses_along


@pytest.mark.parametrize(("height", "mass"), [(1.60, 55.0), (1.90, 95.0)])
def test_segments_weigh_what_the_person_weighs(height, mass):
    body = anthropometry.body(Person(height, mass))
    assert body.mass.sum() == pytest.approx(mass)
    assert body.centre[0, 1] == pytest.approx(0.626 * 0.288 * height)  # Winter 2009, table 4.1 and figure 4.1
    assert body.inertia[0] == pytest.approx(0.678 * mass * (0.496 * 0.288 * height) ** 2)


def test_a_body_at_rest_weighs_its_weight():
    person = Person(1.75, 70.0)
    q = np.array([[0.0, 0.9, -0.1, 0.3, -0.4, 0.1, -0.1, -0.2, 0.0]])
    poses = poses_along(q, np.zeros((1, 9)), person)
    wrench = anthropometry.body_wrench(poses, anthropometry.accelerations(np.zeros((1, 9)), poses, person), person)
    assert wrench[0, :, 0] == pytest.approx(0.0)
    assert wrench[0, :, 1].sum() == pytest.approx(-70.0 * anthropometry.GRAVITY)


def test_energy_grows_by_the_power_of_what_the_motion_takes():
    """d'Alembert's loads do, on the segments, the opposite of what the energy gains: derivative by central difference."""
    person, dt = Person(), 1e-5
    rng = np.random.default_rng(3)
    q, v, a = rng.normal(0.0, [0.3, 0.1, *[0.4] * 7], 9), rng.normal(0.0, 1.0, 9), rng.normal(0.0, 5.0, 9)

    def energy(t):
        return anthropometry.energy(poses_along((q + v * t + a * t * t / 2)[None], (v + a * t)[None], person), person)[0]

    poses = poses_along(q[None], v[None], person)
    wrench = anthropometry.body_wrench(poses, anthropometry.accelerations(a[None], poses, person), person)
    power = (wrench * poses[:, :, 3:6]).sum()
    weight = -(energy(dt) - energy(-dt)) / (2 * dt)
    assert power == pytest.approx(weight, rel=1e-6)
