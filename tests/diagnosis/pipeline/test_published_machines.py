"""What is found in the recordings of real machines, against what was published of them (docs/how_the_diagnosis_works.md)."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.diagnosis.pipeline.diagnose import diagnose
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.recording import read
from exo_sim.simulation.replay import replay, rms

pytestmark = [pytest.mark.real_data, pytest.mark.slow]


@pytest.fixture(scope="module")
def tables(shared_data: Path, repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recordings, brought to the contract's table."""
    out = tmp_path_factory.mktemp("real")
    script = repository / "scripts" / "real_recordings"
    subprocess.run([sys.executable, str(script), str(out), str(shared_data)], check=True, capture_output=True)
    return out


def found_in(recordings: list[Path], rig: Path, folder: Path) -> Diagnosis:
    assert recordings
    found = diagnose(sorted(recordings), rig, folder=folder)
    (folder / "improved.toml").write_text(found.improved)
    return found


def missing(found: Diagnosis) -> set[str]:
    return {finding.name for finding in found.effects if finding.kind == "missing_physics"}


def test_emps(tables: Path, repository: Path, tmp_path: Path) -> None:
    """Published (Janot, Gautier, Brunot 2019): 95.11 kg, 203.5 N s/m, 20.39 N, -3.165 N."""
    recordings = list((tables / "emps").glob("*.parquet"))
    found = found_in(recordings, repository / "assets" / "real" / "emps" / "rig.toml", tmp_path)
    assert missing(found) == {"coulomb_friction", "viscous_friction"}
    assert set(found.held_out) == {path.stem for path in recordings}
    numbers = {finding.name: finding.parameters for finding in found.effects}
    assert 100.0 * numbers["payload_mass"]["factor"].value == pytest.approx(95.11, rel=0.01)
    assert numbers["coulomb_friction"]["force"].low < 20.39 < numbers["coulomb_friction"]["force"].high
    assert numbers["viscous_friction"]["coefficient"].low < 203.5 < numbers["viscous_friction"]["coefficient"].high
    (constant,) = [finding for finding in found.effects if finding.kind == "sensor"]
    assert constant.parameters["value"].low < -3.165 < constant.parameters["value"].high
    assert "asymmetric_friction" in constant.ambiguous_with
    text = (tmp_path / "improved.toml").read_text()
    published = {r'mass = "[\d.]+ kg"': 'mass = "95.11 kg"', r'force = "[\d.]+ N"': 'force = "20.39 N"',
                 r'coefficient = "[\d.]+ N s/m"': 'coefficient = "203.5 N s/m"', r'value = "-[\d.]+ N"': 'value = "-3.165 N"'}  # fmt: skip
    for pattern, number in published.items():
        text, count = re.subn(pattern, number, text, count=1)
        assert count == 1
    (tmp_path / "published.toml").write_text(text)
    theirs = diagnose(sorted(recordings), tmp_path / "published.toml", folder=tmp_path)
    assert found.signals["slide.force_balance"].after < theirs.signals["slide.force_balance"].before
    assert found.free_run["slide.position"].after < theirs.free_run["slide.position"].before < 0.015


def test_pendulum(tables: Path, repository: Path, tmp_path: Path) -> None:
    recordings = sorted((tables / "pendulum").glob("*.parquet"))
    rig = repository / "assets" / "real" / "pendulum" / "rig.toml"
    found = found_in([path for path in recordings if not path.stem.startswith("validate_1")], rig, tmp_path)
    assert missing(found) == {"coulomb_friction", "quadratic_drag"}
    squares = []
    for path in recordings:
        if path.stem.startswith("validate"):
            table = read(path).recording
            run = replay(table, rigs.read(tmp_path / "improved.toml")).free_run
            squares.append(rms(table["arm.position"], run["arm.position"]) ** 2)
    assert len(squares) == 2 and np.sqrt(np.mean(squares)) < 0.0100


def test_gas_spring(tables: Path, repository: Path, tmp_path: Path) -> None:
    """The best polytropic exponents leave 0.30 and 0.25 bar."""
    recordings = list((tables / "gas_spring").glob("*.parquet"))
    found = found_in(recordings, repository / "assets" / "real" / "gas_spring" / "rig.toml", tmp_path)
    assert missing(found) == {"wall_heat_transfer"}
    (heat,) = [finding for finding in found.effects if finding.kind == "missing_physics"]
    assert all(heat.parameters[f"conductance_{side}"].low > 0.0 for side in (1, 2))
    for side in (1, 2):
        assert found.signals[f"spring.pressure_{side}"].after < 4e3
        assert found.free_run[f"spring.pressure_{side}"].after < 8e3


@pytest.mark.parametrize(("seal", "growth"), [("O-ring", 0.65), ("KDN", 0.20)])
def test_friction_of_seals(tables: Path, repository: Path, tmp_path: Path, seal: str, growth: float) -> None:
    """Published (Zillen): half the hysteresis is 3.9, 5.5, 6.9, 7.8 N and 5.6, 5.7, 6.2, 6.8 N at 1, 3, 5, 7 bar; `growth` in N a bar."""
    recordings = list((tables / "seals_friction").glob(f"{seal}_*.parquet"))
    found = found_in(recordings, repository / "assets" / "real" / "seals_friction" / "rig.toml", tmp_path)
    sliding = {"coulomb_friction", "viscous_friction"}
    assert len(recordings) == 4 and missing(found) & sliding and missing(found) <= {*sliding, "pressure_dependent_friction", "presliding"}
    (pressed,) = (finding for finding in found.effects if finding.name == "pressure_dependent_friction")
    assert 1e5 * pressed.parameters["coefficient"].value == pytest.approx(growth, rel=0.5)
    (signal,) = found.signals.values()
    assert signal.after < 0.2 * signal.before



def test_a_printed_cylinder_leaks_like_a_sponge(tables: Path, repository: Path, tmp_path: Path) -> None:
    rig = repository / "assets" / "real" / "pressure_decay" / "rig.toml"
    found = found_in([tables / "pressure_decay" / "Ultimaker_015.parquet"], rig, tmp_path)
    leak = next(finding for finding in found.effects if finding.name == "external_leakage")
    assert {"laminar_1", "inertial"} == set(leak.parameters)
    assert missing(found) <= {"external_leakage", "wall_heat_transfer", "moving_wall_temperature"}  # gas that expands is warmed
    assert not [finding for finding in found.effects if finding.kind == "sensor"]
    assert found.free_run["piston.pressure_1"].after < 0.01 * found.free_run["piston.pressure_1"].before


def test_the_control_is_tight(tables: Path, repository: Path, tmp_path: Path) -> None:
    rig = repository / "assets" / "real" / "pressure_decay" / "rig.toml"
    found = found_in([tables / "pressure_decay" / "Aluminium.parquet"], rig, tmp_path)
    assert found.verdict in ("consistent", "undetermined") and found.effects == ()
