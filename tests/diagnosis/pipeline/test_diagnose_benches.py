"""A diagnosis from end to end, on machines whose truth shares no equation with the simulator."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from exo_sim import rig as rigs
from exo_sim.diagnosis.pipeline.diagnose import diagnose
from exo_sim.errors import RecordingError
from exo_sim.recording import read
from exo_sim.simulation.replay import replay, rms
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions, LegConditions, Sensors
from exo_sim.trials.leg_cases import make_leg_case
from exo_sim.trials.oracle import oracle_rig

#: Effect, place, number, and seconds of recording that tell it.
PLANTED = [
    ("piston_leakage", "piston", "area", 12.0),
    ("wall_heat_transfer", "piston", "conductance", 24.0),
    ("valve_deadband", "piston", "width", 12.0),
    ("critical_ratio", "piston", "ratio", 12.0),
    ("viscous_friction", "piston", "coefficient", 12.0),
    ("pressure_dependent_friction", "piston", "coefficient", 12.0),
    ("end_cushioning", "piston", "length", 24.0),
    ("sensor_delay:position", "slide.position", "seconds", 24.0),
]


def case_folder(tmp_path: Path, effects: tuple[str, ...], seed: int = 11, seconds: float = 24.0) -> Path:
    write_case(make_case("case", effects, seed, 1.0, Conditions(known=(), duration=seconds)), tmp_path, "csv", open_truth=True)
    return next(path.parent for path in tmp_path.rglob("rig.toml"))


@pytest.mark.slow
@pytest.mark.parametrize(("effect", "where", "parameter", "seconds"), PLANTED, ids=[one[0] for one in PLANTED])
def test_it_and_nothing_else_is_named(tmp_path: Path, effect: str, where: str, parameter: str, seconds: float) -> None:
    folder = case_folder(tmp_path, (effect,), seconds=seconds)
    found = diagnose(sorted(folder.glob("recording*.csv")), folder / "rig.toml", folder=folder)
    truth = json.loads((folder / "truth.json").read_text())["hidden"][0]["parameters"][parameter]["value"]
    named = [finding for finding in found.effects if finding.kind != "calibration"]
    assert [(finding.name, finding.where) for finding in named] == [(effect.split(":")[0], where)]
    assert named[0].parameters[parameter].value == pytest.approx(truth, rel=0.05)
    assert found.verdict == "mismatch"
    assert found.exit_status == 3
    assert named[0].held_out_error_drop > 0.3
    (folder / "improved.toml").write_text(found.improved)
    again = diagnose(sorted(folder.glob("recording*.csv")), folder / "improved.toml", folder=folder)
    assert not [finding for finding in again.effects if finding.kind != "calibration"]


@pytest.mark.slow
@pytest.mark.parametrize("friction", ["viscous_friction", "coulomb_friction"])
def test_a_soft_transmission_and_the_friction_behind_it_are_distinguished(tmp_path: Path, friction: str) -> None:
    """Friction holds the piston back against the mount, so the chambers' volumes hang on both."""
    folder = case_folder(tmp_path, ("transmission_compliance", friction))
    found = diagnose(sorted(folder.glob("recording*.csv")), folder / "rig.toml", folder=folder)
    hidden = {one["name"]: one["parameters"] for one in json.loads((folder / "truth.json").read_text())["hidden"]}
    named = {one.name: one.parameters for one in found.effects if one.kind != "calibration"}
    assert named.keys() == hidden.keys()
    stiffness = hidden["transmission_compliance"]["stiffness"]["value"]
    assert named["transmission_compliance"]["stiffness"].value == pytest.approx(stiffness, rel=0.06)


@pytest.mark.slow
def test_a_rig_that_knows_its_hose_needs_nothing_more(tmp_path: Path) -> None:
    """What the hose keeps from the sensor is put right before forces are judged, whoever knew of it."""
    folder = case_folder(tmp_path, ("line_restriction:valve_end", "viscous_friction"))
    hidden = json.loads((folder / "truth.json").read_text())["hidden"]
    (folder / "oracle.toml").write_text(oracle_rig((folder / "rig.toml").read_text(), hidden))
    found = diagnose(sorted(folder.glob("recording*.csv")), folder / "oracle.toml", folder=folder)
    assert found.verdict in ("consistent", "calibration")


@pytest.mark.slow
def test_nothing_hidden_names_nothing(tmp_path: Path) -> None:
    folder = case_folder(tmp_path, ())
    found = diagnose(sorted(folder.glob("recording*.csv")), folder / "rig.toml", folder=folder)
    assert [finding for finding in found.effects if finding.kind != "calibration"] == []
    assert found.verdict in ("consistent", "calibration")
    assert found.exit_status == 0


@pytest.mark.slow
def test_a_wrong_number_of_an_effect_that_the_rig_has_is_a_believed_number(tmp_path: Path) -> None:
    known = ("wall_heat_transfer", "coulomb_friction", "viscous_friction")
    write_case(make_case("case", effects=(), seed=11, conditions=Conditions(known=known)), tmp_path, "csv")
    rig = tmp_path / "rig.toml"
    text = rig.read_text()
    true = {name: float(re.search(rf'{name} *= "([\d.e+-]+)', text)[1]) for name in ("conductance", "force")}  # type: ignore[index]
    for name, factor in (("conductance", 1.6), ("force", 0.6)):
        text = re.sub(rf'({name} *= ")[\d.e+-]+', rf"\g<1>{factor * true[name]}", text)
    rig.write_text(text)
    found = diagnose([tmp_path / "recording.csv"], rig, folder=tmp_path)
    assert found.verdict == "calibration" and found.exit_status == 0
    numbers = {name: estimate for finding in found.effects for name, estimate in finding.parameters.items()}
    for name, value in true.items():
        assert numbers[name].value == pytest.approx(value, rel=0.05)
    (tmp_path / "improved.toml").write_text(found.improved)
    again = diagnose([tmp_path / "recording.csv"], tmp_path / "improved.toml", folder=tmp_path)
    assert not {"wall_heat_transfer", "coulomb_friction"} & {finding.name for finding in again.effects}


@pytest.mark.slow
def test_damping_believed_too_large_is_a_believed_number(tmp_path: Path) -> None:
    folder = case_folder(tmp_path, ())
    model = folder / "bench.xml"
    text = model.read_text()
    (damping,) = re.findall(r'damping="([\d.e+-]+)"', text)
    model.write_text(text.replace(f'damping="{damping}"', f'damping="{1.5 * float(damping)}"'))
    found = diagnose(sorted(folder.glob("recording*.csv")), folder / "rig.toml", folder=folder)
    assert [finding for finding in found.effects if finding.kind != "calibration"] == []
    (factor,) = [f.parameters["factor"].value for f in found.effects if f.name == "joint_damping"]
    assert factor == pytest.approx(1.0 / 1.5, rel=0.05)
    (folder / "improved.toml").write_text(found.improved)
    again = diagnose(sorted(folder.glob("recording*.csv")), folder / "improved.toml", folder=folder)
    assert "joint_damping" not in {finding.name for finding in again.effects}


@pytest.mark.slow
def test_too_much_damping_behind_a_soft_contact_is_not_friction_that_falls_with_speed(tmp_path: Path) -> None:
    known = ("coulomb_friction",)
    write_case(make_case("case", effects=("presliding",), seed=11, size=1.0, conditions=Conditions(known=known)), tmp_path, "csv")
    model = tmp_path / "bench.xml"
    model.write_text(re.sub(r'damping="([\d.e+-]+)"', lambda found: f'damping="{1.2 * float(found[1])}"', model.read_text()))
    rig = tmp_path / "rig.toml"
    rig.write_text(re.sub(r'(force *= ")([\d.e+-]+)', lambda found: f"{found[1]}{0.8 * float(found[2])}", rig.read_text()))
    found = diagnose(sorted(tmp_path.glob("recording*.csv")), rig, folder=tmp_path)
    assert [finding.name for finding in found.effects if finding.kind != "calibration"] == ["presliding"]


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.75, 1.3])
def test_a_payload_far_from_the_one_believed_is_a_believed_number(tmp_path: Path, factor: float) -> None:
    """An upright axis: its weight is missed all the time, as something that acts in one long stretch would be."""
    under = Conditions(known=(), duration=12.0)
    case = next(c for c in (make_case("case", (), seed, conditions=under) for seed in range(40)) if c.bench.upright)
    write_case(replace(case, believed=replace(case.believed, mass=case.believed.mass / factor)), tmp_path, "csv", open_truth=True)
    found = diagnose(sorted(tmp_path.glob("recording*.csv")), tmp_path / "rig.toml", folder=tmp_path)
    numbers = {finding.name: finding for finding in found.effects}
    assert all(finding.kind == "calibration" for finding in found.effects)
    true = case.machine["load_mass"] / (case.believed.mass / factor)
    assert numbers["payload_mass"].parameters["factor"].value == pytest.approx(true, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("effect", "parameter"), [("quadratic_drag", "coefficient"), ("coulomb_friction", "force")])
def test_damping_believed_too_large_does_not_bend_what_was_found(tmp_path: Path, effect: str, parameter: str) -> None:
    case = make_case("case", (effect,), 11, 0.5, Conditions(known=(), duration=12.0))
    write_case(replace(case, believed=replace(case.believed, damping=1.35 * case.believed.damping)), tmp_path, "csv", open_truth=True)
    found = diagnose(sorted(tmp_path.glob("recording*.csv")), tmp_path / "rig.toml", folder=tmp_path)
    (named,) = [finding for finding in found.effects if finding.kind != "calibration"]
    (hidden,) = case.hidden
    assert named.name == effect
    assert named.parameters[parameter].value == pytest.approx(hidden.parameters[parameter], rel=0.05)
    (damping,) = [finding for finding in found.effects if finding.name == "joint_damping"]
    assert damping.parameters["factor"].value == pytest.approx(1.0 / 1.35, rel=0.05)


@pytest.mark.slow
def test_parts_of_a_lag_that_are_not_distinguished_are_inside_the_interval(tmp_path: Path) -> None:
    """On a walking leg the command is smooth: dead time and time constant do the same.

    So does a logger whose sensors all come later than its commands, by at most a sample: the sum of all three is what is known.
    """
    case = make_leg_case("case", ("valve_lag:delay",), 1430767612, 0.97, LegConditions(duration=12.0))
    write_case(case, tmp_path, "parquet", open_truth=True)
    found = diagnose([tmp_path / "recording.parquet"], tmp_path / "rig.toml", folder=tmp_path)
    (named,) = [finding for finding in found.effects if finding.kind != "calibration"]
    (hidden,) = case.hidden
    assert named.name == "valve_lag"
    for name, estimate in named.parameters.items():
        assert estimate.low <= hidden.parameters[name] <= estimate.high
    (tmp_path / "improved.toml").write_text(found.improved)
    effects = rigs.read(tmp_path / "improved.toml").effects
    late = {one.where: one.parameters["seconds"] for one in effects if one.name == "sensor_delay"}
    behind = late.get("knee_r.pressure_1", 0.0)
    assert behind <= 2.6e-3 and behind == pytest.approx(late.get("knee_r.position", 0.0), abs=1e-4)
    setting = next(one for one in effects if one.name == "valve_lag")
    lag = sum(setting.parameters.values()) + behind
    assert lag == pytest.approx(sum(hidden.parameters.values()), rel=0.02)


@pytest.mark.slow
def test_a_tank_that_keeps_its_temperature_is_a_regulator_without_hysteresis(tmp_path: Path) -> None:
    """The truth's tank is isothermal, ours adiabatic: where that shows, the regulator fits better and the tank stands beside it."""
    under = Conditions(duration=12.0, rate=500.0, sensors=Sensors(pressure_noise=400.0, bits=14))
    case = make_case("case", ("supply_droop",), 2035664264, 0.9645, under)
    write_case(case, tmp_path, "parquet", open_truth=True)
    found = diagnose([tmp_path / "recording.parquet"], tmp_path / "rig.toml", folder=tmp_path)
    (named,) = [finding for finding in found.effects if finding.kind != "calibration"]
    assert (named.name, named.ambiguous_with) == ("supply_regulator", ("supply_droop",))
    assert "supply_droop" not in {one.name for one in found.rejected}


@pytest.mark.slow
def test_friction_that_fades_while_it_is_recorded_is_not_taken_for_healthy(tmp_path: Path) -> None:
    case = make_case("case", ("warming_grease",), 1070968357, 1.0, Conditions(duration=12.0))
    write_case(case, tmp_path, "parquet", open_truth=True)
    found = diagnose([tmp_path / "recording.parquet"], tmp_path / "rig.toml", folder=tmp_path)
    assert found.verdict == "mismatch"
    assert [finding.name for finding in found.effects if finding.kind != "calibration"] == ["unknown"]


@pytest.mark.slow
@pytest.mark.parametrize("effects", [(), ("valve_deadband",)], ids=["nothing", "dead band"])
def test_the_improved_rig_predicts_as_well_as_was_reported(tmp_path: Path, effects: tuple[str, ...]) -> None:
    """Also with numbers that are off by less than is worth a finding: what was refitted is in the file."""
    folder = case_folder(tmp_path, effects)
    text = (folder / "rig.toml").read_text()
    for key, factor in (("area", 1.008), ("dead_volume_1", 0.98), ("dead_volume_2", 1.02)):
        found = re.search(rf'(?m)^{key} *= "([\d.e+-]+)', text)
        assert found
        text = text.replace(found[0], f'{found[0][: found.start(1) - found.start()]}{factor * float(found[1]):.6g}', 1)
    (folder / "rig.toml").write_text(text)
    files = sorted(folder.glob("recording*.csv"))
    answer = diagnose(files, folder / "rig.toml", folder=folder)
    (folder / "improved.toml").write_text(answer.improved)
    missed = {}
    for name in ("rig.toml", "improved.toml"):
        measured = read(files[-1]).recording
        predicted = replay(measured, rigs.read(folder / name), motion="recorded").windowed
        missed[name] = {key: rms(measured[key], predicted[key]) for key in answer.signals if key in predicted}
    for key, error in missed["improved.toml"].items():
        assert error < 1.2 * answer.signals[key].after
        assert error < 0.5 * missed["rig.toml"][key]
    assert missed["improved.toml"]


@pytest.mark.slow
def test_the_answer_does_not_depend_on_the_threads(tmp_path: Path) -> None:
    folder = case_folder(tmp_path, ("external_leakage",))
    files = sorted(folder.glob("recording*.csv"))
    one, two = (diagnose(files, folder / "rig.toml", folder=folder, jobs=jobs) for jobs in (1, 2))
    assert one.as_dict() == two.as_dict() and one.improved == two.improved


def test_columns_of_another_machine_are_refused(tmp_path: Path) -> None:
    folder = case_folder(tmp_path, ())
    table = tmp_path / "other.csv"
    rows = "\n".join(f"{0.001 * i},{1e5 + i}" for i in range(50))
    table.write_text("time [s],plunger.pressure_1 [Pa]\n" + rows + "\n")
    with pytest.raises(RecordingError, match="plunger"):
        diagnose([table], folder / "rig.toml")
