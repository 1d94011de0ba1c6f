"""A sizing along a motion as one self-contained page."""

from __future__ import annotations

from collections import Counter

from exo_sim.report import sizing_picture
from exo_sim.report.sizing_frame import rendered, spread
from exo_sim.sizing import motion_result
from exo_sim.sizing.evaluation import ENOUGH_MARGIN
from exo_sim.sizing.motion_result import MotionSizing


def motion_page(found: MotionSizing) -> str:
    """Return the HTML; the same sizing and versions give the same bytes."""
    groups = list(found.judge.space.groups)
    turns = any(link.turning for link in found.judge.links)
    shown = spread(len(found.front), found.front.index(found.chosen))
    return rendered(
        "motion_sizing.html",
        motion=found.judge.loads.motion.name,
        described=motion_result.described(found),
        groups=groups,
        chosen=found.chosen,
        enough=ENOUGH_MARGIN,
        evaluated=len(found.designs),
        front=found.front,
        rows=[motion_result.entry(found, found.front[i]) for i in shown],
        left_out=len(found.front) - len(shown),
        unit="deg" if turns else "mm",
        scale=57.29577951308232 if turns else 1e3,
        fates=Counter(one.fate or "can be had" for one in found.designs).most_common(),
        changes=motion_result.changes(found),
        bought=motion_result.bought(found),
        forces=sizing_picture.motion_forces(found),
        views=sizing_picture.motion_front(found),
    )
