"""A budget ends, and says whether that left anything out."""

from __future__ import annotations

from exo_sim.diagnosis.estimation.budget import Budget, never


def test_without_end_nothing_is_left_out() -> None:
    budget = Budget()
    assert not budget.is_spent() and not budget.stopped


def test_a_spent_budget_remembers_that_it_was_asked() -> None:
    budget = Budget(-1.0)
    assert not budget.stopped
    assert budget.is_spent() and budget.stopped


def test_a_stage_may_go_on_until_its_share_is_over() -> None:
    budget = Budget(3600.0)
    budget.allow_until(0.0)
    assert budget.is_spent()
    budget.allow_until(1.0)
    assert not budget.is_spent() and budget.stopped


def test_shares_of_no_end_have_none() -> None:
    budget = Budget()
    budget.allow_until(0.5)
    assert not budget.is_spent() and not never()
