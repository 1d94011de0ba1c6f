"""What a signal is called in an .rrd, and in which unit: `/piston/pressure_1`, in bar. Readers find the unit beside the values."""

from __future__ import annotations

#: SI unit to the unit that plots are read in, and the factor to it.
_SHOWN = {"Pa": ("bar", 1e-5)}


def entity(key: str) -> str:
    """Return the entity of a column: part and signal are folders of the tree, so that a part can be hidden or shown as one."""
    return "/".join(key.rsplit(".", 1))


def shown(unit: str) -> tuple[str, float]:
    """Return the unit in which values of an SI unit are written, and what they are multiplied by."""
    return _SHOWN.get(unit, (unit, 1.0))
