"""Large arrays that were freed are no memory of the process any more, whatever small ones lie between them."""

from __future__ import annotations

import subprocess
import sys

import pytest

_HELD = """
import sys
import numpy as np
from exo_sim.diagnosis.pipeline.freed_memory import return_freed, return_large_arrays

def resident():
    with open("/proc/self/statm") as pages:
        return int(pages.read().split()[1]) * 4096 / 1e6

if sys.argv[1] == "returned":
    return_large_arrays()
np.ones(3_000_000)
before, small, large = resident(), [], []
for _ in range(8):
    large.append(np.ones(2_500_000))
    small.append(np.ones(5_000))
    if sys.argv[1] == "trimmed":  # small enough for the heap
        large += [np.ones(10_000) for _ in range(250)]
        small += [np.ones(5_000)]
large.clear()
if sys.argv[1] == "trimmed":
    return_freed()
print(resident() - before)
"""


def held(how: str) -> float:
    """Return how many of 160 MB are held after they were freed."""
    return float(subprocess.run([sys.executable, "-c", _HELD, how], check=True, capture_output=True, text=True).stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_small_arrays_go_back_when_asked() -> None:
    assert held("trimmed") < 10.0


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_large_arrays_go_back_to_the_system() -> None:
    assert held("returned") < 10.0
