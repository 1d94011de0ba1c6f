"""One version of the program, asked about many cases: processes that import it from its own checkout."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

#: What is kept of an answer; the last holds the exit status and what was said.
FILES = ("diagnosis.json", "improved.toml", "status")

#: Diagnoses the cases whose names follow, each into a folder of its own; the status is written last.
ASKING = """
import contextlib, io, os, sys, time
from pathlib import Path
import exo_sim
from exo_sim.cli import main
checkout, cases, out, every, *names = sys.argv[1:]
assert Path(exo_sim.__file__).is_relative_to(checkout), exo_sim.__file__
for name in names:
    case, folder = Path(cases) / name, Path(out) / name
    words = ["diagnose", *map(str, sorted(case.glob("recording*"))), "--rig", str(case / "rig.toml"), "--out", str(folder)]
    said, begun = io.StringIO(), time.process_time()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            status = main([*words, "--jobs", "1"])
        except SystemExit as end:
            status = end.code
    for other in ("report.html", "comparison.rrd"):
        (folder / other).unlink(missing_ok=True)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "status").write_text(f"{status}\\n{said.getvalue()}".replace(str(cases), "CASES").replace(str(out), "OUT"))
    done = [(Path(out) / one / "status").exists() for one in every.split(",")]
    print(f"{sum(done)} of {len(done)}: {name}: exit status {status}, {time.process_time() - begun:.1f} s", flush=True)
"""


def ask(checkout: Path, cases: Path, out: Path, names: Sequence[str], processes: int) -> None:
    """Have the program of a checkout diagnose the cases that it has not answered yet.

    Raises:
        SystemExit: a process failed.
    """
    left = [name for name in names if not (out / name / "status").exists()]
    if len(left) < len(names):
        print(f"{len(names) - len(left)} of {len(names)} are answered already in {out}", file=sys.stderr, flush=True)
    if not left:
        return
    environment = {**os.environ, "PYTHONPATH": str(checkout), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    running = []
    for first in range(min(processes, len(left))):
        words = [str(checkout), str(cases), str(out), ",".join(names), *left[first::processes]]
        running.append(subprocess.Popen([sys.executable, "-c", ASKING, *words], cwd=checkout, env=environment, stdout=sys.stderr))
    if any([process.wait() for process in running]):
        raise SystemExit(f"same_answers: the program in {checkout} failed on one of its cases")
