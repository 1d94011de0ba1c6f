"""Cases of whole machines: what is written, that chance is the seed's, and that their numbers mean what the contract says."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import TrialError
from exo_sim.machine.rig_model import load
from exo_sim.recording import read
from exo_sim.trials.whole_machines import case as cases
from exo_sim.trials.whole_machines.__main__ import main
from exo_sim.trials.whole_machines.case import make_case, truth_of, write_case
from exo_sim.trials.whole_machines.draw import build, choose
from exo_sim.trials.whole_machines.hidden_effects import BLOCKS, OUTSIDE, SEAL
from exo_sim.trials.whole_machines.instruments import Channel, filtered, shown
from exo_sim.trials.whole_machines.machine_run import drive
from exo_sim.trials.whole_machines.makes import MAKES
from exo_sim.trials.whole_machines.materiality import matters


@pytest.fixture(scope="module")
def lever():
    return make_case("lever", "D", seed=3, duration=6.0)


def test_the_same_seed_gives_the_same_bytes(tmp_path, lever):
    write_case(lever, tmp_path / "one")
    write_case(make_case("lever", "D", seed=3, duration=6.0), tmp_path / "two")
    for file in ("rig.toml", "bench.xml", "recording.csv", "truth/truth.json", "truth/fresh.csv", "truth/nearest.toml"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_what_is_handed_over_is_read_by_the_contract(tmp_path, lever):
    write_case(lever, tmp_path)
    recording = read(tmp_path / "recording.csv", None).recording
    assert {"muscle.valve_command", "muscle.pressure_1", "muscle.pressure_2", "elbow.position"} <= set(recording.columns)
    for file in ("rig.toml", "truth/nearest.toml"):
        machine = rigs.read(tmp_path / file)
        assert load(machine).nu == 1
    handed = (tmp_path / "rig.toml").read_text()
    for entry in truth_of(lever)["hidden"]:
        assert f"effects.{entry['name']}." not in handed


def test_whole_machines_hide_five_to_eight_and_the_seal_always():
    for make in MAKES.values():
        for seed in range(30):
            hidden, known = choose(make, "whole", np.random.default_rng(seed))
            assert 5 <= len(hidden) <= 8 and set(SEAL) <= set(hidden) and not set(hidden) & set(known)


def test_who_does_not_know_that_a_wall_takes_heat_does_not_know_that_it_warms():
    make = next(make for make in MAKES.values() if "wall" in make.optional)
    drawn = [choose(make, "whole", np.random.default_rng(seed)) for seed in range(200)]
    assert all("heat" in known for _, known in drawn if "wall" in known)
    assert all("heat" in (*hidden, *known) for hidden, known in drawn if "wall" in hidden)
    assert any("heat" in hidden and "wall" in hidden for hidden, _ in drawn) and any("wall" in known for _, known in drawn)


def test_other_cells_hide_one_or_nothing():
    rng = np.random.default_rng(1)
    for make in MAKES.values():
        hidden, known = choose(make, "nothing", rng)
        assert not hidden and set(SEAL) <= set(known)
        assert len(choose(make, "single", rng)[0]) == 1
        assert set(choose(make, "outside", rng)[0]) <= set(OUTSIDE)


def test_no_two_makes_share_their_laws():
    assert len({make.laws for make in MAKES.values()}) == len(MAKES)
    learnt, reported = (
        {(m.programs, m.laws.contact, m.laws.flow, m.laws.heat, m.grade.bits) for m in MAKES.values() if m.reported is r} for r in (0, 1)
    )
    assert not learnt & reported


def test_every_block_says_what_takes_it_away():
    rng = np.random.default_rng(2)
    for key, block in BLOCKS.items():
        built = build(MAKES["A"], "single", rng, [key])
        assert any(built.machine[name] != built.machine.without(*block.off)[name] for name in block.off), key


def test_what_is_hardly_there_does_not_matter(lever):
    built = replace(lever.built, machine=lever.built.machine.with_(null_area=1e-15))
    truth = drive(built, ("tracking",), 5.0, np.random.default_rng(0))
    found = matters(built, truth, lever.rack, lever.columns, ("null", "viscous"))
    assert found["null"]["worst"] < 1e-2 and found["viscous"]["worst"] > 1.0


def test_a_card_filters_and_is_late():
    rng = np.random.default_rng(0)
    channel = Channel(noise=0.0, step=1.0, cutoff=100.0, order=2, delay=1e-3, low=0.0, high=1e6)
    ramp = np.arange(2000.0)
    seen = filtered(ramp, channel, 2000.0)
    assert (ramp - seen)[1000:].mean() / 2000.0 == pytest.approx(channel.late, abs=3e-5)
    assert np.all(shown(ramp, channel, rng) == np.round(ramp))


def test_a_butterworth_is_late_by_what_it_says():
    channel = Channel(cutoff=100.0, order=4, shape="butterworth")
    ramp = np.arange(2000.0)
    assert (ramp - filtered(ramp, channel, 2000.0))[1000:].mean() / 2000.0 == pytest.approx(channel.late, abs=5e-5)
    assert channel.plain()["cutoff"] == 100.0


def test_a_line_loses_samples_and_keeps_their_times():
    one = make_case("x", "P", seed=5, duration=6.0, weigh=False)
    (table,) = one.recordings
    steps = np.diff(table["time [s]"])
    n = round(6.0 * MAKES["P"].rate)
    assert n - 0.01 * n < len(steps) + 1 < n
    assert len({len(values) for values in table.values()}) == 1
    assert 1.7 < steps.max() * MAKES["P"].rate < 3.5 and steps.min() > 0


def test_bad_wishes_are_named(capsys, tmp_path):
    with pytest.raises(TrialError, match='no make "Z"'):
        make_case("x", "Z")
    with pytest.raises(TrialError, match='no effect "stribek"'):
        make_case("x", "A", effects=["stribek"])
    with pytest.raises(SystemExit) as stop:
        main(["run", str(tmp_path), "--out", str(tmp_path)])
    assert stop.value.code == 2 and "holds no case" in capsys.readouterr().err


def test_machines_that_cannot_be_moved_are_drawn_anew(monkeypatch):
    def never(*_):
        raise TrialError("did not move")

    monkeypatch.setattr(cases, "drive", never)
    with pytest.raises(TrialError, match="in a row"):
        make_case("x", "A")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "keys", "seed"),
    [
        ("A", ("viscous", "heat"), 0),
        ("A", ("flow", "viscous"), 0),
        ("B", ("leak_piston", "viscous", "deadband"), 0),
        ("A", ("hose", "viscous", "silencer"), 0),
        ("D", ("hose", "viscous", "heat"), 0),
        ("I", ("leak_out", "viscous", "spring"), 2),
    ],
)
def test_where_laws_agree_the_nearest_rig_is_the_machine(tmp_path, monkeypatch, make, keys, seed):
    """Instruments without filters and offsets, laws that the contract has: what is left is noise."""
    from exo_sim.simulation import replay as replays

    own = MAKES[make]
    laws = replace(own.laws, flow=0, flow_m=(0.5, 0.5), unequal=False)
    quiet = replace(own.grade, offset=0.0, jitter=0.0, encoder=(1e-6,))
    monkeypatch.setitem(MAKES, make, replace(own, laws=laws, grade=quiet))
    monkeypatch.setattr("exo_sim.trials.whole_machines.machine_run.filtered", lambda values, channel, rate: values)
    monkeypatch.setattr("exo_sim.trials.whole_machines.draw.choose", lambda *_, **__: (keys, ()))
    case = make_case("x", make, seed=seed, duration=8.0, weigh=False)
    write_case(case, tmp_path)
    machine = rigs.read(tmp_path / "truth" / "nearest.toml")
    recorded, _ = replays.usable(read(tmp_path / "truth" / "fresh.csv", None).recording, machine, load(machine))
    replay = replays.replay(recorded, machine, load(machine))
    cylinder = own.cylinder
    for number in ("1",) if own.single else ("1", "2"):
        key = f"{cylinder}.pressure_{number}"
        assert replays.rms(recorded[key], replay.windowed[key]) < 800.0
    spread = np.std(recorded[f"{own.joint}.position"])
    assert replays.rms(recorded[f"{own.joint}.position"], replay.windowed[f"{own.joint}.position"]) < 0.01 * spread


def test_a_single_chamber_is_brought_back_and_has_no_second_pressure(tmp_path):
    for make, known in (("I", {"return_spring"}), ("J", set())):
        case = make_case("x", make, seed=4, duration=6.0, weigh=False)
        write_case(case, tmp_path / make)
        machine = rigs.read(tmp_path / make / "rig.toml")
        (cylinder,) = machine.cylinders.values()
        assert cylinder.single_acting and {effect.name for effect in machine.effects} >= known
        recording = read(tmp_path / make / "recording.csv", None).recording
        assert not any(name.endswith("pressure_2") for name in recording.columns)
        assert not any(name.endswith("pressure_2") for name in truth_of(case)["columns"])


def test_the_truth_is_plain_json(lever):
    truth = json.loads(json.dumps(truth_of(lever)))
    assert truth["make"] == "D" and not truth["reported_only"]
    assert {entry["name"] for entry in truth["hidden"]} >= {"coulomb_friction", "stribeck_friction", "viscous_friction"}
    assert all(entry["matters"]["worst"] >= 0 for entry in truth["hidden"])
