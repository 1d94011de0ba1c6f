"""Balances of forces of a worn machine, from what `run` writes: they close, also on tilted soles, at stops and under other loads."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.diagnosis.subsystems.motion.moving_masses import payload
from exo_sim.diagnosis.subsystems.motion.rows import rows_of
from exo_sim.diagnosis.subsystems.motion.stops import at_stop
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording
from exo_sim.recording.filters import SmoothedMotion
from exo_sim.rig import JointFactors, Rig, read
from exo_sim.simulation.record import recording
from exo_sim.simulation.walk import Request, rig_at_250_psi
from exo_sim.simulation.worn import Simulation

LOADED = 41.0


@pytest.fixture(scope="module")
def rig() -> Rig:
    return read(rig_at_250_psi())


def walked(rig: Rig, mass: float) -> Recording:
    return recording(Simulation(rig, Request("level_walk", payload=mass, cycles=3)).run(), "walk")


@pytest.fixture(scope="module")
def table(rig: Rig) -> Recording:
    return walked(rig, 34.0)


@pytest.fixture(scope="module")
def loaded(rig: Rig) -> Recording:
    return walked(rig, LOADED)


def balances(rig: Rig, table: Recording) -> dict[str, MotionRun]:
    model = load(rig)
    runs, reasons = motion_runs(table, rig, model, linkages(rig, model))
    assert not reasons
    return {run.joint: run for run in runs}


def left(run: MotionRun) -> tuple[np.ndarray, np.ndarray, float]:
    """Return what is left of each row, what a payload as heavy as all would ask there, and the rows' standard deviation."""
    rows = rows_of(run, np.ones(len(run.time), dtype=bool))
    asked = np.zeros(len(rows.block)) if run.inertia.carried is None else rows.means(run.inertia.carried)
    return rows.means(run.demand - run.drive.force - run.external), asked, float(rows.scale[0])


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_nothing_is_left_of_the_machine_that_was_simulated(rig: Rig, table: Recording) -> None:
    for name, run in balances(rig, table).items():
        missing, _, scale = left(run)
        assert len(missing) > 50 and rms(missing) < 0.5 * scale, name


def test_the_centre_of_pressure_says_the_moment_of_the_ground(rig: Rig, table: Recording) -> None:
    """Sample by sample, ahead of any filter: what the ankle's motion takes is what spring, straps and ground give it."""
    model = load(rig)
    data = mujoco.MjData(model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    names = [model.joint(j).name for j in range(model.njnt)]
    q, v = (np.stack([table[f"{name}.{what}"] for name in names], axis=1) for what in ("position", "velocity"))
    a = np.diff(v, axis=0) / np.diff(table.time)[:, None]
    dof, foot = names.index("ankle_l"), model.body("foot_l").id
    missing, tilted = [], 0
    for i in range(0, len(a), 3):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
        mujoco.mj_inverse(model, data)
        force = np.array([table[f"foot_l.ground_force_{axis}"][i] if axis != "y" else 0.0 for axis in "xyz"])
        along = data.xmat[foot].reshape(3, 3)[:, 0]
        if force[2] <= 0.0 or abs(force @ along) > 0.98 * np.linalg.norm(force):
            continue
        tilted += along[2] < -0.3
        given = np.zeros(model.nv)
        straps = [(site, 0.0, "strap") for site in ("foot_l_strap_heel", "foot_l_strap_toe")]
        for site, ahead, kind in [("foot_l", table["foot_l.pressure_centre"][i], "ground"), *straps]:
            pushed = np.array([table[f"{site}.{kind}_force_{axis}"][i] if axis != "y" else 0.0 for axis in "xyz"])
            mujoco.mj_applyFT(model, data, pushed, np.zeros(3), data.site(site).xpos + ahead * along, foot, given)
        damped = model.dof_damping[dof] * (v[i + 1, dof] - v[i, dof])  # MuJoCo damps at the end of the step
        missing.append(data.qfrc_inverse[dof] + damped - given[dof])
    assert tilted > 20 and np.abs(missing).max() < 1e-6


def test_another_payload_shows_as_such_in_every_balance_that_feels_it(rig: Rig, loaded: Recording) -> None:
    model = load(rig)
    body = payload(model)
    assert body is not None
    whole = float(model.body_subtreemass[model.body("torso").id])
    for name, run in balances(rig, loaded).items():
        missing, asked, scale = left(run)
        if name.startswith("torso"):
            more = -float(asked @ missing / (asked @ asked)) * whole
            assert more == pytest.approx(LOADED - float(model.body_mass[body]), abs=0.1)
            assert rms(missing) > 5.0 * scale and rms(missing + more / whole * asked) < 0.7 * scale
        else:
            assert run.inertia.carried is None and rms(missing) < 0.7 * scale


def test_what_a_stop_pushes_is_not_judged(rig: Rig, table: Recording) -> None:
    free = balances(rig, table)["knee_l"]
    angle = table["knee_l.position"]
    high = float(np.percentile(angle, 90.0))
    low = float(load(rig).joint("knee_l").range[0])
    stopped = replace(rig, joint_factors={"knee_l": JointFactors(range=(low, high))})
    run = balances(stopped, table)["knee_l"]
    there = angle > high
    assert free.judged[there].mean() > 0.5 and not run.judged[there].any()
    assert run.judged[angle < high - 0.5].mean() > 0.7


def test_a_stop_is_felt_as_far_as_the_filter_reaches(rig: Rig) -> None:
    model, time = load(rig), np.arange(2000.0) * 1e-3
    joint = model.joint("knee_l").id
    high = float(model.jnt_range[joint, 1])
    angle = np.where(np.abs(time - 1.0) < 0.1, high + 0.01, high - 0.3)
    felt = at_stop(model, joint, time, SmoothedMotion(angle, angle, angle, 1e-4, 1e-4))
    assert felt[np.abs(time - 1.0) < 0.13].all() and not felt[np.abs(time - 1.0) > 0.15].any()
    model.jnt_limited[joint] = False
    assert not at_stop(model, joint, time, SmoothedMotion(angle, angle, angle, 1e-4, 1e-4)).any()
