"""Numbers that are decided already, joints that are sized alone, and catalogues: what the space then holds."""

import pytest

from exo_sim.errors import RigError, ScenarioError
from exo_sim.rig.catalogue import CATALOGUE
from exo_sim.rig.own_catalogue import Catalogue, CatalogueValve
from exo_sim.sizing.design import fitted
from exo_sim.sizing.fixed_numbers import fixed_numbers
from exo_sim.sizing.screening import chosen_bores
from exo_sim.sizing.sized_rig import sized_text
from exo_sim.sizing.study import space_of


def test_fixed_numbers_are_read_in_si():
    assert fixed_numbers(["supply=7 bar", "hip.bore = 40 mm"]) == {"supply": 7e5, "hip.bore": pytest.approx(0.04)}
    assert fixed_numbers(['knee.valve="8 mm^2"']) == {"knee.valve": pytest.approx(8e-6)}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("supply", "write it like"), ("suply=7 bar", "cannot be fixed"), ("hip.bor=40 mm", 'did you mean "hip.bore"'),
        ("supply=7", "no unit"), ("supply=7 barg", "gauge"), ("hip.bore=-1 mm", "more than 0"), ("hip.supply=7 bar", "cannot be fixed"),
    ],
)  # fmt: skip
def test_other_texts_are_refused(text, words):
    with pytest.raises(ScenarioError, match=words):
        fixed_numbers([text])


def test_a_name_given_twice_is_refused():
    with pytest.raises(ScenarioError, match="twice"):
        fixed_numbers(["supply=7 bar", "supply=8 bar"])


def test_what_is_fixed_is_not_chosen(exo, loads):
    space = space_of(exo, 0.04, None, fixed={"supply": 9e5, "hip.bore": 0.08, "knee.valve": 9e-6})
    numbers = space.owners(exo)
    assert numbers["supply"] == 9e5 and numbers["knee.valve"] == 9e-6
    assert space.bounds["supply"] == (9e5, 9e5)
    for above in (0, 1, 2):
        bores = chosen_bores(exo, space, (loads,), {**numbers, "hip.above": above, "knee.above": above})
        assert CATALOGUE[bores["hip"]].bore == 0.08


@pytest.mark.parametrize(
    ("fixed", "words"),
    [({"hip.bore": 0.041}, "no bore of 41 mm"), ({"hop.bore": 0.04}, "no such number"), ({"supply": 2e5}, "is less than")],
)
def test_fixed_numbers_that_the_machine_cannot_have_are_refused(exo, fixed, words):
    with pytest.raises(ScenarioError, match=words):
        space_of(exo, 0.04, None, fixed=fixed)


def test_joints_may_be_sized_alone(exo):
    space = space_of(exo, 0.04, None, joints=("knee_l", "knee_r"))
    assert [kind.name for kind in space.kinds] == ["knee"] and space.kinds[0].joints == ("knee_l", "knee_r")
    with pytest.raises(ScenarioError, match='did you mean "knee_l"'):
        space_of(exo, 0.04, None, joints=("kne_l",))


def parameters(rig, name, where):
    effect = rig.effect(name, where)
    assert effect is not None
    return effect.parameters


def test_a_catalogues_valve_brings_its_lag_and_ratio_into_the_rig(exo, loads, tmp_path):
    valves = (CatalogueValve("small", 4e-6, mass=0.1), CatalogueValve("large", 12e-6, 0.3, "4-way", 0.008, 0.4))
    space = space_of(exo, 0.04, None, catalogue=Catalogue(valves=valves))
    numbers = space.owners(exo)
    design = space.design(numbers, chosen_bores(exo, space, (loads,), numbers))
    valve = design.joints["hip"].valve
    assert valve is not None and valve.name == "large" and design.joints["hip"].valve_area == 12e-6
    rig = fitted(exo, space.kinds, design)
    assert parameters(rig, "valve_lag", "hip_l") == {"time_constant": 0.008}
    (tmp_path / "sized.toml").write_text(sized_text(exo, space.kinds, design, tmp_path), encoding="utf-8")
    from exo_sim import rig as rigs

    back = rigs.read(tmp_path / "sized.toml")
    assert parameters(back, "valve_lag", "knee_r")["time_constant"] == pytest.approx(0.008)
    assert parameters(back, "critical_ratio", "knee_r")["ratio"] == pytest.approx(0.3)
    assert back.cylinders["hip_l"].valve_area == pytest.approx(12e-6)


def test_a_catalogue_without_the_rigs_kind_of_valve_is_refused(exo):
    with pytest.raises(RigError, match="of which the catalogue has none"):
        space_of(exo, 0.04, None, catalogue=Catalogue(valves=(CatalogueValve("other", 4e-6, kind="independent"),)))
