import numpy as np
import pytest

from exo_sim.recording.kept_results import kept


def counted(most=2):
    calls = []

    @kept(most)
    def total(values, factor=1.0):
        calls.append(factor)
        return factor * float(np.sum(values))

    return total, calls


def test_the_same_bytes_are_worked_out_once():
    total, calls = counted()
    values = np.arange(4.0)
    assert total(values, 2.0) == total(values.copy(), 2.0) == 12.0
    assert calls == [2.0]


@pytest.mark.parametrize(
    "other", [np.arange(5.0), np.arange(4), np.arange(4.0).reshape(2, 2), np.array([0.0, 1.0, 2.0, np.nextafter(3.0, 4.0)])]
)
def test_other_lengths_types_shapes_and_the_last_bit_count(other):
    total, calls = counted()
    total(np.arange(4.0))
    total(other)
    assert len(calls) == 2


def test_numbers_and_names_count():
    total, calls = counted(most=8)
    values = np.arange(4.0)
    for factor in (1.0, 2.0, 1):
        total(values, factor)
    assert total(values, factor=2.0) == 12.0
    assert len(calls) == 4


def test_an_array_that_is_changed_is_another_one():
    total, _ = counted()
    values = np.arange(4.0)
    total(values)
    values[0] = 1.0
    assert total(values) == 7.0


def test_the_oldest_result_goes():
    total, calls = counted(most=2)
    first, second, third = (np.full(3, each) for each in (1.0, 2.0, 3.0))
    total(first), total(second), total(first), total(third)
    total(first)
    assert len(calls) == 3
    total(second)
    assert len(calls) == 4


def test_a_transposed_array_is_told_by_its_values():
    total, calls = counted()
    values = np.arange(4.0).reshape(2, 2)
    total(values)
    total(values.T)
    assert len(calls) == 2


def test_a_refusal_is_not_kept():
    asked = []

    @kept(2)
    def refuses(values):
        asked.append(1)
        raise ValueError("no")

    for _ in range(2):
        with pytest.raises(ValueError):
            refuses(np.zeros(2))
    assert len(asked) == 2
