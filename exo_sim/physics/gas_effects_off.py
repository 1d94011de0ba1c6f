"""Whether nothing is added to a cylinder's gas: asking for a dozen effects that are absent takes longer than the paper's equations do."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from exo_sim.physics.declaration import BESIDE_THE_GAS, declared
from exo_sim.physics.plant_records import CYLINDER
from exo_sim.physics.terms import TERMS

#: Effects of a family that has nothing to do in the balances, by which the paths of the valve differ all the same.
_ON_PATHS = ("valve_edges", "valve_characteristic")


def effects_on_gas() -> tuple[str, ...]:
    """Return the names of the effects of a cylinder that may add something to the balances of its gas, or make its paths unlike.

    Those of a family that has nothing to do there are left out, unless they do add something: what is unheard of counts.
    """
    adding = set(_ON_PATHS).union(*(term.effects() for term in TERMS if term.of_gas))
    effects = [effect for effect in declared().values() if "cylinder" in effect.places]
    return tuple(effect.name for effect in effects if effect.family not in BESIDE_THE_GAS or effect.name in adding)


def _words() -> list[int]:
    """Return the places, in words of eight bytes, of every number of a cylinder's record that must be zero."""
    assert CYLINDER.fields is not None
    found: list[int] = []
    for name in ("single_acting", *effects_on_gas()):
        kind, start = CYLINDER.fields[name][:2]
        found += range(start // 8, (start + kind.itemsize) // 8)
    return found


def _are_zero(typingctx: Any, record: Any) -> Any:
    """Compile to a test of those numbers' bits, the sign's left out; four at a time where so many stand side by side."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = ir.IntType(64)
        four = ir.VectorType(word, 4)
        numbers = builder.bitcast(arguments[0], word.as_pointer())
        seen, seen_of_four = ir.Constant(word, 0), ir.Constant(four, [0] * 4)
        places = sorted(_words())
        while places:
            at = builder.gep(numbers, [ir.Constant(word, places[0])])
            if places[:4] == list(range(places[0], places[0] + 4)):
                seen_of_four = builder.or_(seen_of_four, builder.load(builder.bitcast(at, four.as_pointer()), align=8))
                places = places[4:]
            else:
                seen = builder.or_(seen, builder.load(at))
                places = places[1:]
        for lane in range(4):
            seen = builder.or_(seen, builder.extract_element(seen_of_four, ir.Constant(ir.IntType(32), lane)))
        return builder.icmp_unsigned("==", builder.shl(seen, ir.Constant(word, 1)), ir.Constant(word, 0))

    return types.boolean(record), generate


#: `plain(c)` in compiled code: True for a double-acting cylinder on which no effect acts that its gas would feel between valve and piston.
plain: Any = intrinsic(_are_zero)
