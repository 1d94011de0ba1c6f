"""Whether a recording is of the machine at all."""

from __future__ import annotations

from pathlib import Path

import benches

import exo_sim as exo
from exo_sim.conventions.belonging import of_another_machine
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording


def test_a_recording_of_another_machine_is_told_from_one_of_this(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    recording = benches.led(rig, 2.0)
    assert of_another_machine(recording, rig, load(rig)) == ""
    gas = {key: values for key, values in recording.columns.items() if key.startswith("supply.")}
    other = Recording("other", recording.time, {"pistom.pressure_1": recording["piston.pressure_1"]}, {"pistom.pressure_1": "Pa"})
    says = of_another_machine(other, rig, load(rig))
    assert says.startswith("no column belongs to ") and says.endswith('"pistom" is none of its parts; did you mean "piston"?')
    shared = Recording("shared", recording.time, gas, {key: recording.units[key] for key in gas})
    assert '"any part" is none of its parts' in of_another_machine(shared, rig, load(rig))


def test_inspect_says_so_and_not_that_nothing_looks_wrong(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    found = exo.inspect(benches.led(rig, 2.0), exo.Rig.included())
    assert found.findings[0].kind == "another machine" and "no column belongs to " in found.findings[0].says
    assert "Nothing looks wrong" not in str(found) and "no column belongs to " in str(found)
