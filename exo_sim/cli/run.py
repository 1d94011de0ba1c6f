"""Simulate a person in the machine and record everything."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb

if TYPE_CHECKING:
    from exo_sim.gait.scenario import Scenario

#: Endings of recordings, which hold a motion.
MOTIONS = (".csv", ".tsv", ".txt", ".parquet", ".pq", ".rrd")


@verb(
    'exo-sim run level_walk --payload "34 kg"',
    'exo-sim run --gait walk.mot --ground forces.mot --speed "1.2 m/s" --out mine.rrd',
    'exo-sim run level_walk --controller mine.py:Impedance',
    "exo-sim run motion.csv --rig bench.toml",
    'exo-sim run squat --payload "20 kg" --strides 3 --assist vented --out squat.rrd --json',
    out="Recording for the viewer (.rrd); the table goes beside it as .parquet. SCENARIO.rrd when absent.",
    seed=True,
)
@click.argument("scenario", required=False)
@click.option("--gait", type=options.InputFile(), default=None, help="Walk as in these joint angles: .mot, .sto, .c3d, or a recording.")
@click.option("--ground", type=options.InputFile(), default=None, help="Ground forces of the same trial, beside --gait.")
@click.option(
    "--payload", type=options.Quantity("kg", low=0.0), default="34 kg", show_default=True, help="On the back."
)
@click.option("--speed", default="1.0", show_default=True, help='Factor on the recorded cadence, 0.7 to 1.3, or a speed like "1.3 m/s".')
@click.option("--strides", type=click.IntRange(1, 10000), default=None, help="How many strides or repetitions.")
@click.option(
    "--assist",
    type=options.Choice(["on", "off", "vented"]),
    default="on",
    show_default=True,
    help="vented: both chambers open to the atmosphere; off: valves closed.",
)
@click.option(
    "--controller",
    type=options.ControllerName(),
    default="model",
    show_default=True,
    help="How valves get forces: model (the gas equations inverted) or pi; or FILE.py:NAME, a class of your own.",
)
@click.option(
    "--demand",
    type=options.Choice(["least_load", "inverse_dynamics", "virtual_support"]),
    default="least_load",
    show_default=True,
    help="Law by which joint torques are asked for.",
)
@click.option("--rig", type=options.InputFile(), default=None, help="The machine; the one in assets/ when absent.")
def command(scenario: str | None, gait: Path | None, ground: Path | None, payload: float, speed: str,
            strides: int | None, assist: str, controller: str, demand: str, rig: Path | None, out: Path | None, as_json: bool,
            quiet: bool, seed: int) -> None:  # fmt: skip
    """Simulate SCENARIO headless: a name of `exo-sim scenarios`, a scenario file (.toml) from anywhere, or a gait of your own (--gait).

    A machine that nobody wears follows a motion instead: SCENARIO is then a recording with the positions of its joints.
    """
    import gc
    import time

    import pyarrow.parquet  # noqa: F401 - both now, so that their start is not taken for work
    import rerun  # noqa: F401

    from exo_sim import rig as rigs
    from exo_sim.cli import run_motion
    from exo_sim.control import own
    from exo_sim.errors import OutputError
    from exo_sim.machine.build import is_worn
    from exo_sim.outputs import check_writable
    from exo_sim.simulation import kept
    from exo_sim.simulation.coupled import Simulation
    from exo_sim.simulation.walk import Request, default_rig

    machine = rigs.read(rig or default_rig())
    if scenario is not None and gait is None and Path(scenario).suffix.lower() in MOTIONS and not is_worn(machine):
        run_motion.command(machine, Path(scenario), controller, out, as_json, quiet, seed)
        return
    if scenario is not None and gait is None and Path(scenario).suffix.lower() in (*MOTIONS, ".mot", ".sto", ".c3d"):
        gait, scenario = Path(scenario), None  # a person's motion
    name, given = _what(scenario, gait, ground)
    path = out or Path(f"{name}.rrd")
    if path.suffix.lower() != ".rrd":
        raise OutputError(f'cannot write "{path}": a recording for the viewer ends in .rrd')
    brought = own.load(controller) if own.is_path(controller) else None
    request = Request(
        name, payload=payload, speed=speed, cycles=strides, assist=assist, controller=controller, law=demand, given=given,
        driven="valves" if brought is not None else "",
    )  # fmt: skip
    gc.freeze()  # what was imported stays: it need not be gone through again and again
    begun = time.perf_counter()
    check_writable(path.parent)
    simulation = Simulation(machine, request, brought, seed)
    gc.freeze()  # and so does what was prepared
    prepared = time.perf_counter()
    for words in simulation.remarks:
        printing.remark(f"exo-sim: {words}", quiet=quiet)
    beside = path.with_suffix(".parquet")
    numbers, interrupted = kept.run(simulation, path, beside, seed, quiet)
    data = {
        "schema": numbers.pop("schema"),
        "scenario": numbers.pop("scenario"),
        "simulated_s": numbers.pop("simulated_s"),
        "wall_s": time.perf_counter() - prepared,
        "prepared_s": prepared - begun,
        "recording": path,
        "table": beside,
        **numbers,
        **({"remarks": list(simulation.remarks)} if simulation.remarks else {}),
    }
    printing.show(data, _words(data), as_json=as_json)
    if interrupted:
        raise KeyboardInterrupt(f"{data['simulated_s']:.2f} s were simulated and are in {path} and {beside}")


def _what(scenario: str | None, gait: Path | None, ground: Path | None) -> tuple[str, Scenario | None]:
    """Return what the run is called, and the scenario where it is no built-in one.

    Raises:
        ScenarioError: neither or both were named, or the files cannot be read.
    """
    from exo_sim.errors import ScenarioError
    from exo_sim.gait import own_gait, scenario_file

    if gait is not None:
        if scenario is not None:
            raise ScenarioError(f'"{scenario}" and --gait {gait}: name one; a scenario file with a [gait] table holds more settings')
        return gait.stem, own_gait.scenario(own_gait.GaitFile(gait, ground))
    if ground is not None:
        raise ScenarioError(f"--ground {ground}: name the gait that it belongs to with --gait")
    if scenario is None:
        raise ScenarioError("name a scenario (see `exo-sim scenarios`), a scenario file, or a gait of your own with --gait FILE")
    if scenario.lower().endswith(".toml"):
        return Path(scenario).stem, scenario_file.read(scenario)
    return scenario, None


def _words(data: dict[str, Any]) -> str:
    """Return the result as a short report."""
    straps, wearer = data["strap_load_n"], data["wearer"]
    carried = data["mean_ground_force_n"] + straps["vertical_mean"]
    lines = [
        f"{data['scenario']}: {data['simulated_s']:.2f} s simulated in {data['wall_s']:.2f} s, "
        f"{data['simulated_s'] / data['wall_s']:.0f} times real time (prepared in {data['prepared_s']:.2f} s)",
        f"weight of frame and payload {data['supported_weight_n']:.1f} N; ground and straps carry {carried:.1f} N, "
        f"the ground {100 * data['mean_ground_force_n'] / data['supported_weight_n']:.0f} %",
        f"torso straps, up: mean {straps['torso_vertical_mean']:.0f} N, rms {straps['torso_rms']:.0f} N, "
        f"peak {straps['torso_peak']:.0f} N",
        "",
    ]
    extra, backpack = wearer["extra_moment_rms_nm"], wearer["backpack_moment_rms_nm"]
    rows = [[f"extra moment at the wearer's {name}, N m rms", f"{extra[name]:.1f}", f"{backpack[name]:.1f}"]
            for name in extra]  # fmt: skip
    lines += [printing.table(rows, ["", "machine", "backpack"]), ""]
    joints = [
        [name, f"{one['torque_peak_nm']:.0f}", f"{one['torque_rms_nm']:.1f}", f"{one['torque_error_rms_nm']:.1f}"]
        for name, one in data["joints"].items()
    ]
    lines += [printing.table(joints, ["joint", "peak N m", "rms N m", "error rms N m"]), ""]
    if "cylinders" in data:
        rows = [
            [name, f"{one['pressure_peak_pa'] / 1e5:.1f}", f"{100 * one['choked_share']:.0f}",
             f"{1e3 * one['gas_kg_per_stride']:.2f}"]
            for name, one in data["cylinders"].items()
        ]  # fmt: skip
        lines += [printing.table(rows, ["cylinder", "peak bar", "paths choked %", "gas g a cycle"]), ""]
        books = data["books"]
        lines += [f"books: gas mass {books['gas_mass_residual']:.0e}, energy {books['gas_energy_residual']:.0e}"]
    return "\n".join([*lines, f"recording {data['recording']}, table {data['table']}"])
