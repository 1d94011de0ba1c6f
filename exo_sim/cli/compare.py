"""Simulate what was recorded and show both; no naming."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb

if TYPE_CHECKING:
    from exo_sim.recording import Recording
    from exo_sim.simulation.replay import Replay

#: Samples of a recording that the viewer is given; errors count all of them.
_MOST_SHOWN = 400_000


@verb(
    "exo-sim compare bench.csv --rig rig.toml",
    "exo-sim compare fresh.parquet --rig found/improved.toml --out fresh.rrd --json",
    out="Recording for the viewer (.rrd), recorded and simulated overlaid; RECORDING_compared.rrd when absent.",
)
@click.argument("recording", type=options.InputFile())
@click.option("--rig", type=options.InputFile(), required=True, help="The machine as it is believed to be.")
@click.option("--columns", type=options.InputFile(), default=None, help="Column map (TOML) for foreign names.")
@click.option(
    "--motion",
    type=options.Choice(["auto", "predicted", "recorded"]),
    default="auto",
    show_default=True,
    help="Whether positions are predicted too, or led as recorded; auto leads them where unmeasured forces moved them.",
)
def command(
    recording: Path, rig: Path, columns: Path | None, motion: str, out: Path | None, as_json: bool, quiet: bool
) -> None:
    """Hold RECORDING, a .csv, .parquet or .rrd file, against what the rig would have done.

    Every measured pressure and position is predicted twice: over windows of 0.5 s, each from the measured state, and in
    one run from the first.
    """
    from exo_sim import rig as rigs
    from exo_sim.conventions import settle
    from exo_sim.errors import Diverged, OutputError
    from exo_sim.machine.load import load
    from exo_sim.outputs import check_writable
    from exo_sim.progress import Bar
    from exo_sim.recording import read, write_rrd
    from exo_sim.simulation import replay as replays

    path = out or Path(f"{recording.stem}_compared.rrd")
    if path.suffix.lower() != ".rrd":
        raise OutputError(f'cannot write "{path}": a recording for the viewer ends in .rrd')
    check_writable(path.parent)
    reading = read(recording, columns)
    machine = rigs.read(rig)
    model = load(machine)
    replays.check_belongs(reading.recording, machine, model)
    settled = settle(reading.recording, machine, model)
    recorded, odd = replays.usable(settled.recording, machine, model)
    with Bar(1.0, "simulating", "of it", quiet) as bar:
        replay = replays.replay(recorded, machine, model, motion=motion, progress=bar.to)
    signals = errors(recorded, replay)
    if lost := [key for key, one in signals.items() if not math.isfinite(one["windowed_rms"])]:
        raise Diverged(
            f'"{recording}": within {replays.WINDOW:g} s of measured states the simulation left all bounds, first of {lost[0]}; look '
            f"at the numbers of {rig} and its MJCF with exo-sim inspect --rig, or try a shorter timestep"
        )
    overlays = {"simulated": replay.windowed.thinned(_MOST_SHOWN), "free_run": replay.free_run.thinned(_MOST_SHOWN)}
    write_rrd(path, settled.recording.thinned(_MOST_SHOWN), overlays=overlays)
    asked = [check.says for check in settled.checks]
    remarks = [*asked, *(finding.says for finding in [*reading.findings, *odd] if finding.severity != "info"), *replay.remarks]
    for words in remarks:
        printing.remark(f"exo-sim: {words}", quiet=quiet)
    data = {
        "schema": "exo-sim/compare/1",
        "measure": replay.measure,
        "signal": signals,
        "motion": "recorded" if replay.imposed else "predicted",
        "remarks": remarks,
        "checks": [check.as_dict() for check in settled.checks],
        "recording": recording,
        "rig": rig,
        "comparison": path,
    }
    printing.show(data, _words(data), as_json=as_json)


def errors(recording: Recording, replay: Replay) -> dict[str, dict[str, Any]]:
    """Return, for each predicted signal, the errors of both predictions and the sensor's noise."""
    from exo_sim.recording import noise
    from exo_sim.simulation.replay import rms

    return {
        key: {
            "unit": recording.units[key],
            "windowed_rms": rms(recording[key], replay.windowed[key]),
            "free_run_rms": rms(recording[key], replay.free_run[key]),
            "noise": noise.floor(recording[key], recording.time).std,
        }
        for key in replay.windowed.columns
    }


def _words(data: dict[str, Any]) -> str:
    rows = [
        [key, s["unit"], _number(s["windowed_rms"]), _number(s["free_run_rms"]), _number(s["noise"])]
        for key, s in data["signal"].items()
    ]
    return "\n".join(
        [
            printing.table(rows, ["signal", "unit", "0.5 s windows", "free run", "noise"]),
            "",
            f"{data['measure']}.",
            *(["A dash: the simulation left all bounds before the recording's end."] if any("-" in row for row in rows) else []),
            f"recorded and simulated: {data['comparison']} (exo-sim view {data['comparison']})",
        ]
    )


def _number(value: float) -> str:
    return f"{value:.4g}" if value == value else "-"
