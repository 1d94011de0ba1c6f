"""Recordings of a bench in which one thing is concealed, by the proving ground's own truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions

SEED = 11


def write(folder: Path, effect: str, lengths: Sequence[float], together: bool = False, supply: bool = True) -> list[tuple[Path, Path]]:
    """Write recordings at 1 kHz; return (recording, rig) of each.

    Args:
        folder: Where to.
        effect: What is concealed, at a clearly visible size.
        lengths: Seconds; every recording is the beginning of the longest, so that only the length differs. With `together` they
            are recordings of one machine instead, all as long as the longest.
        together: See there.
        supply: Whether the supply's pressure is recorded.
    """
    most = max(lengths)
    count = len(lengths) if together else 1
    conditions = Conditions(duration=most, known=(), recordings=count, supply_recorded=supply)
    case = make_case("bench", (effect,), SEED, conditions=conditions)
    if together:
        paths = write_case(case, folder / "together", "parquet")
        return [(path, path.with_name("rig.toml")) for path in paths]
    whole, written = case.recordings[0], []
    for length in lengths:
        rows = round(len(whole["time [s]"]) * length / most)
        cut = {name: values[:rows] for name, values in whole.items()}
        (path,) = write_case(replace(case, recordings=(cut,)), folder / f"{effect}_{length:g}_s", "parquet")
        written.append((path, path.with_name("rig.toml")))
    return written
