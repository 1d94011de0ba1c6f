"""The benchmark's own claims: everything is really on, and the rivals simulate the same machine."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from exo_sim import rig
from exo_sim.physics.declaration import declared


@pytest.fixture(autouse=True)
def scripts(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(repository / "scripts"))


@pytest.mark.parametrize("name", ["bench.toml", "exo.toml"])
def test_every_effect_is_on_that_a_step_can_feel(repository: Path, name: str) -> None:
    from benchmarks.everything import everything_on

    path = repository / "assets" / name
    machine = rig.read(path)
    full = rig.parse(path.read_text() + everything_on(machine), path)
    poorer = {name for effect in declared().values() for name, _ in effect.absorbs}
    felt = {e.name for e in declared().values() if e.places != ("column",) and not (e.name in poorer and "joint" not in e.places)}
    assert {one.name for one in full.effects} == felt and not poorer - felt
    for cylinder in machine.cylinders:
        assert sum(one.where == cylinder for one in full.effects) >= 22
    assert all(any(one.parameters.values()) or one.curves for one in full.effects)


def test_a_target_is_met_or_missed() -> None:
    from benchmarks.figure import Figure, as_json

    slow, quick = Figure("a", "slow", 2.5, "{:.1f} times", below=2.0), Figure("b", "quick", 2.5, above=2.0)
    assert slow.line().endswith("2.5 times   target < 2: MISSED")
    assert quick.line().endswith("2.50   target > 2: met")
    said = as_json([slow, quick, "left out"])
    assert said["a"] == 2.5 and said["remarks"] == ["left out"]
    assert as_json([Figure("c", "never", float("inf"))])["c"] is None
    assert said["targets"] == {"a": {"target": "< 2", "met": False}, "b": {"target": "> 2", "met": True}}


@pytest.mark.parametrize("numbers", [(1.0, 1.0, 1.0, 0.0), (0.9, 1.2, 0.8, 3.0)])
def test_rivals_simulate_the_same_gas_as_the_diagnosis(numbers: tuple[float, ...]) -> None:
    from benchmarks.fits import LedPiston, plain_cylinder, plain_pressures
    from benchmarks.task import LEAK, task

    given = task()
    values = dict(zip(given.parameters, (*numbers[:3], numbers[3] * LEAK), strict=True))
    ours = given.model.predict(given.model.apply(values), 0).pressure
    plain = plain_pressures(given, plain_cylinder(given), np.array(numbers))
    led = LedPiston(given).pressures(np.array(numbers))
    assert np.ptp(ours) > 1e5
    for other in (plain, led):
        assert np.sqrt(np.mean((other - ours) ** 2)) < 10.0  # Pa, of 1e5 and more; only the integrator differs
        assert np.abs(other - ours).max() < 100.0


def test_fits_end_where_the_truth_lies() -> None:
    from benchmarks.fits import ours
    from benchmarks.task import task

    given = task()
    before, after = given.error(given.start), given.error(ours(given).asked[-1][1])
    assert after < 0.5 * before
    assert after < 2.0 * 250.0  # the noise of the sensors


def test_recordings_of_different_length_begin_alike(tmp_path: Path) -> None:
    import pyarrow.parquet as pq
    from benchmarks import recordings

    (short, rig_1), (long, rig_2) = recordings.write(tmp_path, "wall_heat_transfer", [1.0, 2.0])
    assert rig_1.read_text() == rig_2.read_text()
    one, two = pq.read_table(short), pq.read_table(long)
    assert (one.num_rows, two.num_rows) == (1000, 2000)
    assert two.slice(0, 1000).equals(one)


def test_a_verb_says_what_it_held(tmp_path: Path) -> None:
    from benchmarks.command import seconds_and_peak

    taken, peak = seconds_and_peak(["--help"])
    assert 0.0 < taken < 60.0
    assert 5e6 < peak < 1e9
    with pytest.raises(RuntimeError, match="ended with 2"):
        seconds_and_peak(["nonsense"])


def test_one_part_alone(repository: Path) -> None:
    words = [sys.executable, str(repository / "scripts" / "benchmark"), "--only", "memory", "--json"]
    said = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    assert said["schema"] == "exo-sim/benchmark/1"
    assert said["remarks"] == ["one hour at 1 kHz: only with --long"]
