"""A sizing as one self-contained page: the envelope, the front and the table."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path

import exo_sim
from exo_sim.report import sizing_picture
from exo_sim.simulation import gas_use
from exo_sim.sizing import published, summary_text
from exo_sim.sizing.by_hand import papers_example
from exo_sim.sizing.choice import fates
from exo_sim.sizing.sensitivity import cheaper
from exo_sim.sizing.study import Sizing

_HERE = Path(__file__).parent
_PACKAGES = ("mujoco", "numpy", "numba", "optuna")
#: Rows of the front that are shown.
_ROWS = 40


def page(sizing: Sizing) -> str:
    """Return the HTML; the same sizing and versions give the same bytes."""
    import jinja2

    environment = jinja2.Environment(autoescape=True, trim_blocks=True, undefined=jinja2.StrictUndefined)
    template = environment.from_string((_HERE / "sizing.html").read_text(encoding="utf-8"))
    kinds, front = sizing.task.space.kinds, sizing.outcome.front
    shown = _spread(len(front), front.index(sizing.choice.found))
    return template.render(
        z=sizing,
        c=sizing.choice.confirmed,
        kinds=kinds,
        changes=summary_text.changes(sizing),
        neighbours=[(one, cheaper(one, sizing.choice.found.score)) for one in sizing.sensitivity.neighbours],
        everywhere=sizing.choice.everywhere,
        worst=max((one.gas for one in sizing.choice.everywhere), default=0.0),
        mean=sum(one.gas for one in sizing.choice.everywhere) / max(len(sizing.choice.everywhere), 1),
        fates=fates(sizing.outcome, sizing.task),
        gas=gas_use.rows(sizing.choice.confirmed.summary["gas"]) if "gas" in sizing.choice.confirmed.summary else [],
        style=(_HERE / "diagnosis.css").read_text(encoding="utf-8"),
        conditions=[str(condition) for condition in sizing.task.conditions],
        described=summary_text.described(kinds, sizing.choice.found),
        simulated=sum(one.score.simulated for one in sizing.outcome.trials),
        envelopes=sizing_picture.envelopes(sizing),
        margins=sizing_picture.margins(sizing),
        front=sizing_picture.front(sizing),
        rows=[summary_text.entry(kinds, front[i]) for i in shown],
        left_out=len(front) - len(shown),
        loads=[
            {**summary_text.load_numbers(one), "picture": sizing_picture.loads_of_all_joints(one)} for one in sizing.loads
        ],
        others=[summary_text.described(kinds, one.choice.found) for one in sizing.without],
        p=sizing.published,
        known=published,
        example=papers_example(),
        versions=", ".join([f"exo-sim {exo_sim.__version__}", *(f"{name} {metadata.version(name)}" for name in _PACKAGES)]),
    )


def _spread(count: int, chosen: int) -> list[int]:
    """Return which rows to show: all, or evenly spread ones with the chosen among them."""
    if count <= _ROWS:
        return list(range(count))
    return sorted({round(i * (count - 1) / (_ROWS - 2)) for i in range(_ROWS - 1)} | {chosen})
