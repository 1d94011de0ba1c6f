"""The variables of a search: what counts, the owner's own machine among them, and spaces that hold nothing."""

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import ModelError, RigError
from exo_sim.sizing.length_and_arm import length_and_arm
from exo_sim.sizing.study import space_of


def test_only_the_angle_between_the_ends_counts(exo, space):
    """Turning both ends together changes neither length nor arm, so three variables are enough."""
    kind = space.kinds[0]
    turned = [np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]]) @ end for end in (kind.own.base, kind.own.rod)]
    angles = np.linspace(kind.range[0], kind.range[1], 9)
    moved = rigs.Attachment(tuple(turned[0]), tuple(turned[1]))
    np.testing.assert_allclose(length_and_arm(kind.own, 0.0, angles), length_and_arm(moved, 0.0, angles), rtol=1e-12)


def test_the_owners_geometry_is_in_the_space(exo, space):
    numbers = space.owners(exo)
    for kind in space.kinds:
        points = space.attachment(kind, numbers)
        np.testing.assert_allclose([*points.base, *points.rod], [*kind.own.base, *kind.own.rod], atol=6e-5)


def test_a_bench_is_refused_in_one_line(repository):
    with pytest.raises((RigError, ModelError)) as error:
        space_of(rigs.read(repository / "assets" / "bench.toml"), 0.04, None)
    assert "\n" not in str(error.value)


def test_a_pressure_limit_that_leaves_nothing(exo):
    with pytest.raises(RigError, match="leaves nothing"):
        space_of(exo, 0.04, 2e5)
