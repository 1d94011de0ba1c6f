"""A sizing as one self-contained page: the envelope, the front and the table."""

from __future__ import annotations

from exo_sim.report import sizing_picture
from exo_sim.report.sizing_frame import ranges, rendered, spread
from exo_sim.simulation import gas_use
from exo_sim.sizing import published_machine, summary_text
from exo_sim.sizing.hand_calculation import papers_example
from exo_sim.sizing.recommendation import ON_THE_FRONT, fates
from exo_sim.sizing.sensitivity import cheaper
from exo_sim.sizing.study import Sizing

#: What a reader of the page meets in place of a name that programs read.
_SHOWN = {ON_THE_FRONT: "on the Pareto front"}


def page(sizing: Sizing) -> str:
    """Return the HTML; the same sizing and versions give the same bytes."""
    kinds, front = sizing.task.space.kinds, sizing.outcome.front
    shown = spread(len(front), front.index(sizing.choice.found))
    return rendered(
        "sizing.html",
        z=sizing,
        c=sizing.choice.confirmed,
        kinds=kinds,
        changes=summary_text.changes(sizing),
        neighbours=[(one, cheaper(one, sizing.choice.found.score)) for one in sizing.sensitivity.neighbours],
        everywhere=sizing.choice.everywhere,
        worst=max((one.gas for one in sizing.choice.everywhere), default=0.0),
        mean=sum(one.gas for one in sizing.choice.everywhere) / max(len(sizing.choice.everywhere), 1),
        fates=[(_SHOWN.get(what, what), len(numbers), ranges(numbers)) for what, numbers in fates(sizing.outcome, sizing.task)],
        gas=gas_use.rows(sizing.choice.confirmed.summary["gas"]) if "gas" in sizing.choice.confirmed.summary else [],
        bought=summary_text.bought(sizing),
        beside=summary_text.spent(sizing),
        followed={one.name: one for one in sizing.bandwidths},
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
        known=published_machine,
        example=papers_example(),
    )

