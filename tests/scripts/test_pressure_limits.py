"""The range over which a number of `conventions/limits.py` decides nothing otherwise is found, and the number is as it was."""

from __future__ import annotations

import importlib.machinery
import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from exo_sim.conventions import limits, pressures
from exo_sim.deciding_number import Number
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions


@pytest.fixture
def script(repository: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(repository / "scripts"))
    loader = importlib.machinery.SourceFileLoader("pressure_limits", str(repository / "scripts" / "pressure_limits"))
    spec = importlib.util.spec_from_loader("pressure_limits", loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setattr("sys.dont_write_bytecode", True)
    loader.exec_module(module)
    return module


def test_a_bench_is_read_rightly_however_its_pressures_were_written(script: ModuleType, tmp_path: Path) -> None:
    write_case(make_case("a", seed=11, conditions=Conditions(duration=4.0, known=())), tmp_path)
    trials = list(script.variants(tmp_path))
    written = [name.partition(" ")[2] for name, *_ in trials]
    assert written == ["as it is", "gauge", "chambers gauge", *(f"in {unit}" for unit in script.UNITS)]
    assert script.wrong(trials) == set()


def test_the_range_ends_before_something_is_lost(script: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(script, "wrong", lambda trials: {"one"} if not 0.3 < limits.NEAR_LOW < 1.0 else set())
    before = limits.NEAR_LOW
    said = script.line("NEAR_LOW", Number(0.4, "pressures of the supply", "..."), [], set())
    assert said == "NEAR_LOW = 0.4 pressures of the supply: right from 0.32 (at 0.268 1 lost, as one) to 0.8 (at 1.2 1 lost, as one)"
    assert before == limits.NEAR_LOW


def test_what_is_kept_is_what_is_computed(script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_case(make_case("a", seed=11, conditions=Conditions(duration=4.0, known=())), tmp_path)
    trials = list(script.variants(tmp_path))
    plain = [pressures.absolute(recording, machine)[1] for _, recording, machine, _ in trials]
    monkeypatch.setattr(pressures, "_misfits", pressures._misfits)
    monkeypatch.setattr(pressures, "noise", pressures.noise)
    script.keep_misfits()
    for _ in range(2):
        assert [pressures.absolute(recording, machine)[1] for _, recording, machine, _ in trials] == plain
