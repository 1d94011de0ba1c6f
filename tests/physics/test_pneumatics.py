"""The machine's gas as one object: filled, read, advanced, refused in one line with the cylinder's name, and its books."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import bench

from exo_sim.errors import ModelError
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world

AT = np.array([0.05])


def test_it_reads_what_it_was_filled_with() -> None:
    gas = bench(p_1=4e5, p_2=2e5)
    assert gas.pressures(AT)[0] == pytest.approx([4e5, 2e5]) and gas.temperatures()[0] == pytest.approx([293.15, 293.15])
    assert gas.books().mass_residual == 0.0 and gas.books().work == pytest.approx([0.0])


def test_a_closed_chamber_is_squeezed_along_the_isentrope_and_its_work_is_in_the_books() -> None:
    gas = bench(dt=1e-3, p_1=4e5, p_2=4e5)
    v_1, v_2 = (float(gas.cylinders[f"area_{i}"][0]) * 0.05 for i in (1, 2))
    x = 0.05
    for _ in range(100):
        gas.advance(np.array([x]), np.array([x - 1e-4]), np.zeros(1))
        x -= 1e-4
    end = 0.04
    assert gas.pressures(np.array([x]))[0, 0] == pytest.approx(4e5 * (0.05 / end) ** 1.4, rel=1e-6)
    done = (4e5 * v_1 * (1 - (0.05 / end) ** 0.4) + 4e5 * v_2 * (1 - (0.05 / 0.06) ** 0.4)) / 0.4
    assert gas.books().work[0] == pytest.approx(done, rel=1e-5) and gas.books().energy_residual < 1e-12


def test_two_cylinders_do_not_feel_each_other_on_a_stiff_supply() -> None:
    one = paper_cylinder(0.032, 0.012, 0.1, 5e-6, 1e-6, 1e-6)
    both, alone = Pneumatics(paper_world(), np.concatenate([one, one]), dt=1e-3), Pneumatics(paper_world(), one.copy(), dt=1e-3)
    both.fill(np.full(2, 0.05), 3e5, 3e5)
    alone.fill(AT, 3e5, 3e5)
    for _ in range(20):
        both.advance(np.full(2, 0.05), np.full(2, 0.05), np.array([0.6, -1.0]))
        alone.advance(AT, AT, np.array([0.6]))
    assert both.pressures(np.full(2, 0.05))[0] == pytest.approx(alone.pressures(AT)[0], rel=1e-4)  # stages are shared
    assert both.books().drawn.shape == (2,)


def test_what_cannot_be_filled_or_followed_is_one_line_with_the_cylinders_name() -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.1, 5e-6), dt=1e-3, names=("knee_r",))
    with pytest.raises(ModelError, match=r"knee_r.*above zero"):
        gas.fill(AT, -1.0, 3e5)
    gas.fill(AT, 3e5, 3e5)
    with pytest.raises(ModelError, match=r"knee_r.*command is nan"):
        gas.advance(AT, AT, np.array([np.nan]))
