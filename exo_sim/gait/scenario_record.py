"""What a scenario is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from exo_sim.gait.motion import Motion
from exo_sim.gait.variation import Variation
from exo_sim.machine.person import Person

#: What moves the wearer: the reference itself, or the torques of his joints.
WEARERS = ("prescribed", "torques")


@dataclass(frozen=True)
class AddedLoad:
    """Mass put on the back while the scenario runs.

    Attributes:
        mass: [kg].
        at: When, in cycles of the motion.
        over: How long it takes until it hangs fully on the frame [s].
    """

    mass: float
    at: float
    over: float


@dataclass(frozen=True)
class Scenario:
    """One thing that a person does in the machine.

    Attributes:
        summary: One line for the list.
        motion: Gives the reference motion of a person.
        cycle: What one cycle is called: "stride", "repetition", "second", "walk".
        cycles: How many, unless asked otherwise.
        gait: Name of the recorded gait that the angles can be held against, or None.
        added: Load put on while it runs, or None.
        remarks: Plain sentences about what it was made of.
        doubts: Of somebody's own gait what may be wrong with its angles, in words that follow "perhaps because"; None for one that comes
            along.
        variation: How its strides differ from the mean one, or None.
        wearer: What moves the wearer: "prescribed" or "torques".
        pace: Speed at which a walk goes where none is asked for [m/s]; None for the recorded one.
        grade: Rise over run of the slope that a level walk is taken to.
        hung: Mass on bodies of the machine beside their own, by name [kg].
    """

    summary: str
    motion: Callable[[Person], Motion]
    cycle: str = "stride"
    cycles: int = 10
    gait: str | None = None
    added: AddedLoad | None = None
    remarks: tuple[str, ...] = ()
    doubts: tuple[str, ...] | None = None
    variation: Variation | None = None
    wearer: str = "prescribed"
    pace: float | None = None
    grade: float = 0.0
    hung: Mapping[str, float] = field(default_factory=dict)
