"""Forces of straps and the ground at the joints: as MuJoCo applies them, and known only where their place is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim import rig as rigs
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.subsystems.motion.contact_forces import are_recorded, site_forces
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording
from exo_sim.rig import Rig

LEG = """<mujoco><option timestep="0.001"/><worldbody>
  <geom name="floor" type="plane" size="0 0 1"/>
  <body name="trunk"><joint name="height" type="slide" axis="0 0 1"/><geom type="box" size="0.1 0.1 0.1" mass="9" contype="0"/>
    <body name="thigh"><joint name="hip" axis="0 -1 0"/><geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.02" mass="3" contype="0"/>
      <site name="cuff" pos="0 0 -0.25"/>
      <body name="foot" pos="0 0 -0.4"><joint name="knee" axis="0 -1 0"/>
        <geom name="sole" size="0.03" pos="0 0 -0.4" mass="2"/><site name="sole" pos="0 0 -0.43"/></body></body></body>
</worldbody></mujoco>"""
TIME: NDArray[np.float64] = np.linspace(0.0, 5.999, 6000)
MOTION = {
    "height": 0.9 + 0.03 * np.sin(5.0 * TIME), "hip": 0.4 * np.sin(4.0 * TIME), "knee": -0.5 + 0.4 * np.sin(4.0 * TIME + 0.7),
}  # fmt: skip
#: The foot is on the ground for the first half; where it is pushed wanders ahead of the site.
DOWN = np.clip((3.0 - TIME) / 0.2, 0.0, 1.0)
CENTRE = 0.05 * np.sin(3.0 * TIME)
FORCES = {
    "cuff.strap_force_x": 30.0 * np.sin(6.0 * TIME), "cuff.strap_force_z": 20.0 * np.cos(5.0 * TIME),
    "sole.ground_force_x": 10.0 * DOWN * np.sin(4.0 * TIME), "sole.ground_force_z": 150.0 * DOWN,
}  # fmt: skip


@pytest.fixture(scope="module")
def leg(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    folder = tmp_path_factory.mktemp("leg")
    (folder / "leg.xml").write_text(LEG)
    (folder / "rig.toml").write_text(
        'name = "leg"\nmodel = "leg.xml"\n[environment]\npressure = "101325 Pa"\ntemperature = "293.15 K"\n'
        '[supply]\npressure = "7 bar"\ntemperature = "293.15 K"\n'
    )
    return rigs.read(folder / "rig.toml")


def recorded(rig: Rig, *, forces: dict[str, np.ndarray] = FORCES, centre: bool = False) -> Recording:
    """Return the leg led along `MOTION`, with what moved each joint beside `FORCES` as its outside force."""
    model = load(rig)
    data, rest = mujoco.MjData(model), np.zeros((len(TIME), model.nv))
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    q = np.stack(list(MOTION.values()), axis=1)
    v, a = (np.gradient(q, TIME, axis=0), np.gradient(np.gradient(q, TIME, axis=0), TIME, axis=0))
    for i in range(len(TIME)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
        mujoco.mj_inverse(model, data)
        for site, kind in (("cuff", "strap_force"), ("sole", "ground_force")):
            body = model.body(int(model.site(site).bodyid[0])).id
            ahead = CENTRE[i] * data.xmat[body].reshape(3, 3)[:, 0] if site == "sole" else np.zeros(3)
            force = np.array([FORCES[f"{site}.{kind}_x"][i], 0.0, FORCES[f"{site}.{kind}_z"][i]])
            applied = np.zeros(model.nv)
            mujoco.mj_applyFT(model, data, force, np.zeros(3), data.site(site).xpos + ahead, body, applied)
            rest[i] -= applied
        rest[i] += data.qfrc_inverse
    columns = {f"{name}.position": values for name, values in MOTION.items()} | dict(forces)
    columns |= {f"{name}.external_force": rest[:, j] for j, name in enumerate(MOTION)}
    if centre:
        columns["sole.pressure_centre"] = CENTRE
    return Recording("leg", TIME, columns, {key: "1" for key in columns})


def balances(rig: Rig, recording: Recording) -> dict[str, MotionRun]:
    runs, reasons = motion_runs(recording, rig, load(rig), ())
    assert not reasons
    return {run.joint: run for run in runs}


def left(run: MotionRun) -> float:
    """Return what is left of a balance where it is judged, relative to what drives it."""
    return float(np.abs((run.demand - run.external)[run.judged]).max()) / float(np.std(run.driving))


def test_the_balance_closes_where_the_place_of_every_force_is_known(leg: Rig) -> None:
    runs = balances(leg, recorded(leg))
    assert {name: left(run) < 0.01 for name, run in runs.items()} == dict.fromkeys(MOTION, True)
    assert runs["height"].judged.mean() > 0.95  # a slide feels the force, wherever it acts
    for joint in ("hip", "knee"):
        judged = runs[joint].judged
        assert not judged[TIME < 3.0].any() and judged[(TIME > 3.2) & (TIME < 5.8)].all()
        assert runs[joint].external_recorded


def test_with_the_centre_of_pressure_it_closes_on_the_ground_as_well(leg: Rig) -> None:
    runs = balances(leg, recorded(leg, centre=True))
    for run in runs.values():
        assert run.judged.mean() > 0.95 and left(run) < 0.01


def test_an_axis_that_was_not_recorded_leaves_what_it_moves_unknown_under_load(leg: Rig) -> None:
    forces = {key: values for key, values in FORCES.items() if key != "sole.ground_force_x"}
    runs = balances(leg, recorded(leg, forces=forces, centre=True))
    assert runs["height"].judged.mean() > 0.95 and not runs["knee"].judged[TIME < 3.0].any()


def test_what_pushes_where_nobody_recorded_it_is_said(leg: Rig) -> None:
    model = load(leg)
    strange = Recording("leg", TIME, {"shin.strap_force_x": np.zeros(len(TIME))}, {"shin.strap_force_x": "N"})
    assert "no site shin" in site_forces(strange, model)[1]
    straps = {key: values for key, values in FORCES.items() if "strap" in key}
    without = Recording("leg", TIME, straps, {key: "N" for key in straps})
    assert are_recorded(without) and "foot touches the ground" in site_forces(without, model)[1]
    assert not are_recorded(Recording("leg", TIME, {}, {}))


def test_a_foot_that_is_always_down_without_its_place_is_not_judged(leg: Rig) -> None:
    forces = FORCES | {"sole.ground_force_z": np.full(len(TIME), 150.0)}
    runs, reasons = motion_runs(recorded(leg, forces=forces), leg, load(leg), ())
    assert [run.joint for run in runs] == ["height"]
    assert {name for name, _ in reasons} == {"hip", "knee"} and "pressure_centre" in reasons[0][1].do


def test_dry_friction_that_the_mjcf_holds_is_no_force_that_is_missing(leg: Rig, tmp_path: Path) -> None:
    """MuJoCo's `frictionloss` of a joint and of a tendon: to it they are constraints, to the balance they resist the motion."""
    tendon = '<tendon><spatial name="cord" frictionloss="20"><site site="shin"/><site site="cuff"/></spatial></tendon>'
    text = LEG.replace('name="hip"', 'name="hip" frictionloss="3"').replace("</worldbody>", f"</worldbody>{tendon}")
    (tmp_path / "leg.xml").write_text(text.replace('<site name="sole"', '<site name="shin" pos="0.05 0 -0.1"/><site name="sole"'))
    rubbing = replace(leg, model=tmp_path / "leg.xml")
    table = recorded(leg, centre=True)
    model = load(rubbing)
    data, reach = mujoco.MjData(model), np.zeros(len(TIME))
    for i in range(len(TIME)):
        data.qpos[:] = [MOTION[name][i] for name in MOTION]
        mujoco.mj_fwdPosition(model, data)
        reach[i] = data.ten_length[0]
    before, after = balances(leg, table), balances(rubbing, table)
    knee, cord = np.gradient(MOTION["knee"], TIME), np.gradient(reach, TIME)
    lost = {"height": np.zeros(len(TIME)), "hip": 3.0 * np.sign(np.gradient(MOTION["hip"], TIME)), "knee": 20.0 * np.abs(cord) / knee}
    for name, resisted in lost.items():
        steady = np.abs(np.gradient(MOTION[name], TIME)) > 0.6 * np.abs(np.gradient(MOTION[name], TIME)).max()
        steady[:200] = steady[-200:] = False
        taken = before[name].passive.force - after[name].passive.force
        np.testing.assert_allclose(taken[steady], resisted[steady], atol=0.02)


def test_parts_that_an_equality_holds_are_not_judged(leg: Rig, tmp_path: Path) -> None:
    link = '<equality><joint name="link" joint1="hip" joint2="knee"/></equality>'
    (tmp_path / "leg.xml").write_text(LEG.replace("</worldbody>", f"</worldbody>{link}"))
    bound = replace(leg, model=tmp_path / "leg.xml")
    runs, reasons = motion_runs(recorded(leg), bound, load(bound), ())
    assert not runs and {name for name, _ in reasons} == set(MOTION) and '"link"' in reasons[0][1].why


def test_a_force_along_the_sole_is_not_judged(leg: Rig) -> None:
    """Of one that hardly presses the sole no place along it says where it turns the joints."""
    flat = MOTION["hip"] + MOTION["knee"]
    sliding = {"sole.ground_force_x": 150.0 * DOWN * np.cos(flat), "sole.ground_force_z": 150.0 * DOWN * np.sin(flat)}
    runs = balances(leg, recorded(leg, forces=FORCES | sliding, centre=True))
    assert not runs["knee"].judged[(TIME > 0.2) & (TIME < 2.9)].any() and runs["knee"].judged[(TIME > 3.3) & (TIME < 5.8)].all()
    assert runs["height"].judged.mean() > 0.95


def test_noise_of_the_centre_of_pressure_counts(leg: Rig) -> None:
    table = recorded(leg, centre=True)
    shaken = dict(table.columns) | {"sole.pressure_centre": CENTRE + 5e-3 * np.random.default_rng(1).standard_normal(len(TIME))}
    before, after = (balances(leg, replace(table, columns=columns)) for columns in (table.columns, shaken))
    more = {name: float(np.sqrt(max(after[name].noise ** 2 - before[name].noise ** 2, 0.0))) for name in MOTION}
    assert more["height"] == 0.0
    for name in ("hip", "knee"):
        strayed = float(np.std((after[name].external - before[name].external)[after[name].judged]))
        assert more[name] == pytest.approx(strayed, rel=0.2)
