"""Modules are loaded without collections, and left alone after that."""

from __future__ import annotations

import gc

import pytest

from exo_sim.cli import loading


def test_nothing_is_collected_in_the_block_and_what_was_made_is_left_alone() -> None:
    before = gc.get_freeze_count()
    try:
        with loading.uncollected():
            assert not gc.isenabled()
            made: list[list[int]] = [[] for _ in range(1000)]
        assert gc.isenabled()
        assert gc.get_freeze_count() >= before + len(made)
    finally:
        gc.unfreeze()


def test_collections_go_on_after_a_module_that_cannot_be_loaded() -> None:
    with pytest.raises(ModuleNotFoundError), loading.uncollected():
        import exo_sim.no_such_module  # type: ignore[import-not-found]  # noqa: F401
    assert gc.isenabled()
    gc.unfreeze()


def test_who_goes_without_collections_still_does() -> None:
    gc.disable()
    try:
        with loading.uncollected():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
        gc.unfreeze()
