"""What a cylinder is made for, and sentences where it goes beyond."""

import numpy as np
import pytest
from benches import bench

from exo_sim import rig as rigs
from exo_sim.rig.limits import Reached, passed, rating, reached_in


def test_a_standard_bore_has_its_standards_rating_and_a_given_one_goes_before(tmp_path):
    rig = bench(tmp_path)  # 32 mm bore, 12 mm rod
    assert rating(rig, rig.cylinders["piston"]) == (pytest.approx(1101325.0), "ISO 15552 rates")
    given = rigs.parse(rig.text.replace('bore = "32 mm"', 'bore = "32 mm"\nrating = "8 bar"'), rig.path)
    assert rating(given, given.cylinders["piston"]) == (8e5, "its rig gives")
    other = rigs.parse(rig.text.replace('"32 mm"', '"33 mm"'), rig.path)
    assert rating(other, other.cylinders["piston"]) is None


def test_each_limit_that_is_passed_is_one_sentence(tmp_path):
    rig = bench(tmp_path)
    words = passed(rig, {"piston": Reached(12e5, 240.0, -2e-3)})
    assert [word in says for word, says in zip(("12.0 bar", "2.0 mm beyond", "-33 C"), words, strict=True)] == [True] * 3
    assert passed(rig, {"piston": Reached(11e5, 280.0, 5e-3)}) == ()
    assert passed(rig, {"piston": Reached()}) == ()


def test_columns_say_what_was_reached(tmp_path):
    rig = bench(tmp_path)
    columns = {"piston.pressure_1": np.array([1e5, np.nan, 9e5]), "piston.pressure_2": np.full(3, np.nan),
               "piston.length": np.array([0.01, 0.1, 0.1995])}  # fmt: skip
    found = reached_in(rig, columns)["piston"]
    assert (found.pressure, found.temperature) == (9e5, None) and found.stroke_left == pytest.approx(5e-4)
