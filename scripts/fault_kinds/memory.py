"""Memory over many resets and over many strides."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from pathlib import Path

from fault_kinds.outcome import Outcome

#: Growth that is none: what an allocator keeps [bytes].
_FLAT = 8_000_000
_STRIDES = """import resource, sys
from exo_sim.cli import main
status = main(["run", "level_walk", "--assist", "vented", "-q", "--strides", sys.argv[1], "--out", sys.argv[2]])
print(status, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


def resets(bases: Path, number: int) -> Outcome:
    """Reset a plug-in, and make one anew, over and over, with some steps each; resident memory must stay."""
    import mujoco

    from exo_sim import rig as rigs
    from exo_sim.machine.rig_model import load
    from exo_sim.simulation.plugin import PneumaticPlugin

    outcome = Outcome("resets")
    rig = rigs.read(bases / "exo" / "exo.toml")
    model = load(rig)
    data, plugin = mujoco.MjData(model), PneumaticPlugin(model, rig)

    def again(anew: bool) -> None:
        nonlocal data, plugin
        if anew:
            data, plugin = mujoco.MjData(model), PneumaticPlugin(model, rig)
        mujoco.mj_resetData(model, data)
        plugin.reset(data)
        for _ in range(3):
            plugin.step(data)

    for what, anew in (("resets", False), ("plug-ins made anew", True)):
        for _ in range(max(20, number // 10)):
            again(anew)
        before = _resident()
        for _ in range(number):
            again(anew)
            outcome.count(what)
        grown = _resident() - before
        outcome.figures[f"resident memory over {number} {what}"] = f"{grown / 1e6:+.1f} MB"
        if grown > _FLAT:
            outcome.broken.append(f"{number} {what} took {grown / 1e6:.1f} MB")
    return outcome


def strides(folder: Path, few: int, many: int) -> Outcome:
    """Walk few strides and many; the largest resident memory must be the same but for a little."""
    outcome, peaks = Outcome("strides"), []
    for number in (few, many):
        out = folder / f"walk_{number}.rrd"
        came = subprocess.run([sys.executable, "-c", _STRIDES, str(number), str(out)], capture_output=True, text=True, cwd=folder)
        status, peak = came.stdout.split()[-2:] if came.returncode == 0 else ("?", "0")
        outcome.count(f"{number} strides")
        peaks.append(1024 * int(peak))
        outcome.figures[f"largest resident memory of run --strides {number}"] = f"{peaks[-1] / 1e6:.0f} MB"
        if status != "0":
            outcome.broken.append(f"run --strides {number}: status {status}: {came.stderr[-300:]}")
        for path in (out, out.with_suffix(".parquet")):
            path.unlink(missing_ok=True)
    if peaks[1] > 1.25 * peaks[0]:
        outcome.broken.append(f"{many} strides take {peaks[1] / 1e6:.0f} MB, {few} take {peaks[0] / 1e6:.0f} MB")
    return outcome


def _resident() -> int:
    """Return the resident memory of this process now [bytes]; where the system does not tell, the largest so far."""
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
