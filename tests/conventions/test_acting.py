"""A chamber that the rig leaves open holds no pressure."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.conventions import settle
from exo_sim.conventions.acting import as_recorded
from exo_sim.conventions.machine import Machine
from exo_sim.errors import RecordingError
from exo_sim.machine.rig_model import load
from exo_sim.rig import Rig


@pytest.fixture
def single(tmp_path: Path) -> Rig:
    rig = benches.bench(tmp_path)
    text = rig.path.read_text().replace('stroke = "200 mm"', 'stroke = "200 mm"\nacting = "single"')
    rig.path.write_text(text)
    return rigs.read(rig.path)


def test_a_single_acting_cylinder_with_a_driven_chamber_2_is_refused_in_one_line(single: Rig) -> None:
    table = benches.led(single, 4.0)
    says = r'"piston.pressure_2": .* bar, .*rig.toml has acting = "single".*set acting = "double"'
    with pytest.raises(RecordingError, match=says) as refused:
        settle(table, single, load(single))
    assert "\n" not in str(refused.value)


def test_what_a_vent_leaves_passes(single: Rig) -> None:
    table, machine = benches.recorded(single, 4.0), Machine.of(single, load(single))
    vented = 101325.0 + 3e4 * np.abs(np.sin(table.time)) + 4e5 * (table.time % 1.0 < 0.1)
    for values in (vented, np.full(len(table.time), np.nan)):
        one = replace(table, columns={**table.columns, "piston.pressure_2": values})
        assert as_recorded(one, machine) == (one, [])
    one = replace(table, columns={key: values for key, values in table.columns.items() if key != "piston.pressure_2"})
    assert as_recorded(one, machine) == (one, [])


def test_a_double_acting_cylinder_is_not_asked(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    table = benches.recorded(rig, 3.0)
    assert as_recorded(table, Machine.of(rig, load(rig))) == (table, [])
