"""Linear algebra in one thread: inside, and not any longer than that."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from exo_sim.linear_algebra import in_one_thread


def threads() -> set[int]:
    """Return how many threads each loaded BLAS may use."""
    np.ones((2, 2)) @ np.ones((2, 2))
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


def test_the_function_has_one_thread_and_its_caller_those_that_he_had() -> None:
    with threadpool_limits(limits=2, user_api="blas"):
        assert threads() == {2}
        assert in_one_thread(threads)() == {1}
        assert threads() == {2}


def test_they_come_back_after_an_error_too() -> None:
    def fails(value: int) -> int:
        raise ValueError(str(value))

    with threadpool_limits(limits=2, user_api="blas"):
        with pytest.raises(ValueError, match="7"):
            in_one_thread(fails)(7)
        assert threads() == {2}
