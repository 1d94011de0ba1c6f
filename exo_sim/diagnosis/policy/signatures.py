"""At which size a candidate is put into a model to see its signature: large enough to show, small enough to be in proportion."""

from __future__ import annotations

from exo_sim.deciding_number import Count, Number

SWAMPS = Number(10.0, "root mean square error of the model", "a larger signature is of another machine: a smaller size is tried ...")
SMALLER = Number(0.2, "share of the size", "... of so much")
DROWNS = Number(0.02, "root mean square error of the model", "one smaller than this drowns in rounding: a larger size is tried ...")
LARGER = Number(10.0, "share of the size", "... of so much")
SMALLEST = Number(1e-3, "share of the size that a fit begins with", "is the least that is tried")
LARGEST = Number(50.0, "share of the size that a fit begins with", "from here on no larger size is tried")
MOST_SIZES = Count(4, "sizes", "are tried of a candidate that is in proportion to its size")
