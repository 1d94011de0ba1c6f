"""A sizing along a motion as one self-contained page."""

from __future__ import annotations

from collections import Counter
from importlib import metadata
from pathlib import Path

import exo_sim
from exo_sim.report import sizing_picture
from exo_sim.sizing import motion_result
from exo_sim.sizing.evaluation import ENOUGH_MARGIN
from exo_sim.sizing.motion_result import MotionSizing

_HERE = Path(__file__).parent
_PACKAGES = ("mujoco", "numpy", "numba", "optuna")
#: Rows of the front that are shown.
_ROWS = 40


def motion_page(found: MotionSizing) -> str:
    """Return the HTML; the same sizing and versions give the same bytes."""
    import jinja2

    environment = jinja2.Environment(autoescape=True, trim_blocks=True, undefined=jinja2.StrictUndefined)
    template = environment.from_string((_HERE / "motion_sizing.html").read_text(encoding="utf-8"))
    groups = list(found.judge.space.groups)
    turns = any(link.turning for link in found.judge.links)
    return template.render(
        style=(_HERE / "diagnosis.css").read_text(encoding="utf-8"),
        motion=found.judge.loads.motion.name,
        described=motion_result.described(found),
        groups=groups,
        chosen=found.chosen,
        enough=ENOUGH_MARGIN,
        evaluated=len(found.designs),
        front=found.front,
        rows=[motion_result.entry(found, one) for one in found.front[:_ROWS]],
        left_out=max(len(found.front) - _ROWS, 0),
        unit="deg" if turns else "mm",
        scale=57.29577951308232 if turns else 1e3,
        fates=Counter(one.fate or "can be had" for one in found.designs).most_common(),
        changes=motion_result.changes(found),
        forces=sizing_picture.motion_forces(found),
        views=sizing_picture.motion_front(found),
        versions=", ".join([f"exo-sim {exo_sim.__version__}", *(f"{name} {metadata.version(name)}" for name in _PACKAGES)]),
    )
