"""What is inlined is linked into what calls it, without machine code of its own until Python calls it."""

from typing import Any

import numba
import numpy as np
import pytest

from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.linked_code import LinkedKernel


@inlined_kernel
def squared(x):
    return x * x


@inlined_kernel
def of_both(pair, out):
    for i in range(len(pair)):
        out[i] = squared(pair[i]) + 1.0


def summed(pair):
    out = np.zeros(2)
    of_both(pair, out)
    return out[0] + out[1]


filled = kernel(summed)


def test_compiled_code_has_it_inlined_and_python_calls_it() -> None:
    assert filled((2.0, 3.0)) == 15.0
    out = np.zeros(2)
    of_both((2.0, 3.0), out)  # after it was linked: the two are kept apart
    assert out.tolist() == [5.0, 10.0]
    assert squared(1.5) == 2.25


def test_another_kind_of_argument_is_compiled_anew() -> None:
    assert filled((2.0, 3.0)) == filled((np.float64(2.0), np.float64(3.0)))
    assert squared(3) == 9
    assert isinstance(squared(3), int)


def test_linked_code_has_no_machine_code_of_its_own() -> None:
    in_this_process: Any = numba.njit(summed)  # what is kept from an earlier start is linked already
    assert in_this_process((2.0, 3.0)) == 15.0
    for inlined in (squared, of_both):
        assert isinstance(inlined, LinkedKernel)
        linked = [one.library for one in inlined.linked.overloads.values()]
        assert linked
        assert all(one.get_pointer_to_function(name.name) == 0 for one in linked for name in one.get_defined_functions())


def test_an_error_in_it_is_said_where_it_is_compiled() -> None:
    @inlined_kernel
    def wrong(x):
        return x.no_such_thing

    @kernel
    def calls(x):
        return wrong(x)

    with pytest.raises(Exception, match="no_such_thing"):
        calls(1.0)
