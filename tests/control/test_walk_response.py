"""Steady answers of a periodic linear machine, against those of one that has walked for long."""

import numpy as np

from exo_sim.control.walk_response import WalkResponse

RANDOM = np.random.default_rng(5)
STEPS, PHASES = 40, 8


def test_a_steady_change_answers_as_many_cycles_of_it_do() -> None:
    it = WalkResponse(
        np.arange(STEPS) / STEPS, 0.95 * np.eye(18) + 0.02 * RANDOM.normal(size=(STEPS, 18, 18)),
        RANDOM.normal(size=(STEPS, 18, 2)), RANDOM.normal(size=(STEPS, 3, 18)),
    )  # fmt: skip
    turned = 2.0 * np.pi * it.phase
    basis = np.stack([np.ones(STEPS), np.cos(turned), np.sin(turned)], axis=1)
    numbers = RANDOM.normal(size=6)
    state, seen = np.zeros(18), np.zeros((PHASES, 3))
    for cycle in range(60):
        for k in range(STEPS):
            if cycle == 59:
                seen[int(it.phase[k] * PHASES + 0.5) % PHASES] += it.straps[k] @ state / (STEPS / PHASES)
            state = it.by_state[k] @ state + it.by_torque[k] @ [basis[k] @ numbers[:3], basis[k] @ numbers[3:]]
    np.testing.assert_allclose(it.steady(basis, PHASES) @ numbers, seen, rtol=1e-6, atol=1e-6 * np.abs(seen).max())
