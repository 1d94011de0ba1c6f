"""Whether a cylinder is plain is read from its record: any number of any effect on its gas makes it not so."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from exo_sim.physics.declaration import BESIDE_THE_GAS, declared
from exo_sim.physics.gas_effects_off import effects_on_gas, plain
from exo_sim.physics.pneumatics import paper_cylinder


@numba.njit
def is_plain(cylinders):  # type: ignore[no-untyped-def]
    return plain(cylinders[0])


def test_the_papers_cylinder_is_plain_and_a_single_acting_one_is_not() -> None:
    assert is_plain(paper_cylinder(0.032, 0.012, 0.1, 5e-6))
    assert not is_plain(paper_cylinder(0.032, 0.012, 0.1, 5e-6, single_acting=True))


@pytest.mark.parametrize("name", effects_on_gas())
def test_each_number_of_an_effect_on_the_gas_counts_and_a_zero_with_a_sign_does_not(name: str) -> None:
    for parameter in declared()[name].parameters:
        c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
        c[name][parameter.name] = -0.0
        assert is_plain(c)
        c[name][parameter.name] = 1e-300
        assert not is_plain(c), parameter.name


def test_what_has_no_business_in_the_gas_leaves_it_plain() -> None:
    beside = [e for e in declared().values() if e.family in BESIDE_THE_GAS and "cylinder" in e.places and e.name not in effects_on_gas()]
    assert beside
    for effect in beside:
        c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
        c[effect.name][effect.parameters[0].name] = np.float64(1.0)
        assert is_plain(c), effect.name
