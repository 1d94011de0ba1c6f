"""A budget ends, and says whether that left anything out."""

from __future__ import annotations

from exo_sim.diagnosis.estimation.budget import Budget


def test_without_end_nothing_is_left_out() -> None:
    budget = Budget()
    assert not budget.is_spent() and not budget.stopped


def test_a_spent_budget_remembers_that_it_was_asked() -> None:
    budget = Budget(-1.0)
    assert not budget.stopped
    assert budget.is_spent() and budget.stopped
