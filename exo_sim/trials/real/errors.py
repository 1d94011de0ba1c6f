"""How a rig does on recordings of the same machine that took no part in making it.

Forces are held against a balance of our own (`balance`), pressures and angles against one free run of `exo-sim compare`. Where only the
end of a recording was held out, two runs from its beginning are compared, over the whole and over what the tool was given: they are
the same run, so that the sum of squares over the end is the difference of both. (A run that began in the middle would begin with a gas
temperature that nobody knows.)
"""

from __future__ import annotations

import math
import shlex
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import tomlkit

from exo_sim.recording import Recording, write_table
from exo_sim.trials.real.balance import balance_error, read_machine
from exo_sim.trials.real.case import BALANCE, TAIL, RealCase
from exo_sim.trials.whole_machines.unseen_recording import compared


def errors(case: RealCase, rig: Path, compare: str) -> tuple[dict[str, float] | None, tuple[str, ...]]:
    """Return the rms error of a rig by signal, and remarks; None where it could not be run.

    Args:
        case: The case.
        rig: rig.toml, its MJCF where it says.
        compare: Command line of `exo-sim compare`.
    """
    if case.measure == BALANCE:
        assert case.moving is not None
        machine = read_machine(rig)
        remarks = (f"forces of {', '.join(machine.left_out)} are not in this balance",) if machine.left_out else ()
        return {"slide.external_force": balance_error(machine, case.held, case.moving)}, remarks
    line = [*shlex.split(compare), "--motion", case.motion]
    with tempfile.TemporaryDirectory(prefix="held_", dir=rig.parent) as bare:
        if not case.sensors_too:
            rig = _without_sensors(rig, Path(bare) / "rig.toml")
        squares: dict[str, float] = {}
        counts: dict[str, int] = {}
        runs = [(run, 1) for run in case.held] + ([(case.recordings[0], -1)] if case.measure == TAIL else [])
        for number, (run, sign) in enumerate(runs):
            run = run.span(case.held_from, math.inf) if case.held_from else run
            found = _free_run(run, Path(bare) / f"{number}.parquet", rig, line)
            if found is None:
                return None, ("the rig cannot be run",)
            for signal, (square, count) in found.items():
                squares[signal] = squares.get(signal, 0.0) + sign * square
                counts[signal] = counts.get(signal, 0) + sign * count
    return {signal: math.sqrt(max(squares[signal], 0.0) / max(counts[signal], 1)) for signal in squares}, ()


def _without_sensors(rig: Path, there: Path) -> Path:
    """Write the rig without its sensors' faults: other instruments took what it is held against."""
    document = tomlkit.parse(rig.read_text(encoding="utf-8"))
    document["model"] = str((rig.parent / str(document["model"])).resolve())
    effects = document.get("effects", {})
    for name in [name for name in effects if name.startswith("sensor_")]:
        del effects[name]
    there.write_text(tomlkit.dumps(document), encoding="utf-8")
    return there


def _free_run(run: Recording, path: Path, rig: Path, line: list[str]) -> dict[str, tuple[float, int]] | None:
    """Return the sum of squares and the number of samples of each signal that was predicted."""
    write_table(path, run)
    found = compared(line, path, rig)
    if found is None:
        return None
    result = {}
    for signal, entry in found.items():
        value = entry.get("free_run_rms")
        count = int(np.isfinite(run[signal]).sum())
        if value is not None and not signal.endswith(".velocity"):
            result[signal] = (float(value) ** 2 * count, count)
    return result or None


def ratio(top: Mapping[str, float] | None, bottom: Mapping[str, float]) -> float | None:
    """Return the geometric mean over the signals of one error over another; None where they share none."""
    if top is None:
        return None
    logs = [math.log(max(top[signal], 1e-300) / bottom[signal]) for signal in bottom if signal in top]
    return math.exp(sum(logs) / len(logs)) if logs else None
