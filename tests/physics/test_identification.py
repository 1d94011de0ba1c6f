"""What is declared of how a diagnosis asks for an effect agrees with what is declared of the others and with the records."""

from __future__ import annotations

from dataclasses import replace

import pytest

from exo_sim.errors import ModelError
from exo_sim.physics.declaration import declared, identification_of
from exo_sim.physics.identification import Identification, ObservedMotion, Twins
from exo_sim.physics.plant_records import CYLINDER

NAMES = sorted(declared())


@pytest.mark.parametrize("name", NAMES)
def test_other_effects_and_numbers_that_it_speaks_of_exist(name: str) -> None:
    effect, asked = declared()[name], declared()[name].identification
    spoken_of = {asked.on_top_of, asked.twins.beside_constant, *asked.twins.unmeasured, *asked.twins.measured, *asked.twins.unseen} - {""}
    assert spoken_of <= set(declared()) - {name}
    assert {asked.applicability.known_at_joint} - {""} <= set(CYLINDER.names or ())
    assert set(asked.applicability.places) <= set(effect.places)
    if asked.on_top_of:
        assert effect.cut == declared()[asked.on_top_of].cut


@pytest.mark.parametrize("name", NAMES)
def test_each_set_of_starts_has_a_number_for_each_parameter_of_its_form(name: str) -> None:
    effect, asked = declared()[name], declared()[name].identification
    forms = asked.forms or (tuple(p.name for p in effect.parameters if not p.choices),)
    starts = [*asked.starts, *asked.starts_by_reach]
    if asked.starts_by_motion is not None:
        starts += asked.starts_by_motion(ObservedMotion(force=50.0, speed=0.2, travel=0.05, middle=0.08, base=20.0))
    assert {len(start) for start in starts} <= {len(form) for form in forms}
    by_name = asked.starts_by_valve
    assert not by_name or set(by_name) == {one for form in forms for one in form}
    assert len({len(values) for values in by_name.values()}) <= 1


def test_two_that_are_the_same_where_nobody_measured_say_so_of_each_other() -> None:
    for name, effect in declared().items():
        assert all(name in identification_of(other).twins.unmeasured for other in effect.identification.twins.unmeasured)


def test_values_to_begin_with_lie_within_what_can_be_believed() -> None:
    seen = ObservedMotion(force=50.0, speed=0.2, travel=0.05, middle=0.08, base=20.0)
    for effect in declared().values():
        if effect.identification.starts_by_motion is not None:
            form = max(effect.identification.forms, key=len)  # the others begin with as many of them
            for start in effect.identification.starts_by_motion(seen):
                for name, value in zip(form, start, strict=True):
                    assert effect.parameter(name).low <= value <= effect.parameter(name).high


def test_nothing_special_is_asked_of_what_is_no_effect() -> None:
    assert identification_of("flow_capacity") == Identification()


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (Identification(forms=(("stifness",),)), "identification.forms: 'stifness' is none of its parameters; did you mean \"stiffness\""),
        (Identification(within_speeds=("speed",)), "identification.within_speeds: 'speed'"),
        (Identification(within_travels=("place",)), "identification.within_travels: 'place'"),
        (Identification(common=("width", ("lap",))), "identification.common: 'lap'"),
        (Identification(multiplies=("valve_area", ("size",))), "identification.multiplies: 'size'"),
        (Identification(every_contact="softness"), "identification.every_contact: 'softness'"),
        (Identification(neutral={"rate": 1.0}), "identification.neutral: 'rate'"),
        (Identification(twins=Twins(unseen_from={"play": 1.0})), "identification.twins.unseen_from: 'play'"),
        (Identification(twins=Twins(unless="play")), "identification.twins.unless: 'play'"),
    ],
)
def test_a_question_about_a_parameter_that_is_none_is_refused(asked: Identification, said: str) -> None:
    with pytest.raises(ModelError, match="effect presliding") as error:
        replace(declared()["presliding"], identification=asked)
    assert said in str(error.value)
