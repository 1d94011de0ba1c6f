"""Places in the balances of mass, energy and momentum where effects add up.

A file in `effects/` says of its function which place it belongs to, and that is all that it takes to be counted there:

    @OUTWARD_FLOW.of(EFFECT)
    def outward(p, here, there, world): ...

`p` is the effect's record, with the parameters that it declares; a part without the effect has zeros there, for which the function
returns zero. `summed_effects.py` adds them up. What does not add up but takes another law's place (a flow law, a line, a regulator) is
called by name where it acts, in `balances.py`, `plant.py` or `nodes.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba

from exo_sim.physics.compiled import inlined_kernel
from exo_sim.physics.declaration import Effect

Function = Callable[..., Any]


def within(function: Function) -> Function:
    """Compile a function that is only ever part of a kernel's machine code and is cached with that."""
    return numba.njit(nogil=True, error_model="numpy", forceinline=True)(function)  # type: ignore[no-any-return]


class Term:
    """One place where effects add up.

    Args:
        name: Of the place.
        of_gas: Whether it stands in the balances of a chamber's gas.
    """

    def __init__(self, name: str, of_gas: bool) -> None:
        self.name, self.of_gas = name, of_gas
        self._functions: dict[str, tuple[Effect, Function]] = {}
        self._settling: dict[str, Function] = {}

    def of(self, effect: Effect) -> Callable[[Function], Function]:
        """Enter a function as what an effect adds here, compiled."""

        def enter(function: Function) -> Function:
            compiled = inlined_kernel(function)
            self._functions[effect.name] = effect, compiled
            return compiled

        return enter

    def settling(self, effect: Effect) -> Callable[[Function], Function]:
        """Enter a function as a bound on how fast the gas settles by what an effect adds here [1/s].

        Without one the bound is estimated from differences of the effect's own function.
        """

        def enter(function: Function) -> Function:
            compiled = inlined_kernel(function)
            self._settling[effect.name] = compiled
            return compiled

        return enter

    def function(self, effect: str) -> Function | None:
        """Return what an effect adds here, compiled; None where it adds nothing."""
        return self._functions[effect][1] if effect in self._functions else None

    def effects(self) -> set[str]:
        """Return the names of the effects that add something here."""
        return set(self._functions)

    def total(self, place: str) -> Function:
        """Return total(record, ...): what all effects of a cylinder or joint add, in alphabetical order."""
        total = _nothing
        for name, function in self._at(place):
            total = function_of(name, function) if total is _nothing else _plus(total, name, function)
        return total

    def in_turn(self, place: str) -> Function:
        """Return raised(record, level, ...): a level and what the effects add to it, each given what it has become so far."""
        raised = _as_it_is
        for name, function in self._at(place):
            raised = _raised(raised, name, function)
        return raised

    def fastest(self, place: str, estimate: Callable[[Function], Function]) -> Function:
        """Return rate(record, ...): the sum of all bounds on settling; `estimate` makes one where an effect declares none."""
        total = _nothing
        for name, function in self._at(place):
            bound = self._settling[name] if name in self._settling else estimate(function)
            total = function_of(name, bound) if total is _nothing else _plus(total, name, bound)
        return total

    def _at(self, place: str) -> list[tuple[str, Function]]:
        return [(name, function) for name, (effect, function) in sorted(self._functions.items()) if place in effect.places]


@within
def _nothing(record, *arguments):
    return 0.0


@within
def _as_it_is(record, level, *arguments):
    return level


def function_of(name: str, function: Function) -> Function:
    """Return a function of a part's whole record from one of an effect's own."""

    @within
    def alone(record, *arguments):
        return function(record[name], *arguments)

    return alone


def _plus(before: Function, name: str, function: Function) -> Function:
    @within
    def total(record, *arguments):
        return before(record, *arguments) + function(record[name], *arguments)

    return total


def _raised(before: Function, name: str, function: Function) -> Function:
    @within
    def raised(record, level, *arguments):
        reached = before(record, level, *arguments)
        return reached + function(record[name], reached, *arguments)

    return raised


#: (p, here, there, world) -> gas from a chamber to the surroundings [kg/s]; negative draws gas of the surroundings' temperature in.
OUTWARD_FLOW = Term("flow to the surroundings", of_gas=True)

#: (p, one, two, world) -> gas from chamber 1 to chamber 2 [kg/s].
ACROSS_FLOW = Term("flow between the chambers", of_gas=True)

#: (p, here, world) -> heat into the gas of a chamber [W].
HEAT_FLOW = Term("heat into the gas", of_gas=True)

#: (p, motion) -> dry friction [N or N m], never negative.
DRY_FRICTION = Term("dry friction", of_gas=False)

#: (p, level, motion) -> what is added to the dry friction `level` of all others [N or N m].
DRY_EXCESS = Term("on top of dry friction", of_gas=False)

#: (p, motion) -> resistance for each unit of speed [N s/m or N m s/rad], never negative.
DAMPING = Term("damping", of_gas=False)

#: (p, motion) -> force that depends on position, against + [N or N m].
SPRING_FORCE = Term("spring force", of_gas=False)

#: All of them.
TERMS = (OUTWARD_FLOW, ACROSS_FLOW, HEAT_FLOW, DRY_FRICTION, DRY_EXCESS, DAMPING, SPRING_FORCE)
