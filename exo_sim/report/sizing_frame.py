"""What the pages of both kinds of sizing share: templates, style, how many designs a table shows, versions."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

from exo_sim.version import VERSION

_HERE = Path(__file__).parent
_PACKAGES = ("mujoco", "numpy", "numba", "optuna")
#: Rows of the front that are shown.
ROWS = 40


def rendered(template: str, **values: Any) -> str:
    """Return a page of a template in this folder; the same values and versions give the same bytes."""
    import jinja2

    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, undefined=jinja2.StrictUndefined, loader=jinja2.FileSystemLoader(_HERE)
    )
    return environment.get_template(template).render(
        **values,
        style=(_HERE / "diagnosis.css").read_text(encoding="utf-8"),
        versions=", ".join([f"exo-sim {VERSION}", *(f"{name} {metadata.version(name)}" for name in _PACKAGES)]),
    )


def spread(count: int, chosen: int) -> list[int]:
    """Return which rows of a front to show: all, or evenly spread ones with the chosen among them."""
    if count <= ROWS:
        return list(range(count))
    return sorted({round(i * (count - 1) / (ROWS - 2)) for i in range(ROWS - 1)} | {chosen})


def ranges(numbers: Sequence[int]) -> str:
    """Return numbers as text, neighbours as a range: "1-3, 7"."""
    runs: list[list[int]] = []
    for number in sorted(numbers):
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(str(run[0]) if len(run) == 1 else f"{run[0]}-{run[-1]}" for run in runs)
