"""A simulation written down while it runs: table, scene and summary piece by piece, in memory that does not grow with its length."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

from exo_sim.control.user_controller import RunningController
from exo_sim.outputs import replacing_all
from exo_sim.recording.rrd_file import writing_rrd
from exo_sim.recording.rrd_messages import unfinished
from exo_sim.recording.table_file import writing_parquet
from exo_sim.simulation import record
from exo_sim.simulation.sensors import Observer
from exo_sim.simulation.summary import Summary
from exo_sim.simulation.wearer_load import wearing
from exo_sim.simulation.worn import MOST_ROWS, Simulation

#: Pieces from which a recording has no list of its contents, which would grow in memory with each.
_LONG = 8


def run(
    simulation: Simulation, rrd: Path, table: Path, seed: int = 0, quiet: bool = True, most: int = MOST_ROWS
) -> tuple[dict[str, Any], bool]:
    """Simulate and write a recording for the viewer and its table, which appear together when all is done.

    While it runs, the recording for the viewer grows as `unfinished(rrd)`; after a kill it is there, up to the last piece.

    Args:
        simulation: What to run.
        rrd, table: Where to.
        seed: Travels with the recording.
        quiet: No progress.
        most: Rows of a piece.

    Returns:
        The numbers of the summary, and whether an interrupt ended it early; what was done by then is written all the same.

    Raises:
        Diverged: as `Simulation.run`.
        OutputError: a file cannot be written.
    """
    summary, observer = Summary(), Observer(simulation.rig)
    interrupted, long = False, simulation.rows > _LONG * most
    with (
        replacing_all(rrd, table, growing={rrd: unfinished(rrd)}) as (rrd_beside, table_beside),
        writing_rrd(rrd_beside, footer=not long) as shown,
        writing_parquet(table_beside) as rows,
        interrupts_noted() as asked_to_stop,
    ):
        for walk in simulation.pieces(quiet, most, asked_to_stop):
            interrupted = walk.interrupted
            wearer = wearing(walk)
            summary.add(walk, wearer)
            scene = record.scene(walk)
            seen = observer.add(record.as_it_was(walk, rrd.stem, seed, wearer))
            shown.add(seen, scene)
            rows.add(seen)
        if (rest := observer.rest()) is not None:
            shown.add(rest)
            rows.add(rest)
    return summary.numbers(), interrupted or asked_to_stop()  # one that came while the last was written is one, too


@contextmanager
def interrupts_noted() -> Iterator[Callable[[], bool]]:
    """Note the first Ctrl-C, or request to end, instead of raising it; give what says whether one came. A second one is raised.

    Within somebody's own controller, which may never come back, the first one is raised too; where that code keeps a second one to
    itself, a third ends the process.
    """
    noted: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        noted.append(number)
        asked = RunningController.is_asked(frame)
        if asked and len(noted) > 1:
            signal.signal(number, signal.SIG_DFL)
        if asked or len(noted) > 1:
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: bool(noted)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
