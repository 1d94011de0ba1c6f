"""Commands behind dead times: the integral that arrives, steps divided where a valve is thrown over, closing later than opening."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from physics.stepping import hold

from exo_sim.diagnosis.subsystems.gas.arrived_commands import late_commands
from exo_sim.physics import state
from exo_sim.physics.effects import valve_lag
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world


@given(seed=st.integers(0, 10**6), delay=st.floats(0.0, 0.02))
@settings(max_examples=40)
def test_late_commands_keep_their_integral_and_divide_steps_where_the_valve_is_thrown_over(seed: int, delay: float) -> None:
    rng = np.random.default_rng(seed)
    time: NDArray[np.float64] = np.cumsum(0.005 + 5e-4 * rng.uniform(-1.0, 1.0, 300)).astype(np.float64)
    one: NDArray[np.float64] = np.repeat(rng.choice([-1.0, -0.3, 0.0, 1.0], 30), 10).astype(np.float64)
    late = late_commands(time, np.stack([one, -one], axis=1), delay)
    step = np.append(np.diff(time), time[-1] - time[-2])
    passed = late.command[:, :2] * late.first[:, None] + late.command[:, 2:] * (step - late.first)[:, None]
    # what has arrived until a sample is what was given until `delay` before it
    fine = np.arange(time[0] - 0.03, time[-1], 1e-5)
    held = one[np.clip(np.searchsorted(time, fine - delay, side="right") - 1, 0, None)]
    arrived = np.interp(time, fine, np.cumsum(held) * 1e-5)
    np.testing.assert_allclose(np.cumsum(passed[:-1, 0]), arrived[1:] - arrived[0], atol=6e-4)
    np.testing.assert_array_equal(late.command[:, 1], -late.command[:, 0])
    assert set(np.round(np.unique(late.command[late.first > 0.0]), 9)) <= {-1.0, -0.3, 0.0, 0.3, 1.0}


def test_mirrored_commands_arrive_as_each_would_alone() -> None:
    rng = np.random.default_rng(3)
    time: NDArray[np.float64] = np.cumsum(rng.uniform(0.9e-3, 1.1e-3, 500))
    one: NDArray[np.float64] = np.repeat(rng.choice([-1.0, 0.1, 1.0], 50), 10)
    other = -one
    other[-1] *= 1.0 + 1e-15  # no longer mirrored
    mirrored, apart = (late_commands(time, np.stack([one, second], axis=1), 3.3e-3) for second in (-one, other))
    np.testing.assert_array_equal(mirrored.command[:-5], apart.command[:-5])
    np.testing.assert_array_equal(mirrored.first, apart.first)


def test_a_command_that_hardly_changes_is_not_divided() -> None:
    time: NDArray[np.float64] = np.arange(50, dtype=np.float64) * 1e-3
    smooth: NDArray[np.float64] = 0.05 * np.arange(50, dtype=np.float64)
    late = late_commands(time, np.stack([smooth, -smooth], axis=1), 0.3e-3)
    assert not late.first.any()
    np.testing.assert_allclose(late.command[1:, 0], smooth[1:] - 0.05 * 0.3, rtol=1e-12)


@given(seed=st.integers(0, 10**6), delay=st.floats(0.0, 0.01), closing=st.floats(-0.01, 0.01))
@settings(max_examples=40)
def test_pulses_open_after_the_delay_and_close_the_closing_delay_later(seed: int, delay: float, closing: float) -> None:
    rng = np.random.default_rng(seed)
    time: NDArray[np.float64] = np.cumsum(0.002 + 2e-4 * rng.uniform(-1.0, 1.0, 600)).astype(np.float64)
    one: NDArray[np.float64] = np.zeros(600)
    for first in range(20, 560, 40):
        one[first : first + 15] = rng.choice([-1.0, 1.0])
    late = late_commands(time, np.stack([one, -one], axis=1), delay, closing)
    step = np.append(np.diff(time), time[-1] - time[-2])
    passed = late.command[:, 0] * late.first + late.command[:, 2] * (step - late.first)
    at = np.flatnonzero(np.diff(one)) + 1
    opened, closed = time[at[::2]] + delay, time[at[1::2]] + delay + closing
    expected = np.sum([
        one[i] * np.clip(np.minimum(time + step, end) - np.maximum(time, begin), 0.0, None)
        for i, begin, end in zip(at[::2], opened, closed, strict=True)
    ], axis=0)  # fmt: skip
    np.testing.assert_allclose(passed[:-1], expected[:-1], atol=1e-12)


@pytest.mark.parametrize(("closing", "open_for"), [(4e-3, 14e-3), (-2e-3, 8e-3), (0.0, 10e-3)])
def test_a_simulated_valve_opens_and_closes_as_a_predicted_one(closing: float, open_for: float) -> None:
    cylinder = paper_cylinder(0.032, 0.012, 0.1, 5e-6, 1e-5, 1e-5)
    cylinder["valve_lag"]["delay"], cylinder["valve_lag"]["closing_delay"] = 3e-3, closing
    gas = Pneumatics(paper_world(), cylinder, dt=1e-3)
    gas.fill(np.zeros(1), 2e5, 2e5)
    spools = []
    for n in range(60):
        hold(gas, 0.7 if 10 <= n < 20 else 0.0, 1e-3)
        spools.append(float(gas.memory[0, state.SPOOL]))
    assert np.flatnonzero(spools)[0] == 13
    assert sum(spools) * 1e-3 == pytest.approx(0.7 * open_for)
    time: NDArray[np.float64] = np.arange(60, dtype=np.float64) * 1e-3
    command: NDArray[np.float64] = np.where((time > 9.5e-3) & (time < 19.5e-3), 0.7, 0.0)
    late = late_commands(time, np.stack([command, -command], axis=1), 3e-3, closing)
    np.testing.assert_allclose(late.command[:, 2], spools, atol=1e-12)


CENTRED, RETURN = (valve_lag.REVERSALS.index(one) for one in ("spring_centred", "spring_return"))


@pytest.mark.parametrize("closing", [4e-3, -4e-3])
def test_a_valve_with_two_positions_closes_from_plus_to_minus(closing: float) -> None:
    time: NDArray[np.float64] = np.arange(60, dtype=np.float64) * 1e-3
    command: NDArray[np.float64] = np.where((time > 9.5e-3) & (time < 29.5e-3), 1.0, -1.0)
    late = late_commands(time, np.stack([command, -command], axis=1), 5e-3, closing, RETURN).command[:, 2:]
    np.testing.assert_allclose(late[:, 0], np.where((time > 14.5e-3) & (time < 34.5e-3 + closing), 1.0, -1.0))
    of_second = np.where((time > 14.5e-3 + closing) & (time < 34.5e-3), -1.0, 1.0)  # a valve of its own closes when it goes to minus
    np.testing.assert_allclose(late[time > 5e-3, 1], of_second[time > 5e-3])


@pytest.mark.parametrize("closing", [4e-3, -4e-3])
def test_a_valve_with_three_positions_leaves_either_side_when_its_solenoid_lets_go(closing: float) -> None:
    """Until then it stays there, and where that is before the other pulls the spool is at its centre meanwhile."""
    time: NDArray[np.float64] = np.arange(60, dtype=np.float64) * 1e-3
    command: NDArray[np.float64] = np.where((time > 9.5e-3) & (time < 29.5e-3), 1.0, -1.0)
    late = late_commands(time, np.stack([command, -command], axis=1), 5e-3, closing, CENTRED).command[:, 2:]
    for prompt, side, during in ((14.5e-3, 1.0, (time > 5e-3) & (time < 24.5e-3)), (34.5e-3, -1.0, time > 24.5e-3)):
        gone, come = sorted((prompt, prompt + closing))
        between = 0.0 if closing < 0.0 else -side
        np.testing.assert_allclose(late[during, 0], np.where(time < gone, -side, np.where(time < come, between, side))[during], atol=1e-12)
    np.testing.assert_array_equal(late[:, 1], -late[:, 0])


@pytest.mark.parametrize("independent", [False, True], ids=["one spool", "two valves"])
@pytest.mark.parametrize("reversal", [CENTRED, RETURN], ids=["spring-centred", "spring return"])
@pytest.mark.parametrize(("delay", "closing"), [(5.3e-3, 4e-3), (5e-3, 0.4e-3), (5.3e-3, -4e-3), (2.6e-3, -0.4e-3), (0.7e-3, 2.2e-3)])
def test_a_simulated_valve_changes_sides_as_a_predicted_one(delay: float, closing: float, reversal: int, independent: bool) -> None:
    """Also where neither arrives at the beginning of a step."""
    dt, n = 1e-3, 80
    cylinder = paper_cylinder(0.032, 0.012, 0.1, 5e-6, 1e-5, 1e-5)
    lag = cylinder["valve_lag"]
    lag["delay"], lag["closing_delay"], lag["reversal"] = delay, closing, reversal
    cylinder["independent"] = float(independent)
    gas = Pneumatics(paper_world(), cylinder, dt=dt)
    gas.fill(np.zeros(1), 2e5, 2e5)
    time: NDArray[np.float64] = np.arange(n, dtype=np.float64) * dt
    command: NDArray[np.float64] = 0.7 * np.sign(np.sin(time / 8e-3 + 0.05)) * (time % 0.03 < 0.022)
    command[0] = 0.0
    simulated = np.zeros((n, 2))
    for i in range(n):
        gas.advance(np.zeros(1), np.zeros(1), np.array([command[i], -command[i]])[: gas.commands])
        simulated[i] = gas.memory[0, [state.SPOOL, state.SPOOL_2]]
    late = late_commands(time, np.stack([command, -command], axis=1), delay, closing, reversal)
    mean = (late.command[:, :2] * late.first[:, None] + late.command[:, 2:] * (dt - late.first)[:, None]) / dt
    valves = slice(0, 2 if independent else 1)
    np.testing.assert_allclose(mean[:-1, valves], simulated[:-1, valves], atol=1e-9)
