"""How long others take to the same fit: `mujoco.sysid`, and scipy around plain Python, against ours.

Everybody is given the same 3 s recording of a bench with a leaking piston (command, piston position and both pressures, as the
diagnosis prepares them), the same four numbers, start and bounds, and one core; the piston follows the recorded position and the
errors of both pressures count alike. Time runs to the first numbers that miss the recording by at most one hundredth more than the
best numbers that anybody found; what they miss is reckoned by one judge.
"""

from __future__ import annotations

from benchmarks.figure import Asked, Figure, Said
from benchmarks.fits import by_scipy, by_sysid, ours
from benchmarks.task import Task, Trail, task

#: How much more than the best counts as the same fit.
SAME = 1.01
REPEATS = 5


def reached(given: Task, path: Trail, goal: float) -> float:
    """Return the seconds until a fit asked about numbers that miss by no more than the goal; infinite where it never did."""
    return next((when for when, numbers in path.asked if given.error(numbers) <= goal), float("inf"))


def measure(asked: Asked) -> Said:
    """Measure all three; ours is quick, so the quickest of a few counts."""
    given = task()
    ours(given)
    said: list[Figure | str] = []
    runs = {"ours": min((ours(given) for _ in range(REPEATS)), key=lambda path: path.taken), "scipy": by_scipy(given)}
    try:
        runs["sysid"] = by_sysid(given)
    except ImportError as missing:
        said.append(f"mujoco.sysid: left out, {missing}; pip install 'mujoco[sysid]'")
    missed = {name: given.error(path.asked[-1][1]) for name, path in runs.items()}
    goal = SAME * min(missed.values())
    taken = {name: reached(given, path, goal) for name, path in runs.items()}
    words = {"ours": "fit of four numbers, ours", "sysid": "... mujoco.sysid", "scipy": "... scipy around plain Python"}
    for name in ("ours", "sysid", "scipy"):
        if name in runs:
            said.append(Figure(f"fit_{name}_s", words[name], taken[name], "{:.3f} s"))
            said.append(Figure(f"fit_{name}_to_its_end_s", "    to its own end", runs[name].taken, "{:.3f} s"))
            said.append(Figure(f"fit_{name}_simulations", "    simulations", len(runs[name].asked) - 1, "{:.0f}"))
            said.append(Figure(f"fit_{name}_rms_pa", "    misses the recording by", missed[name], "{:.1f} Pa"))
    for name in ("sysid", "scipy"):
        if name in runs:
            said.append(Figure(f"{name}_ratio", f"{words[name][4:]} against ours", taken[name] / taken["ours"], "{:.1f} times", above=1.0))
    return said
