"""The published class: its own numbers by its own rule, and what this machine's linkage makes of the same moments."""

import numpy as np
import pytest

from exo_sim.sizing import published_machine


def test_the_class_by_its_own_rule():
    """60 N m at 50 mm are 1200 N; 10 bar net ask for 39.1 mm of bore, and 40 mm is the next size."""
    force = published_machine.KNEE / published_machine.ARM
    assert force == pytest.approx(1200.0)
    assert 1e3 * np.sqrt(4.0 / np.pi * force / published_machine.NET) == pytest.approx(39.1, abs=0.05)
    assert published_machine.rule_of_the_class(force) == published_machine.BORE


def test_this_machine_from_the_same_moments_comes_out_within_reason(exo, space):
    found = published_machine.published_class(exo, space)
    assert found.peak["knee"] == pytest.approx(published_machine.KNEE, rel=0.15)
    assert found.force["knee"] == pytest.approx(published_machine.KNEE / published_machine.ARM, rel=0.25)
    assert found.by_rule["knee"] == published_machine.BORE
    assert found.bores["knee"] <= found.by_rule["knee"]  # the valve's real back-pressure is less than half of the supply
    assert found.own_peak["hip"] > found.peak["hip"]
    assert found.margin >= 0.0
