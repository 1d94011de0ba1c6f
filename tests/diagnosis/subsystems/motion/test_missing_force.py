"""What a balance lacks: sensors ask for the same resistance, rows are means of it, of a long recording only what is fitted is predicted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs
from numpy.typing import NDArray

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.motion import missing_force
from exo_sim.diagnosis.subsystems.motion.missing_force import MARGIN, MissingForce, MissingRows, around
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.rows import rows_of

Array = NDArray[np.float64]


def rubbed(force: float = 6.0, **sensors: float) -> PlantParameters:
    """Return a machine with dry friction."""
    one = motion_runs.plant()
    one.cylinder["coulomb_friction"]["force"] = force
    return replace(one, sensors=dict(sensors))


def long_run(times: int) -> MotionRun:
    """Return a balance that repeats itself so often, with noise that does not."""
    short = motion_runs.balance(np.zeros_like(motion_runs.TIME), noise=0.3)
    n, step = len(short.time), short.time[1] - short.time[0]
    noise = np.random.default_rng(4).standard_normal(times * n)

    def tiled(values: Array) -> Array:
        return np.tile(values, times)

    def each(signals: Mapping[str, Array]) -> dict[str, Array]:
        return {name: tiled(values) for name, values in signals.items()}

    path, inertia, drive = short.kinematics, short.inertia, short.drive
    return replace(
        short, time=np.arange(times * n) * step,
        kinematics=replace(path, position=tiled(path.position), velocity=tiled(path.velocity)),
        inertia=replace(inertia, force=tiled(inertia.force) + noise, bias=tiled(inertia.bias), tilt=tiled(inertia.tilt)),
        passive=replace(short.passive, force=tiled(short.passive.force)),
        drive=replace(drive, force=tiled(drive.force), arm=tiled(drive.arm), gauge=np.tile(drive.gauge, (times, 1)),
                      levers=each(drive.levers), signals=each(drive.signals)),
        external=tiled(short.external),
    )  # fmt: skip


def test_what_sensors_add_asks_for_no_other_resistance(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    plain = missing_force.resistance_along
    monkeypatch.setattr(missing_force, "resistance_along", lambda *given: asked.append(1) or plain(*given))  # type: ignore[func-returns-value]
    lacking = MissingForce(motion_runs.balance(np.zeros_like(motion_runs.TIME)))
    first = lacking.of(rubbed())
    np.testing.assert_allclose(lacking.of(rubbed(offset=2.0)), first - 2.0, atol=1e-12)
    assert len(asked) == 1
    lacking.of(rubbed(7.0))
    assert len(asked) == 2


def test_rows_are_means_of_what_is_lacking_at_the_samples() -> None:
    n = len(motion_runs.TIME)
    chance, column = np.random.default_rng(1), "slide.external_force"
    run = motion_runs.balance(chance.standard_normal(n), 0.3)
    drive = replace(run.drive, levers={column: 1.0 + 0.1 * np.sin(motion_runs.TIME)}, signals={column: chance.standard_normal(n)})
    run = replace(run, drive=drive)
    rows = rows_of(run, np.arange(n) < 0.7 * n)
    at_samples, of_rows = MissingForce(run), MissingRows(run, rows)
    for plant in (
        rubbed(),
        rubbed(9.0, offset=1.0, inertia=1.3, zero=0.1, payload_mass=0.9),
        rubbed(0.0, **{f"{column}.bias": 2.0, f"{column}.scale": 1.1, "drive.delay": 2e-3}),
    ):
        np.testing.assert_allclose(of_rows.of(plant), rows.means(at_samples.of(plant)), rtol=1e-10, atol=1e-10)


def test_a_resistance_that_is_no_number_somewhere_is_bridged_in_rows_as_it_is_at_samples() -> None:
    run = motion_runs.balance(np.zeros_like(motion_runs.TIME), 0.3)
    holed = run.drive.arm.copy()
    holed[3000:3004] = np.nan
    run = replace(run, drive=replace(run.drive, arm=holed))
    rows = rows_of(run, np.ones(len(run.time), dtype=bool))
    found = MissingRows(run, rows).of(rubbed())
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found, rows.means(MissingForce(run).of(rubbed())), rtol=1e-12)


def test_of_a_long_recording_only_what_is_fitted_is_predicted_and_it_is_the_same() -> None:
    times = int(np.ceil(400.0 / np.ptp(motion_runs.TIME)))
    run = long_run(times)
    model = MotionModel([run], rubbed(), Split({}))
    assert sum(len(lacking.run.time) for lacking in model._set._fitted) < 0.5 * len(run.time)
    for plant in (rubbed(), rubbed(9.0, offset=1.0), rubbed(0.0)):
        whole = np.concatenate([rows.means(MissingForce(run).of(plant)) for rows in model._set.rows]) / model.scale
        np.testing.assert_allclose(model.residual_of(plant), whole, rtol=1e-9, atol=1e-9)


def test_parts_hold_all_rows_in_their_order_with_a_margin_around_them() -> None:
    run = long_run(int(np.floor(60.0 / np.ptp(motion_runs.TIME))))
    usable = (run.time % 20.0) < 5.0
    rows = rows_of(run, usable)
    parts = around(run, rows)
    assert len(parts) == 3
    np.testing.assert_array_equal(np.concatenate([own.block for _, own in parts]), rows.block)
    values = np.concatenate([own.means(part.kinematics.position) for part, own in parts])
    np.testing.assert_allclose(values, rows.means(run.kinematics.position))
    for part, own in parts[1:]:
        first = np.flatnonzero(own.compared)[0]
        assert part.time[first] - part.time[0] == pytest.approx(MARGIN, abs=0.01)
    assert around(run, rows_of(run, np.zeros(len(run.time), dtype=bool))) == []
