"""What functions of the API take: a payload that nobody says is the rig's own, a rig by the name of an included machine."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import exo_sim as exo
from exo_sim.api.arguments import USUAL_PAYLOAD, payload_of, rig_of
from exo_sim.errors import RigError, ScenarioError


def test_the_payload_is_what_is_asked_for_else_the_rigs_else_the_usual_one() -> None:
    plain = exo.Rig.included("exo")
    diagnosed = replace(plain, body_masses={"payload": 40.0, "torso": 11.0})
    assert (payload_of(plain, None), payload_of(diagnosed, None), payload_of(diagnosed, "20 kg")) == (USUAL_PAYLOAD, 40.0, 20.0)
    with pytest.raises(ScenarioError, match="payload = -1"):
        payload_of(plain, -1.0)


def test_an_included_machine_goes_by_its_name_unless_a_file_has_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    bench = exo.Rig.included("bench")
    assert rig_of("bench") == bench and repr(bench).startswith("<exo.Rig bench: 1 cylinder, 0 effects")
    with pytest.raises(RigError, match="bnch: no such rig file"):
        rig_of("bnch")
    bench.changed({"name": "mine"}).save("bench")
    assert rig_of("bench").name == "mine"


def test_a_recording_that_is_handed_in_twice_counts_once(tmp_path: Path) -> None:
    time = np.arange(0.0, 2.0, 0.01)
    rows = "\n".join(f"{at:.2f},{2e5 + 1e3 * np.sin(9.0 * at):.1f}" for at in time)
    for name in ("one.csv", "two.csv"):
        (tmp_path / name).write_text(f"time [s],piston.pressure_1 [Pa]\n{rows}\n")
    found = exo.diagnose([tmp_path / "one.csv", tmp_path / "two.csv"], "bench")
    assert found.result.recordings == ("one",)
    said = f'"{tmp_path / "two.csv"}" is the same recording as "{tmp_path / "one.csv"}" and counts once.'
    assert said in found.result.sensor_remarks


def test_a_rig_shows_its_effects_in_the_units_of_what_they_act_on() -> None:
    bench = exo.Rig.included("bench")
    key = ("effects", "sensor_bias", "slide.external_force", "value")
    shown = bench.changed({("effects", "sensor_bias", "piston.pressure_1", "value"): "2 kPa", key: "3 N*m"})
    assert "sensor_bias at piston.pressure_1  " in str(shown) and "value 2000 Pa" in str(shown)
    assert "value 3 N*m" in str(shown)
