"""The rivals' ways to choose, on rows whose answer is known."""

import numpy as np
import pytest

from exo_sim.trials.rivals.selection import WAYS, choose
from exo_sim.trials.rivals.surrogate import NOTHING, explained
from exo_sim.trials.rivals.weak_form import Regression


def regression(rest, seed=3):
    rng = np.random.default_rng(seed)
    signals = rng.normal(size=(1200, 4))
    columns = {name: (signals[:, k], "size") for k, name in enumerate(("first", "second", "third", "fourth"))}
    noise = 0.1 * rng.normal(size=1200)
    return Regression(("piston", "energy balance"), rest(signals) + noise, columns, signals)


@pytest.mark.parametrize("how", WAYS)
def test_what_is_there_is_chosen_and_nothing_else(how):
    found = choose(regression(lambda s: 2.0 * s[:, 1] - 1.0 * s[:, 3]), how)
    assert set(found) == {"second", "fourth"}
    for name, true in (("second", 2.0), ("fourth", -1.0)):
        assert abs(found[name].value - true) < 4.0 * found[name].error < 0.05
        assert found[name].gained > 0.3


@pytest.mark.parametrize("how", ["prune", "greedy"])
def test_noise_holds_nothing(how):
    assert choose(regression(lambda s: 0.0 * s[:, 0]), how) == {}


def test_an_ensemble_draws_the_same_each_time_and_leaves_chance_as_it_was():
    rows = regression(lambda s: s[:, 0])
    before = np.random.get_state()[1].tolist()  # type: ignore[index, union-attr]  # noqa: NPY002
    assert choose(rows, "ensemble") == choose(rows, "ensemble")
    assert np.random.get_state()[1].tolist() == before  # type: ignore[index, union-attr]  # noqa: NPY002


def test_a_surrogate_learns_what_no_column_has_and_nothing_from_noise():
    assert explained(regression(lambda s: np.sin(2.0 * s[:, 0]) * s[:, 1])) > 0.5
    assert explained(regression(lambda s: 0.0 * s[:, 0])) < NOTHING
