"""Computed torque of a machine of known inertia, and rods that share a force."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from exo_sim.control.tracking import Tracking, TrackingGains

MJCF = """
<mujoco><option gravity="0 0 -9.81"/>
  <worldbody><body><joint name="slide" type="slide" axis="0 0 1"/><geom type="sphere" size="0.1" mass="2"/></body></worldbody>
  <actuator><motor joint="slide"/><motor joint="slide" gear="-1"/></actuator>
</mujoco>
"""
GAINS = TrackingGains(pace=10.0, integral=0.2)


def machine(limits: list[list[float]] | None = None) -> tuple[Tracking, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(MJCF)
    data = mujoco.MjData(model)
    mujoco.mj_step1(model, data)
    limits = limits or [[-300.0, 300.0], [-100.0, 100.0]]
    return Tracking(model, np.array([0]), np.array([0, 1]), np.array(limits), GAINS), data


def wanted(position: float, velocity: float = 0.0, acceleration: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return np.array([position]), np.array([velocity]), np.array([acceleration])


def test_at_rest_in_place_it_carries_the_weight() -> None:
    tracking, data = machine()
    assert tracking.joint_force(data, *wanted(0.0), 0.01) == pytest.approx([2.0 * 9.81])


def test_errors_are_closed_by_a_critically_damped_law() -> None:
    """Of 2 kg: pace^2 and integral pace^3 dt of 1 mm, 2 pace of 0.1 m/s, and the acceleration itself."""
    tracking, data = machine()
    force = tracking.joint_force(data, *wanted(1e-3, 0.1, 3.0), 0.01)
    assert force == pytest.approx([2.0 * (9.81 + 3.0 + 20.0 * 0.1 + 100.0 * 1e-3 + 200.0 * 1e-3 * 0.01)])


def test_an_outside_force_is_taken_off() -> None:
    tracking, data = machine()
    data.qfrc_applied[0] = 5.0
    assert tracking.joint_force(data, *wanted(0.0), 0.01) == pytest.approx([2.0 * 9.81 - 5.0])


def test_rods_share_a_force_by_the_square_of_what_they_hold_and_make_it() -> None:
    tracking, data = machine()
    rods = tracking.rod_forces(data, np.array([100.0]))
    np.testing.assert_allclose(rods, [90.0, -10.0])
    np.testing.assert_allclose(tracking.made(data, rods), [100.0])


def test_a_rod_that_cannot_hold_its_share_stops_the_integral() -> None:
    tracking, data = machine([[-5.0, 5.0], [-5.0, 5.0]])
    np.testing.assert_allclose(tracking.rod_forces(data, np.array([100.0])), [5.0, -5.0])
    first = tracking.joint_force(data, *wanted(1e-3), 1.0)
    assert tracking.joint_force(data, *wanted(1e-3), 1.0) == pytest.approx(first)
    tracking.reset()
    summed = tracking.joint_force(data, *wanted(1e-3), 1.0)
    assert summed == pytest.approx(first + 2.0 * 200.0 * 1e-3)
