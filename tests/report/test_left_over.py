"""What is left far above the noise: a rig is not blamed for what its refitted numbers do."""

from __future__ import annotations

import math
from dataclasses import replace

from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.result import Diagnosis, Verdict
from exo_sim.report import diagnosis_words, left_over

AGREE = Diagnosis(Verdict.CONSISTENT, ("monday",), "bench")


def run(before: float, after: float) -> Diagnosis:
    """Return a diagnosis whose free run of a position with 0.02 mm of noise is off by so much [m], of the rig and of the improved one."""
    return replace(AGREE, free_run={"slide.position": SignalFit("m", before, after, 2e-5)})


def test_a_rig_is_not_blamed_for_its_refitted_numbers() -> None:
    refitted = run(1.9e-4, 1.97e-3)
    assert "agree to within the noise" in diagnosis_words.verdict(refitted)
    said = diagnosis_words.first_step(refitted)
    assert said.startswith("Keep the rig as it is") and "1.97 mm off at slide.position, the rig as it is 190 µm" in said
    assert left_over.of_refit(replace(refitted, by_chance=("slide.position",))) == ""


def test_a_rig_that_strays_is_shown_by_its_own_error() -> None:
    assert left_over.of_rig(run(2e-3, 1e-3)) == "run free, slide.position is 2.00 mm off, 100 times the noise (1.00 mm with improved.toml)"
    assert left_over.of_rig(run(2e-3, 1e-4)) == left_over.of_rig(run(math.nan, 1e-4)) == left_over.of_refit(run(2e-3, 3e-3)) == ""
