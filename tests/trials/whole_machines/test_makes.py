"""Makes: who may be looked at, and that those drawn up by an outsider simulate, are recorded, and are not what their owner believes."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.machine.rig_model import load
from exo_sim.recording import read
from exo_sim.simulation import replay as replays
from exo_sim.trials.whole_machines.case import make_case, truth_of, write_case
from exo_sim.trials.whole_machines.draw import build
from exo_sim.trials.whole_machines.excitation import PROGRAMS
from exo_sim.trials.whole_machines.hidden_effects import BLOCKS
from exo_sim.trials.whole_machines.makes import GROUPS, MAKES, find, letters
from exo_sim.trials.whole_machines.owner_rig import as_built
from exo_sim.trials.whole_machines.published_cylinders import SERIES

OUTSIDERS = ("O", "P")


def test_what_an_outsider_drew_up_is_only_reported_on():
    assert set(OUTSIDERS) <= set(letters("report")) and not set(OUTSIDERS) & set(GROUPS["learn"])
    assert all(MAKES[name].reported for name in OUTSIDERS)


def test_outsiders_share_neither_laws_nor_cards_nor_drives_with_makes_for_learning():
    for name in OUTSIDERS:
        own, learnt = MAKES[name], [MAKES[other] for other in GROUPS["learn"]]
        assert own.laws.spool not in {make.laws.spool for make in learnt}
        assert own.grade not in {make.grade for make in learnt} and own.series not in {make.series for make in learnt}
        assert any(program not in make.programs for program in own.programs for make in learnt)
        known = [getattr(own.laws, law) in {getattr(make.laws, law) for make in learnt} for law in ("flow", "leak", "heat", "stribeck")]
        assert not all(known)


def test_every_make_has_its_cylinders_and_programs():
    for make in MAKES.values():
        assert set(make.bores) <= set(SERIES[make.series])
        if make.build != "legs":
            assert set(make.programs) | set(make.fresh) <= set(PROGRAMS)


@pytest.mark.parametrize("name", OUTSIDERS)
def test_the_machines_of_outsiders_are_cylinders_that_are_sold(name):
    for seed in range(20):
        built = build(MAKES[name], "whole", np.random.default_rng(seed))
        size = SERIES[MAKES[name].series][round(built.bore * 1e3, 3)]
        assert built.rod == size.rod and built.machine["stroke"] in size.strokes
        assert built.machine["area_1"] == pytest.approx(size.area, rel=0.02)


@pytest.mark.parametrize("name", OUTSIDERS)
def test_a_fresh_recording_is_not_what_the_handed_in_rig_predicts(tmp_path, name):
    make = MAKES[name]
    case = make_case("x", name, seed=2, duration=6.0, weigh=False)
    write_case(case, tmp_path)
    assert truth_of(case)["reported_only"]
    fresh = read(tmp_path / "truth" / "fresh.csv", None).recording
    signals = [f"{make.cylinder}.pressure_1", f"{make.cylinder}.pressure_2", f"{make.joint}.position"]
    assert set(signals) <= set(fresh.columns)
    errors = {}
    for file in ("rig.toml", "truth/nearest.toml"):
        machine = rigs.read(tmp_path / file)
        recorded, _ = replays.usable(fresh, machine, load(machine))
        replay = replays.replay(recorded, machine, load(machine))
        errors[file] = np.array([replays.rms(recorded[key], replay.windowed[key]) for key in signals])
    seen = np.array([case.rack.pressure_1.spread, case.rack.pressure_2.spread, case.rack.position.spread])
    assert np.all(errors["rig.toml"] > 2 * seen)
    assert np.exp(np.mean(np.log(errors["truth/nearest.toml"] / errors["rig.toml"]))) < 0.8


def test_damping_of_the_joint_stands_in_the_mjcf_and_is_no_viscous_friction_of_the_piston() -> None:
    built = build(find("A"), "single", np.random.default_rng(3), ("viscous",))
    (value, low, high) = BLOCKS["viscous"].exact(built.machine)["coefficient"]
    assert value == built.machine["viscous"] and low < value < high and built.machine["damping"] > 0.0
    assert f'damping="{built.machine["damping"]:.6g}"' in as_built(built).model()
