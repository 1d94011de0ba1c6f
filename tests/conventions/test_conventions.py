"""A recording in other conventions is asked about, put right and named; healthy ones and real ones pass without a word.

The recordings come from the trials' own truth, which shares no equation with what holds them against their rigs.
"""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.cli import main
from exo_sim.conventions import Settled, asked, findings, pressures, settle
from exo_sim.conventions.machine import Machine
from exo_sim.conventions.pressures import _counts_from, in_pascal
from exo_sim.errors import RecordingError
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording, read, write_table
from exo_sim.rig import Rig
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions, LegConditions
from exo_sim.trials.leg_cases import make_leg_case

ATMOSPHERE = 101325.0
PSI = 6894.757293168361
#: What is left out of the machines; no convention may be blamed for it.
BENCHES = ("", "piston_leakage", "coulomb_friction", "valve_lag", "sensor_bias")
LEGS = ("external_leakage",)


@pytest.fixture(scope="module")
def machines(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("cases")
    for number, effect in enumerate(BENCHES):
        bench = make_case(f"bench_{effect}", [effect] if effect else [], 31 + 7 * number, 1.0, Conditions(duration=12.0))
        write_case(bench, folder / bench.name)
    for number, effect in enumerate(LEGS):
        case = make_leg_case(f"leg_{effect}", [effect] if effect else [], 77 + 7 * number, 1.0, LegConditions(duration=8.0))
        write_case(case, folder / case.name)
    return {path.name: path for path in folder.iterdir()}


def recorded(folder: Path) -> tuple[Recording, Rig]:
    (path, *_) = sorted(folder.glob("recording*"))
    return read(path).recording, rigs.read(folder / "rig.toml")


def held(recording: Recording, rig: Rig) -> Settled:
    return asked(recording, rig, load(rig))


def changed(recording: Recording, pattern: str, factor: float = 1.0, offset: float = 0.0) -> Recording:
    columns = {key: factor * (v + offset) if re.search(pattern, key) else v for key, v in recording.columns.items()}
    return replace(recording, columns=columns)


def swapped(recording: Recording) -> Recording:
    turn = {"pressure_1": "pressure_2", "pressure_2": "pressure_1"}
    names = {key: ".".join([key.split(".")[0], turn.get(key.split(".")[1], key.split(".")[1])]) for key in recording.columns}
    return replace(recording, columns={key: recording.columns[names[key]] for key in recording.columns})


PRESSURES = r"\.pressure"
#: What is done to a recording: how, the question that must be asked, and of which machines.
OTHERWISE: dict[str, tuple[Callable[[Recording], Recording], str, str]] = {
    "gauge": (lambda r: changed(r, PRESSURES, offset=-ATMOSPHERE), "gauge", ""),
    "gauge chambers": (lambda r: changed(r, r"\.pressure_", offset=-ATMOSPHERE), "gauge", ""),
    "bar": (lambda r: changed(r, PRESSURES, 1e-5), "unit", ""),
    "bar gauge": (lambda r: changed(r, PRESSURES, 1e-5, -ATMOSPHERE), "gauge", ""),
    "psi gauge": (lambda r: changed(r, PRESSURES, 1.0 / PSI, -ATMOSPHERE), "gauge", ""),
    "kPa": (lambda r: changed(r, PRESSURES, 1e-3), "unit", ""),
    "MPa": (lambda r: changed(r, PRESSURES, 1e-6), "unit", ""),
    "Pa under the heading of bar": (lambda r: changed(r, PRESSURES, 1e5), "unit", ""),
    "seconds under the heading of ms": (lambda r: replace(r, time=1e-3 * r.time), "unit", "bench"),
    "milliseconds": (lambda r: replace(r, time=1e3 * r.time), "unit", ""),
    "degrees": (lambda r: changed(r, r"\.(position|velocity)", 180.0 / math.pi), "unit", "leg"),
    "degrees, rates in radian": (lambda r: changed(r, r"\.position", 180.0 / math.pi), "unit", "leg"),
    "mm": (lambda r: changed(r, r"\.(position|velocity)", 1e3), "unit", "bench"),
    "inches": (lambda r: changed(r, r"\.(position|velocity)", 1.0 / 0.0254), "unit", "bench"),
    "metres under the heading of mm": (lambda r: changed(r, r"\.(position|velocity)", 1e-3), "unit", "bench"),
    "swapped chambers": (swapped, "swapped chambers", ""),
    "turned valve": (lambda r: changed(r, "valve_command", -1.0), "turned valve", ""),
}


def test_a_machine_as_it_should_be_is_asked_nothing(machines: dict[str, Path]) -> None:
    for name, folder in machines.items():
        recording, rig = recorded(folder)
        settled = held(recording, rig)
        assert settled.checks == (), name
        assert settled.recording is recording


def test_one_sensor_that_counts_from_the_atmosphere_is_asked_about_and_left(machines: dict[str, Path]) -> None:
    recording, rig = recorded(next(folder for name, folder in machines.items() if name.startswith("bench")))
    settled = held(changed(recording, "pressure_1", offset=-ATMOSPHERE), rig)
    found = [finding for finding in findings(settled) if finding.kind == "gauge"]
    assert [finding.use for finding in found] == ["used"] and "left as it is" in found[0].says
    assert all((settled.recording[key] == recording[key] - ATMOSPHERE).all() for key in recording.columns if key.endswith("pressure_1"))


@pytest.mark.parametrize("otherwise", OTHERWISE)
def test_another_convention_is_asked_about_and_put_right(machines: dict[str, Path], otherwise: str) -> None:
    how, what, kind = OTHERWISE[otherwise]
    missed = []
    for name, folder in machines.items():
        if not name.startswith(kind):
            continue
        recording, rig = recorded(folder)
        settled = held(how(recording), rig)
        if not settled.checks:
            missed.append(name)
            continue
        assert what in [check.what for check in settled.checks], name
        assert np.allclose(settled.recording.time, recording.time, rtol=1e-12), name
        for key, values in recording.columns.items():
            found = settled.recording[key]
            assert np.allclose(found, values, rtol=1e-9, atol=1e-3 if "pressure" in key else 1e-12, equal_nan=True), (name, key)
        for check in settled.checks:
            assert set(check.columns) <= {"time", *recording.columns} and "?" in check.says and not check.refused
            assert all(column in check.says for column in check.columns[:1])
            assert check.as_dict() == {"what": check.what, "columns": list(check.columns), "says": check.says}
    # chambers that never vent, beside a supply that is absolute, show it only in the shape of their flow
    assert len(missed) <= (otherwise == "gauge chambers")


def test_a_chamber_that_only_passes_the_atmosphere_does_not_rest_there() -> None:
    """A gauge column whose least is the atmosphere by chance is recognised by its gas balance; one that stays there for long is not."""
    machine, time = cast(Machine, SimpleNamespace(atmosphere=ATMOSPHERE)), np.arange(400, dtype=np.float64) * 1e-3
    passes = np.asarray(1.07 * ATMOSPHERE + 4e5 * (1.0 - np.cos(12.0 * time)), dtype=np.float64)
    stays = np.where(time < 0.15, ATMOSPHERE, passes)
    assert _counts_from(passes, time, machine, "gauge") == "gauge"
    assert _counts_from(stays, time, machine, "gauge") == "absolute"
    assert _counts_from(passes, time, machine, "") == _counts_from(passes, time, machine, "absolute") == "absolute"


@pytest.mark.parametrize(("offset", "gauge"), [(0.0, False), (-ATMOSPHERE, True)])
def test_a_supply_that_sags_by_an_atmosphere_is_not_gauge(offset: float, gauge: bool) -> None:
    machine = cast(Machine, SimpleNamespace(atmosphere=ATMOSPHERE, supply=7e5))
    time = np.arange(2000, dtype=np.float64) * 1e-3
    sagging = 7e5 - 1.05e5 * np.clip(2.0 * np.sin(3.0 * time), 0.0, 1.0) + offset
    table = Recording("sags", time, {"supply.pressure": np.asarray(sagging, dtype=np.float64)}, {"supply.pressure": "Pa"})
    assert pressures._shared(table, machine) == (("supply.pressure",) if gauge else ())


def test_one_gauge_sensor_among_absolute_ones_is_asked_about_and_left_to_the_diagnosis(machines: dict[str, Path]) -> None:
    recording, rig = recorded(machines["bench_"])
    odd = changed(recording, r"\.pressure_1", offset=-ATMOSPHERE)
    settled = held(odd, rig)
    assert [(check.what, check.columns) for check in settled.checks] == [("gauge", ("piston.pressure_1",))]
    assert settled.recording is odd


def test_bar_is_recognised_where_a_stopped_load_compresses_far_above_the_supply(machines: dict[str, Path]) -> None:
    recording, rig = recorded(machines["bench_"])
    key = "piston.pressure_1"
    peaks = np.where(recording[key] > np.quantile(recording[key], 0.98), 1.8 * rig.supply.pressure, recording[key])
    compressed = replace(recording, columns={**recording.columns, key: peaks})
    (check,) = in_pascal(changed(compressed, PRESSURES, 1e-5), Machine.of(rig, load(rig)))[1]
    assert check.what == "unit" and "Taken as bar: multiplied by 100000" in check.says


def with_rig(folder: Path, tmp_path: Path, old: str, new: str, model: str = "", instead: str = "") -> Rig:
    """Return a rig with something in it, or in its MJCF, written otherwise."""
    for path in [*folder.glob("*.toml"), *folder.glob("*.xml")]:
        text = path.read_text()
        text = re.sub(old, new, text) if path.suffix == ".toml" and old else text
        (tmp_path / path.name).write_text(re.sub(model, instead, text) if path.suffix == ".xml" and model else text)
    return rigs.read(tmp_path / "rig.toml")


@pytest.mark.parametrize("retracted", ['"2 m"', '"-1 m"', '"0.9 m"'])
def test_a_piston_outside_its_stroke_is_refused_and_says_what_would_fit(machines: dict[str, Path], tmp_path: Path, retracted: str) -> None:
    for name in ("bench_", "leg_external_leakage"):
        recording, true = recorded(machines[name])
        rig = with_rig(machines[name], tmp_path, r"retracted_length\s*=.*", f"retracted_length = {retracted}")
        with pytest.raises(RecordingError, match="outside its stroke") as caught:
            settle(recording, rig, load(rig))
        found = re.search(r"correct retracted_length in .*: from (\S+) to (\S+) mm would fit", str(caught.value))
        assert found is not None and "\n" not in str(caught.value)
        low, high = (float(number) for number in found.groups())
        assert any(low - 1.0 < 1e3 * one.retracted_length < high + 1.0 for one in true.cylinders.values())


def test_a_stroke_that_is_short_by_ten_is_not_taken_for_another_unit(machines: dict[str, Path], tmp_path: Path) -> None:
    recording, true = recorded(machines["bench_"])
    cylinder = true.cylinders["piston"]
    numbers = f'stroke = "{0.1 * cylinder.stroke!r} m"\nretracted_length = "0 m"'
    rig = with_rig(machines["bench_"], tmp_path, r"(?s)stroke\s*=.*?retracted_length\s*=[^\n]*", numbers)
    from_zero = changed(recording, r"slide\.position", offset=-cylinder.retracted_length)
    says = "stroke in cylinders.piston of .* is too short, or the column is in .*inches"
    with pytest.raises(RecordingError, match=says) as caught:
        settle(from_zero, rig, load(rig))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("key", "factor"), [("bore", 10.0), ("area", 100.0)])
def test_a_size_that_is_off_by_its_unit_changes_no_clock(machines: dict[str, Path], tmp_path: Path, key: str, factor: float) -> None:
    """A bore in cm that was mm, an area in cm^2 that was mm^2: pressures follow as if time were in minutes or milliseconds."""
    recording, true = recorded(machines["bench_"])
    cylinder = true.cylinders["piston"]
    number = f"{factor * cylinder.bore!r} m" if key == "bore" else f"{factor * cylinder.valve_area!r} m^2"
    rig = with_rig(machines["bench_"], tmp_path, rf"\n{key}\s*=.*", f'\n{key} = "{number}"')
    with pytest.raises(RecordingError, match=r"bore, dead volumes or valve area in cylinders\.piston of .*Correct one of them") as caught:
        settle(recording, rig, load(rig))
    assert '"time"' in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("gear", ["-3", "-1", "0.2", "5", "1000"])
def test_a_gear_that_is_none_of_the_machines_is_refused_by_name(machines: dict[str, Path], tmp_path: Path, gear: str) -> None:
    recording, _ = recorded(machines["bench_"])
    rig = with_rig(machines["bench_"], tmp_path, "", "", r'<motor name="piston"', f'<motor gear="{gear}" name="piston"')
    with pytest.raises(RecordingError, match=f'gear="{gear}".*with gear="1" it does|from the other end'):
        settle(recording, rig, load(rig))


def test_a_position_from_the_other_end_is_refused(machines: dict[str, Path]) -> None:
    recording, rig = recorded(machines["bench_"])
    (link,) = linkages(rig, load(rig))
    cylinder = rig.cylinders["piston"]
    key = f"{link.joint}.position"
    there = cylinder.stroke + 2.0 * cylinder.retracted_length - recording[key]
    with pytest.raises(RecordingError, match="from the other end"):
        settle(replace(recording, columns={**recording.columns, key: there}), rig, load(rig))


def test_degrees_at_a_joint_that_no_cylinder_drives(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(
        '<mujoco><compiler angle="radian"/><worldbody><body><joint name="elbow" type="hinge" axis="0 1 0" range="-1.5 1.5" limited="true"/>'
        '<geom size="0.1" mass="1"/></body></worldbody></mujoco>'
    )
    (tmp_path / "rig.toml").write_text('model = "arm.xml"\n')
    rig = rigs.read(tmp_path / "rig.toml")
    time = np.arange(500) / 100.0
    angle = 1.2 * np.sin(time)
    for factor, checks in ((1.0, 0), (180.0 / math.pi, 1)):
        settled = held(Recording("r", time, {"elbow.position": factor * angle}, {"elbow.position": "rad"}), rig)
        assert len(settled.checks) == checks
        assert np.allclose(settled.recording["elbow.position"], angle)


def test_inspect_compare_and_diagnose_say_it(machines: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording, _ = recorded(machines["bench_"])
    rig = str(machines["bench_"] / "rig.toml")
    write_table(tmp_path / "gauge.csv", changed(recording, PRESSURES, offset=-ATMOSPHERE))
    write_table(tmp_path / "absolute.csv", recording)
    assert main(["inspect", str(tmp_path / "gauge.csv"), "--rig", rig, "--json"]) == 0
    assert "gauge" in [finding["kind"] for finding in json.loads(capsys.readouterr().out)["findings"]]
    errors = {}
    for name in ("gauge", "absolute"):
        given = [str(tmp_path / f"{name}.csv"), "--rig", rig, "--json", "--out", str(tmp_path / f"{name}.rrd")]
        assert main(["compare", *given]) == 0
        said = json.loads(capsys.readouterr().out)
        errors[name] = {key: one["windowed_rms"] for key, one in said["signal"].items()}
        assert [check["what"] for check in said["checks"]] == (["gauge"] if name == "gauge" else [])
    assert errors["gauge"] == pytest.approx(errors["absolute"], rel=1e-6)
    status = main(["diagnose", str(tmp_path / "gauge.csv"), "--rig", rig, "--json", "--out", str(tmp_path / "found")])
    capsys.readouterr()
    found = json.loads((tmp_path / "found" / "diagnosis.json").read_text())
    assert [check["what"] for check in found["checks"]] == ["gauge"]
    assert not [effect for effect in found["effects"] if effect["kind"] == "sensor"] and status == 0


@pytest.mark.parametrize("verb", ["compare", "diagnose"])
def test_what_cannot_be_computed_is_one_line_and_status_2(
    machines: dict[str, Path], tmp_path: Path, verb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = machines["bench_"]
    with_rig(folder, tmp_path, r"retracted_length\s*=.*", 'retracted_length = "900 mm"')
    (path,) = folder.glob("recording*")
    assert main([verb, str(path), "--rig", str(tmp_path / "rig.toml"), "--out", str(tmp_path / "x.rrd")]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1 and "would fit" in said.err
    assert main(["inspect", str(path), "--rig", str(tmp_path / "rig.toml")]) == 0
    assert "would fit" in capsys.readouterr().out


@pytest.mark.real_data
def test_recordings_of_real_machines_are_asked_nothing(shared_data: Path, repository: Path, tmp_path: Path) -> None:
    subprocess.run(
        [sys.executable, str(repository / "scripts" / "real_recordings"), str(tmp_path), str(shared_data)], check=True, capture_output=True
    )
    cases = [(folder, repository / "assets" / "real" / folder.name / "rig.toml") for folder in tmp_path.iterdir()]
    cases += [(folder, folder / "rig.toml") for folder in (shared_data / "unkind").iterdir() if folder.is_dir()]
    count = 0
    for folder, path in cases:
        rig = rigs.read(path)
        for table in sorted([*folder.glob("*.parquet"), *folder.glob("*.csv")]):
            assert held(read(table).recording, rig).checks == (), table
            count += 1
    assert count > 20


@pytest.mark.parametrize(
    ("misfits", "supply_is_gauge", "told"),
    [
        ((1.78, 1.023, 1.0, 1.081, 1.235), False, False),  # a single-acting cylinder whose rig knows a hose and a lag
        ((2.69, 2.26, 1.15, 1.0, 1.13), False, True),  # such a one whose column is gauge
        ((1.66, 1.36, 1.17, 1.0, 1.56), False, False),
        ((1.66, 1.36, 1.17, 1.0, 1.56), True, True),
        ((2.04, 1.55, 1.21, 1.02, 1.0), False, False),  # a single-acting cylinder that leaks while its valve is hardly open, absolute
        ((2.04, 1.55, 1.21, 1.0, 1.03), False, True),
    ],
)
def test_a_balance_that_holds_as_well_as_recorded_calls_no_column_gauge(
    monkeypatch: pytest.MonkeyPatch, misfits: tuple[float, ...], supply_is_gauge: bool, told: bool
) -> None:
    monkeypatch.setattr(pressures, "_misfits", lambda *_, **__: {"ram.pressure_1": np.array(misfits)})
    assert bool(pressures._zeros(cast(Recording, None), cast(Machine, None), supply_is_gauge)) is told


@pytest.mark.parametrize(
    ("misfits", "told"),
    [
        ([(1.26, 1.125, 1.03, 1.0, 1.19), (1.763, 1.49, 1.208, 1.0, 1.219)], True),  # a cart whose chambers were written gauge
        ([(1.03, 1.0, 1.19, 1.787, 3.3), (1.208, 1.0, 1.219, 3.911, 6.951)], False),  # the same, absolute
        ([(4.63, 1.0, 1.9, 3.64, 7.5), (17.87, 15.77, 12.1, 1.0, 19.97)], False),  # one gauge sensor beside an absolute one
        ([(1.763, 1.49, 1.208, 1.0, 1.219)], False),  # one chamber alone is not enough
    ],
)
def test_chambers_that_never_vent_tell_together_that_they_are_gauge(
    monkeypatch: pytest.MonkeyPatch, misfits: list[tuple[float, ...]], told: bool
) -> None:
    of_chambers = {f"ram.pressure_{side + 1}": np.array(each) for side, each in enumerate(misfits)}
    monkeypatch.setattr(pressures, "_misfits", lambda *_, **__: of_chambers)
    assert pressures._together_gauge(cast(Recording, None), cast(Machine, None)) is told
