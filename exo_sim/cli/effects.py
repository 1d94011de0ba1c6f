"""List the effects beyond the paper, or print the page of one."""

from __future__ import annotations

from pathlib import Path

import click

from exo_sim.cli import printing
from exo_sim.cli.frame import verb


@verb("exo-sim effects", "exo-sim effects wall_heat_transfer", out="File for the list or the page; stdout when absent.")
@click.argument("name", required=False)
def command(name: str | None, out: Path | None, as_json: bool, quiet: bool) -> None:
    """List the effects with one line each, or print the page of the effect NAME: numbers, signature, rig text."""
    from exo_sim.errors import RigError, nearest
    from exo_sim.physics.declaration import declared
    from exo_sim.rig import effect_page
    from exo_sim.rig.effect_tables import CALIBRATIONS

    known = declared()
    if name is None:
        text = printing.table([[each.name, each.question] for each in known.values()])
        entries = [{"name": e.name, "places": list(e.places), "question": e.question} for e in known.values()]
        printing.show({"schema": "exo-sim/effects/1", "effects": entries}, text, as_json=as_json, out=out)
        return
    if name in CALIBRATIONS:
        raise RigError(f"{name} is a nominal number of the rig, not an effect: change {CALIBRATIONS[name]} in the rig")
    if name not in known:
        raise RigError(f'there is no effect "{name}"{nearest(name, known)}')
    effect = known[name]
    printing.show({"schema": "exo-sim/effects/1", "effect": effect_page.data(effect)}, effect_page.text(effect), as_json=as_json, out=out)
