"""Who moves a joint is told by power: friction takes it, a person or a test machine gives it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.simulation.replay import external_drive
from exo_sim.simulation.replay.external_drive import (
    DRIVEN_BESIDE,
    DRIVEN_SHARE,
    POWER_SMOOTHING,
    _is_free,
    _power_shares,
    external_power,
    externally_driven,
)

Array = NDArray[np.float64]
TIME: Array = np.asarray(np.arange(4000) * 1e-3, dtype=np.float64)
SPEED: Array = 0.3 * np.cos(2.0 * np.pi * TIME)
DRIVE: Array = 40.0 * np.sign(SPEED) + 5.0 * np.sin(6.0 * np.pi * TIME)


@pytest.mark.parametrize("lost", [0.0 * SPEED, 8.0 * np.sign(SPEED), 20.0 * SPEED])
def test_friction_and_damping_are_no_drive(lost: Array) -> None:
    assert external_power(TIME, DRIVE - lost, DRIVE, SPEED) == ""


def test_a_constant_force_is_a_sensor_s_zero() -> None:
    assert external_power(TIME, DRIVE + 15.0, DRIVE, SPEED) == ""


def test_a_hand_that_pushes_along_is_a_drive() -> None:
    """Half as much again as what is known: a third of all power."""
    says = external_power(TIME, DRIVE + 20.0 * np.sign(SPEED), DRIVE, SPEED)
    share = float(says.split(" put in ")[1].split(" %")[0]) / 100.0
    assert share == pytest.approx(20.0 / 60.0, abs=0.02) and share > DRIVEN_SHARE


def test_a_push_at_a_stop_is_no_drive() -> None:
    """Whoever ignores where the joint is free, or takes the constant over all time, calls the stop's push a hand."""
    pushed = np.where(TIME % 1.0 < 0.3, 200.0 * np.sign(SPEED), 0.0)
    free = pushed == 0.0
    assert external_power(TIME, DRIVE - 8.0 * np.sign(SPEED) + pushed, DRIVE, SPEED) != ""
    assert external_power(TIME, DRIVE - 8.0 * np.sign(SPEED) + pushed, DRIVE, SPEED, free) == ""
    one_way = np.where(free, 0.0, 900.0)
    assert external_power(TIME, DRIVE - 8.0 * np.sign(SPEED) + 15.0 + one_way, DRIVE, SPEED, free) == ""


def test_a_constant_is_that_of_all_free_time_and_not_of_whole_free_blocks_alone() -> None:
    """Of every block but a few a sample is not free: what is left tells the constant of the forces far less well than all that is free."""
    free = np.ones(TIME.size, dtype=bool)
    free[1500::100] = False
    slow = np.where(TIME < 1.5, 30.0, -30.0 * 1.5 / 2.5)  # its mean over all time is nil
    assert external_power(TIME, DRIVE - 4.0 * np.sign(SPEED) + slow, DRIVE, SPEED, free) != ""
    assert external_power(TIME[:1500], (DRIVE - 4.0 * np.sign(SPEED) + slow)[:1500], DRIVE[:1500], SPEED[:1500]) == ""


def test_of_a_joint_that_is_hardly_ever_free_nobody_can_tell() -> None:
    free = np.zeros(TIME.size, dtype=bool)
    free[600:1000] = True
    hand = 40.0 * np.sign(SPEED)
    assert external_power(TIME, DRIVE + hand, DRIVE, SPEED, free) == ""
    free[600:2000] = True
    assert external_power(TIME, DRIVE + hand, DRIVE, SPEED, free) != ""


@pytest.mark.parametrize("step", [1e-3, 2e-2, 5e-2])
def test_beside_a_stop_nothing_counts_as_far_as_the_smoothed_motion_shows_it(tmp_path: Path, step: float) -> None:
    """However slow the clock, on which the motion is smoothed over five samples at least."""
    rig = benches.bench(tmp_path)
    joint = '<joint name="slide" type="slide" axis="1 0 0"'
    rig.model.write_text(rig.model.read_text().replace(joint, joint + ' limited="true" range="-0.03 0.03"'))
    time = np.arange(0.0, 8.0, step)
    position = np.where(np.abs(time - 4.0) < 0.5 * step, 0.03, 0.005 * np.sin(time))
    table = benches.recording(time, {"slide.position": position, "piston.pressure_1": np.where(time > 7.0, np.nan, 4e5)})
    table = replace(table, breaks=(2.0,))
    free = _is_free(load(rig), 0, table, ["piston.pressure_1", "piston.pressure_2"])
    width = max(POWER_SMOOTHING, 5.0 * step)
    for event in (2.0, 4.0, 7.0 + step):
        assert not free[np.abs(time - event) < 0.95 * width].any()
    assert free[time < 2.0 - 1.5 * width].all() and free[np.abs(time - 3.0) < 0.3].all()


def test_what_stops_throw_back_puts_in_no_power(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    joint = '<joint name="slide" type="slide" axis="1 0 0"'
    springy = joint + ' limited="true" range="-0.03 0.03" solreflimit="-40000 -20"'
    rig.model.write_text(rig.model.read_text().replace(joint, springy))
    model = load(rig)
    assert _power_shares(benches.recorded(rig, 8.0), rig, model, linkages(rig, model), [0])["slide"] < 0.02


@pytest.mark.parametrize(
    ("shares", "measured", "driven"),
    [
        ({"a": 0.5, "b": 0.08}, "", {"a", "b"}),
        ({"a": 0.5, "b": 0.02}, "", {"a"}),
        ({"a": 0.02, "b": 0.08}, "", set()),
        ({"a": 0.5, "b": 0.08}, "a", set()),
    ],
    ids=["led beside", "free beside", "alone", "measured"],
)
def test_who_moves_one_joint_is_sooner_held_to_move_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, shares: dict[str, float], measured: str, driven: set[str]
) -> None:
    """A knee that its wearer leads along with the gas has a share that alone would be no evidence; a hip that was measured says nothing."""
    rig = benches.bench(tmp_path)
    rig.model.write_text(rig.model.read_text().replace('name="slide"', 'name="a"').replace('joint="slide"', 'joint="a"'))
    extra = '<body pos="0 1 0"><joint name="b" type="slide" axis="1 0 0"/><geom size="0.1" mass="1"/></body></worldbody>'
    rig.model.write_text(rig.model.read_text().replace("</worldbody>", extra))
    model = load(rig)
    columns = {f"{name}.position": 0.05 * np.sin(TIME) for name in shares}
    columns |= {f"{measured}.external_force": 0.0 * TIME} if measured else {}
    monkeypatch.setattr(external_drive, "_power_shares", lambda *given: shares)
    assert DRIVEN_BESIDE < shares["b"] < DRIVEN_SHARE or shares["b"] == 0.02
    assert set(externally_driven(benches.recording(TIME, columns), rig, model, linkages(rig, model))) == driven


def test_a_joint_that_nothing_moves_is_not_driven() -> None:
    assert external_power(TIME, 0.0 * TIME, 0.0 * TIME, 0.0 * TIME) == ""
