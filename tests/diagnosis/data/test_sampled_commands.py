"""Commands of a slow recording may be samples of a quicker loop; held, their means say what the valve was told."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.sampled_commands import as_told, may_be_sampled, remark
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

N = 100
RIG = cast(Rig, SimpleNamespace(cylinders={"piston": SimpleNamespace(commands=("valve_command",))}))


def run(period: float, sampled: bool = False, moves: bool = True) -> CylinderRun:
    command = np.sin(np.arange(N)) * moves
    return run_of(np.full(N, 3e5), time=np.arange(N) * period, command=command, commanded=True, sampled=sampled)


def test_a_recording_at_500_hz_and_faster_holds_all_that_a_valve_was_told() -> None:
    assert [may_be_sampled(run(period)) for period in (1e-3, 2e-3, 2.5e-3, 0.02)] == [False, False, True, True]
    assert not may_be_sampled(run(0.02, moves=False))


def test_samples_are_held_as_their_means() -> None:
    one = run(0.02, sampled=True)
    table = Recording("recording", one.time, {"piston.valve_command": one.command, "piston.pressure_1": np.ones(N)}, {})
    told = as_told(table, RIG, [one])
    np.testing.assert_allclose(told["piston.valve_command"][:-1], 0.5 * (one.command[1:] + one.command[:-1]))
    np.testing.assert_array_equal(told["piston.pressure_1"], 1.0)
    assert as_told(table, RIG, [run(0.02)])["piston.valve_command"] is one.command
    assert '"piston.valve_command"' in remark(one, ["valve_command"]) and "20 ms" in remark(one, ["valve_command"])
