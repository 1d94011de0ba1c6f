"""Recordings of real machines: what their readme says of them must be found in the tables made of them."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from exo_sim import rig
from exo_sim.recording import Recording
from exo_sim.recording.foreign.emps import read_emps
from exo_sim.recording.foreign.gas_spring import read_gas_spring
from exo_sim.recording.foreign.pendulum import read_pendulum
from exo_sim.recording.foreign.seals import read_friction, read_pressure_decay
from exo_sim.recording.health import check

MACHINES = ("emps", "pendulum", "gas_spring", "seals_friction", "pressure_decay")


@pytest.mark.parametrize("machine", MACHINES)
def test_believed_rigs_open(repository: Path, machine: str) -> None:
    believed = rig.read(repository / "assets" / "real" / machine / "rig.toml")
    model = mujoco.MjModel.from_xml_path(str(believed.model))
    assert believed.name == machine
    assert not believed.effects
    assert (model.dof_damping == 0.0).all() and (model.dof_frictionloss == 0.0).all()


def quiet(recording: Recording) -> None:
    assert [f for f in check(recording) if f.severity == "fault"] == []


def inverse_dynamics_fit(recording: Recording) -> np.ndarray:
    """Mass, viscous and Coulomb coefficients and offset by least squares on low-passed derivatives."""
    from scipy.signal import butter, filtfilt

    time, force = recording.time, recording["slide.external_force"]
    low = butter(4, 60.0, fs=1000.0)
    position = filtfilt(*low, recording["slide.position"])
    speed = np.gradient(position, time)
    design = np.stack((np.gradient(speed, time), speed, np.sign(speed), np.ones_like(time)), axis=1)
    columns = [filtfilt(*low, column)[500:-500:10] for column in design.T]
    return np.linalg.lstsq(np.stack(columns, axis=1), filtfilt(*low, force)[500:-500:10], rcond=None)[0]


@pytest.mark.real_data
def test_emps_gives_the_published_fit(shared_data: Path) -> None:
    recording = read_emps(shared_data / "emps" / "DATA_EMPS.mat")
    quiet(recording)
    mass, viscous, coulomb, offset = inverse_dynamics_fit(recording)
    assert mass == pytest.approx(95.1089, rel=0.01)
    assert viscous == pytest.approx(203.5034, rel=0.05)
    assert coulomb == pytest.approx(20.3935, rel=0.05)
    assert offset == pytest.approx(-3.1648, rel=0.15)
    assert read_emps(shared_data / "emps" / "DATA_EMPS_PULSES.mat").name == "pulses"


@pytest.mark.real_data
def test_the_pendulum_swings_at_the_rate_of_its_rig(shared_data: Path, repository: Path) -> None:
    swings = read_pendulum(shared_data / "pendulum" / "SinglePendulumDataForParameterEstimation.mat")
    assert list(swings) == [f"identify_{i}" for i in range(1, 5)] + ["validate_1", "validate_2"]
    for swing in swings.values():
        quiet(swing)
        slope = np.gradient(swing["arm.position"], swing.time)
        assert np.std(slope - swing["arm.velocity"]) < 0.02 * np.std(slope)
    model = mujoco.MjModel.from_xml_path(str(repository / "assets" / "real" / "pendulum" / "pendulum.xml"))
    data = mujoco.MjData(model)
    last = swings["validate_2"]
    start = slice(0, 800)  # one swing: friction has not yet changed its rate
    data.qpos[0], data.qvel[0] = last["arm.position"][0], last["arm.velocity"][0]
    simulated = []
    for _ in range(800):
        simulated.append(data.qpos[0])
        mujoco.mj_step(model, data)
    assert np.std(np.array(simulated) - last["arm.position"][start]) < 0.05


@pytest.mark.real_data
def test_the_gas_spring_keeps_its_gas(shared_data: Path, repository: Path) -> None:
    """With the believed chambers both exponents of a closed gas lie between isothermal and adiabatic."""
    (path,) = (shared_data / "gas_spring").glob("*.exp")
    recording = read_gas_spring(path)
    quiet(recording)
    spring = rig.read(repository / "assets" / "real" / "gas_spring" / "rig.toml").cylinders["spring"]
    x = recording["piston.position"]
    volumes = (
        spring.dead_volume_1 + spring.area_1 * x,
        spring.dead_volume_2 + spring.area_2 * (spring.stroke - x),
    )
    for number, volume in enumerate(volumes, start=1):
        slope = np.polyfit(np.log(volume), np.log(recording[f"spring.pressure_{number}"]), 1)[0]
        assert 1.0 < -slope < 1.4
    pulled = read_gas_spring(path, with_force=True)
    assert pulled["piston.external_force"].max() == pytest.approx(6829.268 * 4.4482216152605)


@pytest.mark.real_data
@pytest.mark.parametrize("seal,published", [("O-ring", (3.9, 5.5, 6.9, 7.8)), ("KDN", (5.6, 5.7, 6.2, 6.8))])
def test_half_the_hysteresis_of_the_seals(shared_data: Path, seal: str, published: tuple[float, ...]) -> None:
    area = np.pi * 0.0125**2
    for bar, half in zip((1, 3, 5, 7), published):
        recording = read_friction(shared_data / "seals" / "friction" / f"{seal}_{bar}bar.csv")
        quiet(recording)
        rod = -(recording["slide.external_force"] + (recording["piston.pressure_1"] - 101325.0) * area)
        speed = np.gradient(np.convolve(recording["slide.position"], np.ones(21) / 21, "same"), recording.time)
        found = 0.5 * (np.median(rod[speed < -2e-3]) - np.median(rod[speed > 2e-3]))
        assert found == pytest.approx(half, abs=0.6)  # friction resists both ways: + when turned round right


@pytest.mark.real_data
def test_pressure_decay(shared_data: Path) -> None:
    control = read_pressure_decay(shared_data / "seals" / "pressure_decay" / "Aluminium.csv")
    assert (np.diff(control.time) > 0).all()
    assert control.duration == pytest.approx(151.3, abs=0.1)
    assert control["piston.pressure_1"][[0, -1]] == pytest.approx([832825.0, 829825.0], abs=500.0)
    leaking = read_pressure_decay(shared_data / "seals" / "pressure_decay" / "Ultimaker_015.csv")
    assert leaking["piston.pressure_1"][-1] == pytest.approx(101325.0 + 7200.0, abs=100.0)
