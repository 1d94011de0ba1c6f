"""Every number that decides says what it counts, why it is so large, and what set it."""

from __future__ import annotations

import importlib
import pickle
import pkgutil
from collections.abc import Iterator

import pytest

from exo_sim.conventions import limits
from exo_sim.deciding_number import Count, Number
from exo_sim.diagnosis import policy


def numbers() -> Iterator[tuple[str, object]]:
    modules = [importlib.import_module(f"{policy.__name__}.{module.name}") for module in pkgutil.iter_modules(policy.__path__)]
    for module in (*modules, limits):
        for name, value in vars(module).items():
            if name.isupper():
                yield from value.items() if isinstance(value, dict) else ((f"{module.__name__}.{name}", value),)


@pytest.mark.parametrize(("name", "value"), list(numbers()))
def test_it_has_a_unit_a_derivation_and_an_origin(name: str, value: object) -> None:
    assert isinstance(value, (Number, Count)), name
    assert value.unit and value.why and value.set_by


def test_no_name_stands_for_two_numbers() -> None:
    names = [name.rpartition(".")[2] for name, _ in numbers() if "." in name]
    assert sorted({name for name in names if names.count(name) > 1}) == []


def test_it_is_a_number_like_any_other() -> None:
    one = Number(2.5, "standard errors", "so far from neutral")
    assert one * 2 == 5.0 and hash(one) == hash(2.5) and str(one) == "2.5"
    again = pickle.loads(pickle.dumps(one))
    assert again == one and again.why == one.why


def test_a_count_is_whole() -> None:
    three = Count(3, "sets", "grown side by side")
    assert list(range(three)) == [0, 1, 2] and three == 3 and hash(three) == hash(3)
    again = pickle.loads(pickle.dumps(three))
    assert again == three and again.unit == "sets"
