"""Linear algebra in one thread: matrices are small here, and how many threads share a product decides its last bits.

Searches and rehearsals go on with what costs less, so such bits may send them another way: a machine with a free ankle cost its wearer
636 W on one core and 729 W on two. And threads that wait for each other cost processor time.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def in_one_thread(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Make a function run with one thread in every BLAS that is loaded, whatever the caller has before and after."""

    @wraps(function)
    def call(*args: Arguments.args, **named: Arguments.kwargs) -> Result:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **named)

    return call
