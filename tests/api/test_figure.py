"""Pictures that notebooks show."""

import numpy as np

from exo_sim.api.figure import front


def test_a_front_shows_every_design_in_grams_and_the_recommended_one() -> None:
    picture = front([(1.0, 0.010), (2.0, 0.005)], (2.0, 0.005), "gas a cycle [g]")
    (axes,) = picture.axes
    designs, recommended = axes.lines
    assert np.asarray(designs.get_xydata(), dtype=float).tolist() == [[1.0, 10.0], [2.0, 5.0]]
    assert np.asarray(recommended.get_xydata(), dtype=float).tolist() == [[2.0, 5.0]]
    assert axes.get_ylabel() == "gas a cycle [g]" and picture._repr_png_().startswith(b"\x89PNG")
