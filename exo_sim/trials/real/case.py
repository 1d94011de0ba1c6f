"""What a case of a real machine is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from exo_sim.recording import Recording

#: How an improved rig is held against what took no part: see `errors`.
BALANCE, FREE_RUN, TAIL = "balance", "free_run", "tail"


@dataclass(frozen=True)
class Name:
    """An effect that is there: one of several names at one of several places.

    Attributes:
        names: Any of them is right; the first is what the effect is called in tables.
        places: Cylinders, joints or columns.
    """

    names: tuple[str, ...]
    places: tuple[str, ...]

    def __str__(self) -> str:
        return f"{'|'.join(self.names)} ({', '.join(self.places)})"


@dataclass(frozen=True)
class Moving:
    """Rows of a recording at which forces are held against a rig.

    Attributes:
        cut_off: Of the zero-phase low-pass before positions are differentiated [Hz].
        speed: Least speed [m/s].
        acceleration: Most acceleration [m/s^2].
    """

    cut_off: float
    speed: float
    acceleration: float = float("inf")


@dataclass(frozen=True)
class Known:
    """What is known of a machine.

    Attributes:
        must: Effects that are there for certain.
        may: Effects that may be there, or stand for one that is. Any other name must not be given.
        unknown: Something without a name may be reported as well.
        published: The error of the best honest model that anybody published on what took no part, by signal; mostly empty: see `honest`.
        source: Where all that is known from.
    """

    must: tuple[Name, ...]
    may: tuple[Name, ...]
    unknown: bool
    published: Mapping[str, float]
    source: str


@dataclass(frozen=True)
class RealCase:
    """A machine, its recordings, and what is known of it.

    Attributes:
        name: Of the case.
        make: Whose machine: cases of one make share their instruments, and much of what is known of them.
        rig: Folder of rig.toml and its MJCF.
        recordings: Handed to the tool.
        held: Held out. For `TAIL` each is the whole of which the tool got the beginning.
        measure: `BALANCE`, forces at the rows of `moving`; `FREE_RUN`, one run from the first measured state; `TAIL`, the same from the
            first state of the whole recording, of which only what was held out counts.
        motion: "recorded" or "predicted", in free runs.
        known: What is known.
        moving: Rows, for `BALANCE`.
        sensors_too: Sensor effects of an improved rig hold of what was held out; not where other instruments took it.
        held_from: Where runs of what was held out begin [s].
        variant_of: The case whose recordings were cut down to this one.
    """

    name: str
    make: str
    rig: str
    recordings: tuple[Recording, ...]
    held: tuple[Recording, ...]
    measure: str
    motion: str
    known: Known
    moving: Moving | None = None
    sensors_too: bool = True
    held_from: float = 0.0
    variant_of: str = ""
