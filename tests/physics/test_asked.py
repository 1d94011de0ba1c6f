"""What is declared of how a diagnosis asks for an effect agrees with what is declared of the others and with the records."""

from __future__ import annotations

from dataclasses import replace

import pytest

from exo_sim.errors import ModelError
from exo_sim.physics.asked import Asked, Occurred, Twins
from exo_sim.physics.declaration import asked_of, declared
from exo_sim.physics.records import CYLINDER

NAMES = sorted(declared())


@pytest.mark.parametrize("name", NAMES)
def test_other_effects_and_numbers_that_it_speaks_of_exist(name: str) -> None:
    effect, asked = declared()[name], declared()[name].asked
    spoken_of = {asked.on_top_of, asked.twins.beside_constant, *asked.twins.unmeasured, *asked.twins.measured} - {""}
    assert spoken_of <= set(declared()) - {name}
    assert {asked.sense.known_at_joint} - {""} <= set(CYLINDER.names or ())
    assert set(asked.sense.places) <= set(effect.places)
    if asked.on_top_of:
        assert effect.cut == declared()[asked.on_top_of].cut


@pytest.mark.parametrize("name", NAMES)
def test_each_set_of_starts_has_a_number_for_each_parameter_of_its_form(name: str) -> None:
    effect, asked = declared()[name], declared()[name].asked
    forms = asked.forms or (tuple(p.name for p in effect.parameters if not p.choices),)
    starts = [*asked.starts, *asked.starts_by_valve, *asked.starts_by_reach]
    if asked.starts_by_motion is not None:
        starts += asked.starts_by_motion(Occurred(force=50.0, speed=0.2, travel=0.05, middle=0.08, base=20.0))
    assert {len(start) for start in starts} <= {len(form) for form in forms}


def test_two_that_are_the_same_where_nobody_measured_say_so_of_each_other() -> None:
    for name, effect in declared().items():
        assert all(name in asked_of(other).twins.unmeasured for other in effect.asked.twins.unmeasured)


def test_values_to_begin_with_lie_within_what_can_be_believed() -> None:
    seen = Occurred(force=50.0, speed=0.2, travel=0.05, middle=0.08, base=20.0)
    for effect in declared().values():
        if effect.asked.starts_by_motion is not None:
            (form,) = effect.asked.forms
            for start in effect.asked.starts_by_motion(seen):
                for name, value in zip(form, start, strict=True):
                    assert effect.parameter(name).low <= value <= effect.parameter(name).high


def test_nothing_special_is_asked_of_what_is_no_effect() -> None:
    assert asked_of("flow_capacity") == Asked()


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (Asked(forms=(("stifness",),)), "asked.forms: 'stifness' is none of its parameters; did you mean \"stiffness\""),
        (Asked(within_speeds=("speed",)), "asked.within_speeds: 'speed'"),
        (Asked(every_contact="softness"), "asked.every_contact: 'softness'"),
        (Asked(neutral={"rate": 1.0}), "asked.neutral: 'rate'"),
        (Asked(twins=Twins(unless="play")), "asked.twins.unless: 'play'"),
    ],
)
def test_a_question_about_a_parameter_that_is_none_is_refused(asked: Asked, said: str) -> None:
    with pytest.raises(ModelError, match="effect presliding") as error:
        replace(declared()["presliding"], asked=asked)
    assert said in str(error.value)
