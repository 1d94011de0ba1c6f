"""List what a person can do in the machine."""

from __future__ import annotations

from pathlib import Path

from exo_sim.cli import printing
from exo_sim.cli.frame import verb


@verb("exo-sim scenarios", out="File for the list; stdout when absent.")
def command(out: Path | None, as_json: bool, quiet: bool) -> None:
    """List the scenarios with one line each. One of your own is a .toml file (docs/your_gait.md)."""
    from exo_sim.gait import scenario

    found = {name: scenario.find(name) for name in scenario.names()}
    data = {
        "schema": "exo-sim/scenarios/1",
        "scenarios": [
            {"name": name, "summary": one.summary, "cycle": one.cycle, "cycles": one.cycles}
            for name, one in found.items()
        ],
    }
    text = printing.table([[name, one.summary] for name, one in found.items()])
    printing.show(data, text, as_json=as_json, out=out)
