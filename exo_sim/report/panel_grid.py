"""Panels side by side in a picture, with room in inches for what is written beside them.

matplotlib can measure every label and make room for it; that takes nearly as long as the drawing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Height of a line of a legend, and of its upper and lower edge together, of its letters.
LINE, EDGES = 1.45, 2.0


@dataclass(frozen=True)
class Room:
    """Room around and between the panels of a picture [in].

    Attributes:
        left, right, below, above: Between the edge of the picture and the outermost panels.
        columns, rows: Between neighbouring panels.
    """

    left: float = 0.62
    right: float = 0.1
    below: float = 0.45
    above: float = 0.12
    columns: float = 0.66
    rows: float = 0.5


def grid_of_panels(figure: Figure, rows: int, columns: int, room: Room, width_ratios: Sequence[float] | None = None) -> Any:
    """Return the axes of a grid of panels, shape (rows, columns)."""
    width, height = (float(size) for size in figure.get_size_inches())
    wide = (width - room.left - room.right - (columns - 1) * room.columns) / columns
    high = (height - room.below - room.above - (rows - 1) * room.rows) / rows
    figure.subplots_adjust(
        left=room.left / width, right=1.0 - room.right / width, bottom=room.below / height, top=1.0 - room.above / height,
        wspace=room.columns / wide, hspace=room.rows / high,
    )  # fmt: skip
    return figure.subplots(rows, columns, squeeze=False, width_ratios=width_ratios)



def with_legend(
    figure: Figure, room: Room, handles: Sequence[Any], words: Sequence[str], columns: int, place: Literal["upper center", "upper left"],
    size: float,
) -> None:  # fmt: skip
    """Put a legend above the panels of a grid, and make room for its lines.

    Args:
        figure, room: With its grid of panels.
        handles, words: What is explained, and how.
        columns: Of the legend.
        place: Of the legend.
        size: Of its letters [pt].
    """
    figure.legend(handles, words, loc=place, ncols=columns, fontsize=size, frameon=False, handlelength=1.6, columnspacing=1.4)
    lines = (math.ceil(len(words) / columns) * LINE + EDGES) * size / 72.0
    figure.subplots_adjust(top=1.0 - (room.above + lines) / float(figure.get_size_inches()[1]))
