"""Check what works here: packages, graphics, compiled code."""

from __future__ import annotations

from pathlib import Path

from exo_sim.cli import printing
from exo_sim.cli.frame import verb


@verb("exo-sim doctor", "exo-sim doctor --json", out="File for the list; stdout when absent.")
def command(out: Path | None, as_json: bool, quiet: bool) -> int:
    """Check what is installed, what is missing and what works; each line that is not "ok" says what to do.

    Exit status: 0 where everything that the verbs need works, 2 where a required package is missing or of a wrong version.
    """
    from exo_sim.api.doctor import doctor

    found = doctor()
    printing.show(found.summary, str(found), as_json=as_json, out=out)
    return found.exit_status
