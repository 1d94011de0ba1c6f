"""The compiler of the truth of whole machines."""

from __future__ import annotations

from pathlib import Path

from exo_sim.trials.compiled import compiler

kernel = compiler(Path(__file__).parent, divides_by_zero=True)
