"""What an effect may declare: names that exist, units by place, and one line with the nearest name where it does not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from exo_sim.errors import ModelError
from exo_sim.physics.declaration import Parameter, check_others, declared, family_of, identification_of
from exo_sim.physics.identification import Identification, Twins


def test_every_file_of_the_folder_is_an_effect_under_its_own_name() -> None:
    assert len(declared()) > 25 and all(name == effect.name for name, effect in declared().items())
    assert list(declared()) == sorted(declared())


@pytest.mark.parametrize(
    ("change", "says"),
    [({"family": "frictoin"}, 'did you mean "friction"'), ({"places": ("cylindre",)}, 'did you mean "cylinder"'),
     ({"cut": "motoin"}, 'did you mean "motion"'), ({"parameters": (Parameter("force", "W", 0.0, 1.0, (0.1, 0.2), "none"),)}, "in 'W'"),
     ({"identification": Identification(forms=(("fource",),))}, 'did you mean "force"')],
)  # fmt: skip
def test_a_word_that_is_none_is_refused_with_the_nearest(change: dict[str, object], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        replace(declared()["coulomb_friction"], **change)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "change",
    [{"mistaken_for": ("viscous_frictoin",)}, {"requires": "viscous_frictoin"},
     {"identification": Identification(on_top_of="viscous_frictoin")}],
)  # fmt: skip
def test_another_effect_that_there_is_not_is_refused_with_the_nearest(change: dict[str, object]) -> None:
    """A name that says nothing would be silence: the effect would be asked as if nothing were like it."""
    wrong = replace(declared()["coulomb_friction"], **change)  # type: ignore[arg-type]
    with pytest.raises(ModelError, match='did you mean "viscous_friction"'):
        check_others(wrong, declared())


def test_a_number_that_an_effect_in_parts_has_not_is_refused_with_the_nearest() -> None:
    parts = Identification(twins=Twins(as_parts={"valve_edges": {"overlap_suply_1": 1.0}}))
    with pytest.raises(ModelError, match=r'no parameter .*did you mean "overlap_supply_1"'):
        check_others(replace(declared()["valve_offset"], identification=parts), declared())


def test_units_turn_with_the_joint() -> None:
    force = declared()["coulomb_friction"].parameter("force")
    assert force.unit_at(False) == "N" and force.unit_at(True) in ("N m", "N*m")
    with pytest.raises(KeyError):
        declared()["coulomb_friction"].parameter("no such")


def test_what_is_no_effect_is_asked_nothing_special() -> None:
    assert identification_of("payload_mass") == Identification()
    assert identification_of("wall_heat_transfer") is declared()["wall_heat_transfer"].identification
    assert family_of("payload_mass") == "" and family_of("wall_heat_transfer") == declared()["wall_heat_transfer"].family
