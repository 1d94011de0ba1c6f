"""The whole way on two seconds of a led piston: a healthy one is consistent, a dead volume that is off is corrected."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.findings import Finding, Kind, Rejected
from exo_sim.diagnosis.pipeline.diagnose import _rejected, diagnose
from exo_sim.diagnosis.pipeline.plan import Examination
from exo_sim.diagnosis.result import Diagnosis, Verdict
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.recording import Recording
from exo_sim.recording.reader import Reading
from exo_sim.rig import parse


def noisy(table: Recording) -> Recording:
    chance = np.random.default_rng(7)
    columns = {k: v + chance.normal(0.0, 150.0, len(v)) if "pressure" in k else v for k, v in table.columns.items()}
    return benches.recording(table.time, columns)


def diagnosed(folder: Path, table: Recording) -> Diagnosis:
    return diagnose([Reading(table, ())], folder / "rig.toml", jobs=1)


def test_what_is_said_already_is_not_listed_as_put_aside() -> None:
    offset = Finding("valve_offset", "piston", Kind.MISSING_PHYSICS, "", {}, 9.0, 0.9, ("valve_edges",))
    little = Finding("wall_heat_transfer", "piston", Kind.MISSING_PHYSICS, "", {}, 0.0, 0.0)
    names = ("valve_edges", "wall_heat_transfer", "valve_offset", "valve_lag")
    searched = SimpleNamespace(rejected=tuple(Rejected(name, "piston", "it fits far worse") for name in names))
    found = SimpleNamespace(plan=SimpleNamespace(refuted={}), results=SimpleNamespace(all=(searched,)))
    assert [one.name for one in _rejected(cast(Examination, found), [offset, little])] == ["valve_lag"]


@pytest.mark.slow
def test_a_healthy_piston_is_consistent_and_its_rig_comes_back_as_it_was(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    found = diagnosed(tmp_path, noisy(benches.led(rig, 2.0)))
    assert found.verdict is Verdict.CONSISTENT and found.effects == () and found.exit_status == 0
    assert parse(found.improved, rig.path).effects == ()
    assert 150.0 < found.signals["piston.pressure_1"].before < 450.0  # the noise, and that of where a window starts


@pytest.mark.slow
def test_a_dead_volume_that_is_off_is_a_calibration(tmp_path: Path) -> None:
    table = noisy(benches.led(benches.bench(tmp_path), 2.0))
    text = (tmp_path / "rig.toml").read_text()
    (tmp_path / "rig.toml").write_text(text.replace('"12 cm^3"', '"20 cm^3"'))
    found = diagnosed(tmp_path, table)
    assert found.verdict is Verdict.CALIBRATION
    assert {(one.name, one.kind) for one in found.effects} == {("dead_volume", Kind.CALIBRATION)}
    assert parse(found.improved, tmp_path / "rig.toml").cylinders["piston"].dead_volume_1 == pytest.approx(12e-6, rel=0.05)


def test_rivals_can_still_be_fitted_when_the_next_experiment_is_chosen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = noisy(benches.led(benches.bench(tmp_path), 2.0))
    asked: list[list[int]] = []

    def next_experiment(findings: object, questions: object, results: Sequence[SubsystemResult[SubsystemModel]]) -> None:
        asked.extend(one.fits.threads.predictions(abs, [-1, -2]) for one in results)

    monkeypatch.setattr("exo_sim.diagnosis.pipeline.diagnose.next_experiment", next_experiment)
    diagnose([Reading(table, ())], tmp_path / "rig.toml", jobs=2)
    assert asked and all(answer == [1, 2] for answer in asked)
