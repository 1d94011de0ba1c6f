from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture
def bench(repository: Path) -> Path:
    return repository / "assets" / "bench.toml"
