"""Friction of two directions that is one number is no richer form, whether the rig has that number or not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.selection.simpler_forms import no_richer_than_needed, poorer_where_alike


def number(effect: str, name: str) -> FreeParameter:
    return FreeParameter(effect, "piston", name, "N", Target.CYLINDER, 1.0, 0.0, 1e5)


FORCE, FORWARD, BACKWARD = (
    number("coulomb_friction", "force"), number("asymmetric_friction", "forward"), number("asymmetric_friction", "backward")
)  # fmt: skip
PLAIN = Candidate("coulomb_friction", "piston", "force", (FORCE,), ((1.0,),))
APART = Candidate("asymmetric_friction", "piston", "forward+backward", (FORWARD, BACKWARD), ((1.0, 1.0),))


@pytest.mark.parametrize(("forward", "backward", "kept"), [(10.0, 10.5, PLAIN), (10.0, 14.0, APART)])
def test_where_the_rig_has_none_the_poorer_one_is_found_instead(forward: float, backward: float, kept: Candidate) -> None:
    assert poorer_where_alike([APART], {FORWARD: forward, BACKWARD: backward}, {"coulomb_friction": PLAIN}) == (kept,)


@pytest.mark.parametrize(("backward", "named"), [(21.5, False), (26.0, True)])
def test_what_the_rig_has_and_is_alike_is_no_finding(backward: float, named: bool) -> None:
    instead = replace(APART, fixed=((FORCE, 0.0),))
    assert poorer_where_alike([instead], {FORWARD: 20.0, BACKWARD: backward}, {}) == (instead,) * named


def test_a_poorer_form_that_explains_as_much_is_taken() -> None:
    assert no_richer_than_needed([APART], {APART.key: [(PLAIN, 0.5)]}) == (PLAIN,)
    assert no_richer_than_needed([APART], {APART.key: [(PLAIN, 50.0)]}) == (APART,)
