"""Of two clocks under which the pressures follow equally well the one with the valve of the rig is taken."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from exo_sim.conventions.gas_balance import CylinderColumns, Explained
from exo_sim.conventions.signs import CLOCKS, _read
from exo_sim.rig import Cylinder

TIME = np.arange(50, dtype=np.float64)
CYLINDER = cast(Cylinder, SimpleNamespace(valve_area=1e-6, single_acting=False, stroke=0.1))


@pytest.mark.parametrize("true", ["minutes", "seconds, not milliseconds"])
def test_a_clock_is_told_by_the_size_of_the_valve(true: str) -> None:
    ends = np.full(50, 1e5)
    recorded = CylinderColumns(
        TIME, np.zeros(1, dtype=np.intp), np.stack([ends, ends]), 0.0 * ends, np.sin(TIME), ends, ends, (1.0, 1.0)
    )  # fmt: skip

    def ask(columns: CylinderColumns) -> Explained:
        factor = float(columns.time[1] / TIME[1])
        fits = np.array_equal(columns.command, recorded.command) and 10.0 < factor < 2000.0
        opened = CLOCKS[true] / factor
        return Explained(0.9, 100.0, 99, 0.5, 0.3, opened) if fits else Explained(0.1, 1000.0, 99, 0.5, 0.3)

    way, _ = _read(recorded, CYLINDER, ask)
    assert way is not None and way.clock == true and not (way.turned or way.swapped or way.reversed)
