"""Simulate a person in the machine and record everything."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from exo_sim.cli import compiling, options, printing
from exo_sim.cli.frame import verb


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
@click.option("--columns", type=options.InputFile(), default=None, help="Column map (TOML) for foreign names in a table of angles.")
@click.option("--whole", is_flag=True, help="Walk every stride of --gait as it was recorded, not the mean of them.")
@click.option(
    "--payload", type=options.Quantity("kg", low=0.0), default=None,
    help="Mass on the back; when absent what the rig's [bodies.payload] says, else 34 kg.",
)
@click.option("--speed", default="1.0", show_default=True, help='Factor on the recorded cadence, 0.7 to 1.3, or a speed like "1.3 m/s".')
@click.option("--strides", type=click.IntRange(1, 10000), default=None, help="Strides or repetitions; the scenario's when absent.")
@click.option(
    "--assist",
    type=options.Choice(["on", "off", "vented"]),
    default="on",
    show_default=True,
    help="on: valves driven; off: valves closed; vented: both chambers open to the atmosphere.",
)
@click.option(
    "--controller",
    type=options.ControllerName(),
    default="model",
    show_default=True,
    help="Turns wanted forces into valve commands: model (the gas equations inverted) or pi; or FILE.py:NAME, a class of your own.",
)
@click.option(
    "--demand",
    type=options.Choice(["least_load", "causal", "inverse_dynamics", "virtual_support"]),
    default="least_load",
    show_default=True,
    help="Which joint torques are wanted: least_load knows the wearer's motion beforehand, causal only what the machine measures.",
)
@click.option(
    "--wearer",
    type=options.Choice(["prescribed", "torques"]),
    default=None,
    help="prescribed (the default): the wearer's motion is given; torques: he is a body on his own feet that yields to the straps.",
)
@click.option(
    "--signals",
    type=options.Choice(["exact", "measured"]),
    default="exact",
    show_default=True,
    help="What model and pi are given: the true state, or what noisy gauges and encoders show, without temperatures.",
)
@click.option("--rig", type=options.RigFile(), default=None, help="The machine; exo when absent.")
def command(scenario: str | None, gait: Path | None, ground: Path | None, columns: Path | None, whole: bool,
            payload: float | None, speed: str, strides: int | None, assist: str, controller: str, demand: str, wearer: str | None,
            signals: str, rig: Path | None, out: Path | None, as_json: bool, quiet: bool, seed: int) -> None:  # fmt: skip
    """Simulate SCENARIO headless: a name of `exo-sim scenarios`, a scenario file (.toml) from anywhere, or a gait of your own (--gait).

    A machine that nobody wears follows a motion instead: SCENARIO is then a recording with the positions of its joints.

    Exit status: 0; 2 for unusable input; 5 where the simulation left all bounds, or the machine falls away from its wearer.
    """
    from exo_sim.cli.loading import uncollected
    from exo_sim.errors import ScenarioError

    if scenario is None and gait is None:
        if ground is not None:
            raise ScenarioError(f"--ground {ground}: name the gait that it belongs to with --gait")
        raise ScenarioError("name a scenario (see `exo-sim scenarios`), a scenario file, or a gait of your own with --gait FILE")
    with uncollected():
        import pyarrow.parquet  # noqa: F401 - all that a run needs, now: what is loaded later is gone through again and again
        import rerun  # noqa: F401

        import exo_sim.simulation.streamed_run  # noqa: F401
        from exo_sim.api.simulating import simulate
        from exo_sim.cli.run_motion import motion_words

    with printing.prints_on_stderr(), compiling.announced(quiet) as aside:
        done = simulate(
            rig, scenario, gait=gait, ground=ground, columns=columns, whole=whole, payload=payload, speed=speed, strides=strides,
            assist=assist, controller=controller, demand=demand, wearer=wearer, signals=signals, seed=seed, out=out or True, quiet=quiet,
            tell=lambda words: aside(lambda: printing.remark(f"exo-sim: {words}", quiet=quiet)),
        )  # fmt: skip
    numbers = dict(done.summary)
    first = {key: numbers.pop(key) for key in ("schema", "scenario", "simulated_s", "wall_s", "prepared_s", "compiled_s")}
    data = {**first, "recording": done.path, "table": done.table, **numbers}
    printing.show(data, (_words if "wearer" in data else motion_words)(data), as_json=as_json)
    if done.interrupted:
        raise KeyboardInterrupt(f"{data['simulated_s']:.2f} s were simulated and are in {done.path} and {done.table}")


def _words(data: dict[str, Any]) -> str:
    """Return the result as a short report."""
    from exo_sim.simulation import gas_use

    straps, wearer = data["strap_load_n"], data["wearer"]
    carried = data["mean_ground_force_n"] + straps["vertical_mean"]
    pace = data["simulated_s"] / data["wall_s"]
    lines = [
        *([data["unreliable"], ""] if "unreliable" in data else []),
        f"{data['scenario']}: {data['simulated_s']:.2f} s simulated in {data['wall_s']:.2f} s, "
        f"{pace:.{0 if pace >= 10.0 else 2}f} times real time "
        f"(prepared in {data['prepared_s']:.2f} s{printing.compiling(data['compiled_s'])})",
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
    lines += [_ledger(data), ""] if "compared_with" in data else []
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
        if "gas" in data:
            lines += [*gas_use.words(data["gas"]), ""]
        books = data["books"]
        lines += [*(f"warning: {one}" for one in data.get("warnings", ())), *([""] if data.get("warnings") else [])]
        lines += [f"conservation error, relative: gas mass {books['gas_mass_residual']:.0e}, energy {books['gas_energy_residual']:.0e}"]
    return "\n".join([*lines, f"recording {data['recording']}, table {data['table']}"])


def _ledger(data: dict[str, Any]) -> str:
    """Return what the wearer gives, alone, with the payload as a backpack and with the machine, and where the work goes."""
    wearer, ledger, others = data["wearer"], data["ledger"], data["compared_with"]
    cost, residual = wearer["metabolic_w"], wearer["pelvis_residual"]
    ground = ledger["ground"] + ledger.get("soles", 0.0)
    columns = [
        others["no_machine"], others["backpack"],
        {**wearer, "metabolic_w": cost["value"], "metabolic_low_w": cost["low"], "metabolic_high_w": cost["high"],
         "wearer_joints": ledger["wearer_joints"]},
    ]  # fmt: skip

    def row(words: str, value: Callable[[dict[str, Any]], str]) -> list[str]:
        return [words, *(value(column) for column in columns)]

    rows = [
        row("metabolic power, estimated, W", lambda it: f"{it['metabolic_w']:.0f}"),
        row("  bounds of the estimate, W", lambda it: f"{it['metabolic_low_w']:.0f}-{it['metabolic_high_w']:.0f}"),
        row("trunk leans forward, deg", lambda it: f"{it['trunk_lean_deg']:.1f}"),
    ]
    for name in ("hip", "knee", "ankle"):
        rows += [
            row(f"{name}: moment, N m rms", lambda it, name=name: f"{it['moment_rms_nm'][name]:.0f}"),  # type: ignore[misc]
            row(f"{name}: work, J a cycle", lambda it, name=name: "{:+.0f} {:+.0f}".format(*it["wearer_joints"][name])),  # type: ignore[misc]
        ]
    rows.append(row("foot below the ankle: work, J a cycle", lambda it: "{:+.0f} {:+.0f}".format(*it["wearer_joints"]["foot"])))
    strapped = ", ".join(f"{name} {force['rms']:.0f} ({force['peak']:.0f})" for name, force in wearer["strap_force_n"].items())
    rows.append(row("residual at the pelvis, N m rms", lambda it: f"{it['pelvis_residual']['moment_rms_nm']:.1f}"))
    straps = ", ".join(f"{name} {work:+.1f}" for name, work in ledger["straps"].items())
    return "\n".join([
        printing.table(rows, ["the wearer", "alone", "backpack", "machine"]),
        f"forward push on the machine {wearer['forward_push_n']:.0f} N, power given to it {wearer['power_to_machine_w']:.0f} W; "
        f"residual at the pelvis {residual['force_peak_n']:.0f} N and {residual['moment_peak_nm']:.0f} N m at most",
        f"force of the straps on a segment, N rms (peak): {strapped}",
        f"work, J a cycle: cylinders {ledger['cylinders'][0]:+.0f} {ledger['cylinders'][1]:+.0f}, straps {straps}, "
        f"damping {ledger['machine_damping']:+.0f}, ground {ground:+.0f}; closes to {ledger['closure']:+.2f}",
    ])  # fmt: skip
