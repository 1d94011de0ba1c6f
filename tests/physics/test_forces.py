"""What the joints feel: gas less friction at the rod, and the pressure that a sensor reads where it sits."""

from __future__ import annotations

import numpy as np
import pytest
from physics.sliding import contact
from physics.stepping import bench, hold

from exo_sim.physics import state
from exo_sim.physics.forces import advance_joints, joint_forces


def test_the_rod_feels_the_gas_less_what_resists_the_piston() -> None:
    gas = bench(p_1=6e5, p_2=3e5)
    c = gas.cylinders[0]
    push = 6e5 * c["area_1"] - 3e5 * c["area_2"] - 101325.0 * (c["area_1"] - c["area_2"])
    at = np.array([0.05])
    assert gas.forces(at, np.zeros(1))[0] == pytest.approx(push)
    gas.cylinders["viscous_friction"]["coefficient"] = 40.0
    assert gas.forces(at, np.array([0.2]))[0] == pytest.approx(push - 8.0)


def test_a_sensor_at_the_valve_reads_the_hose() -> None:
    gas = bench(p_1=3e5, p_2=3e5)
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = 5e-7, 5e-6
    gas.fill(np.array([0.05]), 3e5, 3e5)
    hold(gas, 1.0, 0.01, 0.05)
    at = np.array([0.05])
    inside = gas.pressures(at)[0, 0]
    assert gas.sensed_pressures(at)[0, 0] == inside
    gas.cylinders["line_restriction"]["sensor"] = 1.0
    hose = 0.4 * gas.integrated[0, state.HOSE_ENERGY_1] / 5e-6
    assert gas.sensed_pressures(at)[0, 0] == pytest.approx(hose) and hose > inside + 1e4


def test_joints_feel_their_own_friction_and_their_bristles_move() -> None:
    joints = np.concatenate([contact(viscous_friction={"coefficient": 5.0}), contact(coulomb_friction={"force": 9.0})])
    joints["effective_mass"], joints["step"] = 4.0, 1e-3
    bristles, force = np.zeros(2), np.zeros(2)
    joint_forces(joints, bristles, np.zeros(2), np.array([0.3, 0.0]), force)
    assert force == pytest.approx([-1.5, 0.0])
    for step in range(200):
        advance_joints(joints, bristles, np.full(2, 3e-4 * step), np.full(2, 3e-4 * (step + 1)), 1e-3)
    joint_forces(joints, bristles, np.zeros(2), np.full(2, 0.3), force)
    assert bristles[0] == 0.0 and force == pytest.approx([-1.5, -9.0])
