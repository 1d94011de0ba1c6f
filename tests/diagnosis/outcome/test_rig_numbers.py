"""Numbers of an improved rig that may move within their intervals."""

from __future__ import annotations

from pathlib import Path

import benches
import pytest

from exo_sim.diagnosis.outcome.rig_numbers import OpenNumber, open_numbers, with_numbers
from exo_sim.diagnosis.outcome.rig_update import Part, Rank, RigUpdate
from exo_sim.rig import Correction, EffectEntry, EffectSetting, parse

MASS = ("bodies", "load", "mass")
FORCE = ("effects", "coulomb_friction", "piston", "force")


@pytest.fixture
def update(tmp_path: Path) -> RigUpdate:
    def friction(force: float) -> EffectEntry:
        return EffectEntry(EffectSetting("coulomb_friction", "piston", {"force": force}), {"force": (force - 2.0, force + 2.0)}, "Dry.")

    zero = EffectEntry(EffectSetting("sensor_bias", "piston.pressure_1", {"value": 500.0}), {"value": (400.0, 600.0)})
    lag = EffectEntry(EffectSetting("valve_lag", "piston", {"time_constant": 3e-3, "delay": 1e-3}), {"delay": (0.0, 2e-3)})
    mass, other = (Correction(MASS, value, "kg", (value - 0.1, value + 0.1)) for value in (10.0, 11.0))
    unsure = Correction(("cylinders", "piston", "dead_volume_1"), 2e-5, "m^3")
    parts = (
        Part("gas of piston", Rank.FOUND, (lag,), (mass, unsure)),
        Part("gas of piston", Rank.SENSORS, (zero,)),
        Part("motion of slide", Rank.FOUND, (friction(9.0),), (other,)),
        Part("elsewhere", Rank.FOUND, (friction(7.0),)),
    )
    return RigUpdate(benches.bench(tmp_path), parts)


def test_each_number_of_the_machine_with_an_interval_is_open_once_and_none_of_its_sensors(update: RigUpdate) -> None:
    """Of two that say the same place, the first is the one that the file holds."""
    found = {number.place: number for number in open_numbers(update)}
    assert set(found) == {MASS, FORCE, ("effects", "valve_lag", "piston", "delay")}
    assert found[MASS] == OpenNumber(MASS, 10.0, 9.9, 10.1) and found[FORCE].value == 9.0


def test_a_number_moves_by_standard_errors_and_never_out_of_its_interval() -> None:
    number = OpenNumber(MASS, 10.0, 9.902001801, 10.098)
    assert number.error == pytest.approx(0.05, rel=1e-3)
    assert number.at(1.0) == pytest.approx(10.05, rel=1e-4)
    assert number.at(-9.0) == 9.902001801 and number.at(9.0) == 10.098


def test_other_numbers_take_their_place_in_the_file_which_says_how_they_came_there(update: RigUpdate, tmp_path: Path) -> None:
    moved = with_numbers(update, {MASS: 10.07, FORCE: 8.5})
    text = moved.text(tmp_path)
    rig = parse(text, tmp_path / "improved.toml")
    effect = rig.effect("coulomb_friction", "piston")
    assert effect is not None and effect.parameters == {"force": pytest.approx(8.5)}
    assert rig.body_masses["load"] == pytest.approx(10.07)
    assert "95 %: 7 to 11 N" in text and "95 %: 9.9 to 10.1 kg" in text
    assert "fitted once more together" in text and "fitted once more together" not in update.text(tmp_path)
    assert moved.parts[0].entries == update.parts[0].entries
