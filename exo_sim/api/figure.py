"""Figures that show themselves in notebooks."""

from __future__ import annotations

import io
from collections.abc import Sequence

from matplotlib.figure import Figure


class Picture(Figure):
    """A matplotlib figure that a notebook shows without pyplot; `savefig` writes it."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=110)
        return buffer.getvalue()


def front(designs: Sequence[tuple[float, float]], recommended: tuple[float, float], gas: str) -> Picture:
    """Draw designs, gas drawn against the mass of the cylinders, the recommended one marked.

    Args:
        designs: Mass [kg] and gas [kg] of each.
        recommended: The same of one of them.
        gas: What the gas is drawn over, for the axis.
    """
    figure = Picture(figsize=(6.0, 4.0), layout="constrained")
    axes = figure.subplots()
    axes.plot([mass for mass, _ in designs], [1e3 * drawn for _, drawn in designs], "o", ms=4, label="front")
    axes.plot(recommended[0], 1e3 * recommended[1], "*", ms=14, label="recommended")
    axes.set(xlabel="mass of the cylinders [kg]", ylabel=gas)
    axes.legend()
    return figure
