"""Small results of columns that were worked out already: the same recordings are gone through again for every rig that is tried."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from threading import Lock
from typing import Any, ParamSpec, TypeVar

import numpy as np

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def kept(most: int) -> Callable[[Callable[Arguments, Result]], Callable[Arguments, Result]]:
    """Make a function of arrays and numbers return what it returned before for the same bytes; nobody may write to its results.

    Args:
        most: Results that are kept, the latest.
    """

    def decorate(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
        lock = Lock()
        results: OrderedDict[bytes, Result] = OrderedDict()

        @wraps(function)
        def call(*args: Arguments.args, **named: Arguments.kwargs) -> Result:
            key = _digest((args, sorted(named.items())))
            with lock:
                if key in results:
                    results.move_to_end(key)
                    return results[key]
            found = function(*args, **named)
            with lock:
                results[key] = found
                while len(results) > most:
                    results.popitem(last=False)
            return found

        return call

    return decorate


def _digest(of: Any) -> bytes:
    found = hashlib.blake2b(digest_size=16)
    _add(found, of)
    return found.digest()


def _add(digest: Any, one: Any) -> None:
    if isinstance(one, np.ndarray):
        digest.update(f"{one.dtype.str}{one.shape}".encode())
        digest.update(np.ascontiguousarray(one).data)
    elif isinstance(one, list | tuple):
        digest.update(f"{type(one).__name__}{len(one)}".encode())
        for each in one:
            _add(digest, each)
    else:
        digest.update(f"{type(one).__name__}{one!r};".encode())
