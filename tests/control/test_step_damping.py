"""How far a step may go by what the last ones kept of their promise."""

from dataclasses import replace

import numpy as np

from exo_sim.control.step_damping import StepDamping


def test_a_kept_promise_lengthens_the_next_step_and_half_kept_ones_leave_it() -> None:
    it = replace(StepDamping(), promised=60.0)
    assert it.bettered(100.0, 65.0).value < it.value
    assert it.bettered(100.0, 95.0).value == it.value
    assert it.bettered(np.inf, 100.0).value == it.value  # the first rehearsal is nobody's promise


def test_a_failure_shortens_it_and_it_stays_within_bounds() -> None:
    it = StepDamping()
    assert it.missed().value > it.value
    longest = shortest = it
    for _ in range(100):
        shortest = shortest.missed()
        longest = replace(longest, promised=10.0).bettered(100.0, 10.0)
    assert shortest.missed().value == shortest.value > 10.0 * it.value
    assert longest.bettered(100.0, 10.0).value == longest.value < 0.1 * it.value


def test_a_damped_step_goes_first_where_torques_do_much() -> None:
    size, effect = np.ones(2), np.array([1.0, 100.0])
    metric = replace(StepDamping(), value=10.0).metric(size, effect)
    share = effect / (effect + metric)
    assert share[1] > 3.0 * share[0]
    np.testing.assert_allclose(replace(StepDamping(), value=20.0).metric(size, effect), 2.0 * metric)
