"""Errors of a rig itself: what is put into it lowers them, and nothing is fitted on the way."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.pipeline import rig_errors
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.pipeline.rig_errors import WindowErrors
from exo_sim.rig import Rig, parse
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions
from exo_sim.trials.oracle import oracle_rig

BALANCE = "piston.force_balance"


def case(folder: Path, effect: str) -> tuple[WindowErrors, Rig, Rig]:
    """Write a case of ten seconds; return its errors over the seventh to ninth, its rig and that with the truth in it."""
    write_case(make_case("a", (effect,), 11, 0.5, Conditions(duration=10.0, known=())), folder, "parquet", open_truth=True)
    data = gather([folder / "recording.parquet"], folder / "rig.toml")
    believed = (folder / "rig.toml").read_text()
    right = oracle_rig(believed, json.loads((folder / "truth.json").read_text())["hidden"])
    return WindowErrors(data, Split({data.recordings[0].name: ((7.0, 9.0),)})), data.rig, parse(right, data.rig.path)


@pytest.mark.parametrize(
    ("effect", "signals"), [("piston_leakage", ("piston.pressure_1", "piston.pressure_2")), ("coulomb_friction", (BALANCE,))]
)
def test_the_truth_lowers_the_errors_of_its_own_signals(tmp_path: Path, effect: str, signals: tuple[str, ...]) -> None:
    errors, believed, right = case(tmp_path, effect)
    same, better = errors.errors(believed), errors.errors(right)
    assert set(same) == set(better) == {"piston.pressure_1", "piston.pressure_2", BALANCE}
    for key, fit in same.items():
        assert fit.after == fit.before == better[key].before
    for key in signals:
        assert better[key].after < 0.5 * better[key].before


def test_a_curve_of_force_counts_in_the_balance(tmp_path: Path) -> None:
    errors, believed, _ = case(tmp_path, "viscous_friction")
    effect = '\n[effects.unknown.piston]\nacts = "force"\ndepends_on = "velocity"\nat = ["-1 m/s", "1 m/s"]\nvalues = ["{} N", "{} N"]\n'
    curves = (parse(believed.text + effect.format(*values), believed.path) for values in ((20.0, -20.0), (-20.0, 20.0)))
    against, along = (errors.errors(curved)[BALANCE] for curved in curves)
    assert against.after < against.before < along.after


def test_of_long_recordings_only_the_time_kept_back_is_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole, _, right = case(tmp_path, "piston_leakage")
    of_all = whole.errors(right)
    monkeypatch.setattr(rig_errors, "LONGEST_FREE_RUN", 5.0)
    part, _, _ = case(tmp_path, "piston_leakage")
    of_part = part.errors(right)
    assert {"piston.pressure_1", "piston.pressure_2"} <= set(of_part)
    for key, fit in of_part.items():
        if "pressure" in key:  # a balance of forces is judged at its own rows, fewer at the ends of a recording
            assert fit.before == pytest.approx(of_all[key].before, rel=0.3)
            assert fit.after < 0.5 * fit.before
