"""Commands of a slow recording may be samples of a quicker loop; held, their means say what the valve was told."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.sampled_commands import early_commands, may_be_sampled, remark
from exo_sim.diagnosis.subsystems.gas.arrived_commands import late_commands
from exo_sim.rig import Rig
from exo_sim.simulation.replay.inputs import held, steps

N = 100
RIG = cast(Rig, SimpleNamespace(cylinders={"piston": SimpleNamespace(commands=("valve_command",))}))


def run(period: float, sampled: bool = False, moves: bool = True) -> CylinderRun:
    command = np.sin(np.arange(N)) * moves
    return run_of(np.full(N, 3e5), time=np.arange(N) * period, command=command, commanded=True, sampled=sampled)


def test_a_recording_at_500_hz_and_faster_holds_all_that_a_valve_was_told() -> None:
    assert [may_be_sampled(run(period)) for period in (1e-3, 2e-3, 2.5e-3, 0.02)] == [False, False, True, True]
    assert not may_be_sampled(run(0.02, moves=False))


def test_samples_are_held_from_half_a_period_before_them() -> None:
    one = run(0.02, sampled=True)
    assert early_commands("recording", RIG, [one]) == {"piston.valve_command": pytest.approx(0.01)}
    assert early_commands("recording", RIG, [run(0.02)]) == early_commands("another", RIG, [one]) == {}
    assert '"piston.valve_command"' in remark(one, ["valve_command"]) and "20 ms" in remark(one, ["valve_command"])


def test_a_fit_and_a_free_run_read_a_switched_valve_alike() -> None:
    """Told -1 and then 1, a valve is at the one for half a period and at the other for the rest, and never at their mean."""
    time, command = np.arange(7.0, dtype=np.float64) * 0.01, np.array([-1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0])
    arrived = late_commands(time, np.stack([command, -command], axis=1), -0.005)
    fitted = np.stack([arrived.command[:, 0], arrived.command[:, 2]], axis=1).ravel()
    stepped = held(steps(time, 0.005), time, command, 0.005)
    np.testing.assert_allclose(stepped[:12], fitted[:12], atol=1e-9)
    assert set(np.round(stepped, 9)) == {-1.0, 1.0}
