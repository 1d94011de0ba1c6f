"""What all tests share: recordings of real machines, the same random examples on every machine, no display."""

from __future__ import annotations

import os
import sys
from collections import Counter
from pathlib import Path

import hypothesis
import pytest

REPOSITORY = Path(__file__).resolve().parents[1]
ON_CI = os.environ.get("CI", "").lower() in ("true", "1")

if sys.platform == "linux" and "DISPLAY" not in os.environ:
    os.environ.setdefault("MUJOCO_GL", "egl")  # read when mujoco is imported
os.environ.setdefault("MPLBACKEND", "agg")
os.environ["EXO_SIM_KEEP"] = "0"  # what an earlier start rehearsed hides what a test changes; tests/test_kept_solutions.py has it on

# Compiling a kernel makes the first example slow, hence no deadline.
hypothesis.settings.register_profile("local", deadline=None, print_blob=True)
hypothesis.settings.register_profile("ci", parent=hypothesis.settings.get_profile("local"), derandomize=True)
hypothesis.settings.load_profile("ci" if ON_CI else "local")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Give files with many slow tests to workers first: one of them begun last leaves the other workers without work."""
    if hasattr(config, "workerinput"):
        slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
        items.sort(key=lambda item: -slow[item.path])


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of recordings of real machines, beside the checkout."""
    folder = REPOSITORY.parent / "shared" / "data"
    if not folder.is_dir():
        reason = "no recordings in ../shared/data beside the checkout"
        if ON_CI:
            pytest.fail(reason)
        pytest.skip(reason)
    return folder


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the checkout, where assets/, docs/ and scripts/ are."""
    return REPOSITORY
