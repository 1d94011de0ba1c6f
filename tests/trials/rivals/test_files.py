"""What a rival reads of recordings and rigs."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from exo_sim.trials.rivals.files import read, si


@pytest.mark.parametrize("text, expected", [("25 mm", 0.025), ("7 bar", 7e5), ("3 cm^3", 3e-6), (0.5, 0.5), ("293.15 K", 293.15)])
def test_a_quantity_is_read_in_si(text, expected):
    assert si(text) == pytest.approx(expected)


def test_columns_of_both_kinds_of_table_lose_their_units(tmp_path):
    (tmp_path / "a.csv").write_text("time [s],rod.pressure_1 [Pa]\n0,1e5\n0.001,2e5\n")
    pq.write_table(pa.table({"time [s]": [0.0, 0.001], "rod.pressure_1 [Pa]": [1e5, 2e5]}), tmp_path / "a.parquet")
    for name in ("a.csv", "a.parquet"):
        found = read(tmp_path / name)
        assert list(found) == ["time", "rod.pressure_1"]
        np.testing.assert_array_equal(found["rod.pressure_1"], [1e5, 2e5])
