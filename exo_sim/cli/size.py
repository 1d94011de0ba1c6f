"""Search actuator sizes against joint loads; writes a rig that runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from exo_sim.cli import options, printing
from exo_sim.cli.frame import verb

#: Options that ask something of a wearer or of the search for a worn machine.
_WORN_ONLY = {
    "scenarios": "--scenario", "payloads": "--payload", "speeds": "--speed", "reach": "--reach", "travel": "--travel",
    "springs": "--springs", "valves": "--valves", "tank": "--tank", "heights": "--height", "robust": "--robust", "own_mass": "--own-mass",
    "scheduler": "--scheduler", "quick": "--quick",
}  # fmt: skip


def _given(options: dict[str, str]) -> list[str]:
    """Return which of some options stand on the command line, as they are written there."""
    context = click.get_current_context()
    return [said for name, said in options.items() if context.get_parameter_source(name) is ParameterSource.COMMANDLINE]


@verb(
    'exo-sim size --scenario level_walk --payload "34 kg" --out sized',
    'exo-sim size --scenario level_walk --scenario squat --payload "20 kg" --payload "34 kg" --trials 1000 --jobs 8',
    "exo-sim size --catalogue smc --joints knee_l,knee_r",
    'exo-sim size --catalogue mine.toml --fix supply="7 bar" --fix hip.bore="40 mm"',
    'exo-sim size --valves independent --tank "2 l" --travel task --robust',
    "exo-sim size --motion motion.csv --rig bench.toml --out sized",
    "exo-sim size --quick",
    "exo-sim run level_walk --rig sized/sized.toml",
    out="Folder for sized.toml, report.html, sized.rrd and the journal of the search; sized when absent.",
    seed=True,
)
@click.option("--scenario", "scenarios", multiple=True, default=("level_walk",), show_default=True,
              help="What the machine must do; may be given again.")
@click.option("--payload", "payloads", multiple=True, type=options.Quantity("kg", low=0.0), default=("34 kg",),
              show_default=True, help="Mass on the back; may be given again.")
@click.option("--speed", "speeds", multiple=True, type=float, default=(1.0,), show_default=True,
              help="Factor on the recorded cadence, 0.7 to 1.3; may be given again.")
@click.option("--rig", type=options.RigFile(), default=None,
              help="The machine, with what a diagnosis found of it; when absent exo_250_psi, whose frame carries no cylinder yet.")
@click.option("--motion", type=options.InputFile(), default=None,
              help="For a machine that nobody wears (--rig): a recording with the positions of its joints, and forces from outside if any.")
@click.option("--trials", type=click.IntRange(1, 1000000), default=None,
              help="Designs to look at; 800, or 100 along a motion, when absent.")
@click.option("--reach", type=options.Quantity("m", low=0.0, high=0.2, usual="mm"), default="40 mm", show_default=True,
              help="How far an attachment point may move from where the rig has it.")
@click.option("--pressure-limit", type=options.Quantity("Pa", low=0.0, usual="bar"), default=None,
              help="Largest pressure of supply and chambers, absolute; when absent 10 bar above "
                   "the atmosphere, for which the catalogue's are rated.")
@click.option("--joints", "only", default=None, help="Joints to size, like knee_l,knee_r; all that have cylinders when absent.")
@click.option("--catalogue", type=options.CatalogueFile(), default=None,
              help="TOML file with [[cylinder]] and [[valve]] to choose from, or a maker's that comes along; the standards' when absent.")
@click.option("--fix", "fixes", multiple=True, metavar='NAME="VALUE"',
              help='Not to be chosen: supply="7 bar", hip.bore="40 mm", hip.valve="8 mm^2", hip.from="200 mm" or hip.to; may be repeated.')
@click.option("--travel", type=click.Choice(["joint", "task"]), default="joint", show_default=True,
              help="Strokes cover the joints' whole range, or what the tasks ask for and 10 degrees more, with stops there.")
@click.option("--springs", is_flag=True, help="A spring may stand beside each rod; for valves with independent edges.")
@click.option("--valves", type=options.Choice(["rig", "independent"]), default="rig", show_default=True,
              help="The rig's, or valves that open each chamber's edges by a command of their own: far less gas.")
@click.option("--tank", type=options.Quantity("m^3", low=0.0, high=1.0, usual="l"), default=None,
              help='Volume of a recovery tank like "2 l", its pressure is chosen; for independent edges. The rig\'s own when absent.')
@click.option("--height", "heights", multiple=True, type=options.Quantity("m", low=0.5, high=3.0),
              help='Of the wearer, like "1.60 m", mass by the same body mass index; may be given again. The rig\'s when absent.')
@click.option("--robust", is_flag=True,
              help="A short and fast, a tall and slow, and an unladen wearer count as well; disturbances of the walk, too.")
@click.option("--own-mass", is_flag=True,
              help="The bodies carry the actuators' and the tank's own mass: that of the smallest which suffice.")
@click.option("--jobs", type=click.IntRange(-1), default=-1, show_default=True,
              help="Processes, one thread each; -1: one a core.")
@click.option("--scheduler", default=None, help="Address of a Dask scheduler, tcp://HOST:PORT, to score designs on its workers.")
@click.option("--quick", is_flag=True, help="No search: the paper's design equations (35 to 39) by hand.")
def command(scenarios: tuple[str, ...], payloads: tuple[float, ...], speeds: tuple[float, ...], rig: Path | None,
            motion: Path | None, trials: int | None, reach: float, pressure_limit: float | None, only: str | None, catalogue: Path | None,
            fixes: tuple[str, ...], travel: str, springs: bool, valves: str,
            tank: float | None, heights: tuple[float, ...], robust: bool, own_mass: bool,
            jobs: int, scheduler: str | None, quick: bool, out: Path | None,
            as_json: bool, quiet: bool, seed: int) -> None:  # fmt: skip
    """Search bores, rods, strokes, attachment points, valves and supply against the joint loads of what the machine must do.

    Finished designs are kept in the folder: the same command goes on where it was interrupted.
    """
    from exo_sim.api.sizing import question
    from exo_sim.api.sizing import size as search
    from exo_sim.errors import ScenarioError
    from exo_sim.simulation.walk import rig_at_250_psi
    from exo_sim.sizing import summary_text

    if jobs == 0:
        raise ScenarioError("--jobs 0: give a number of processes, or -1 for one a core")
    if quick and out is not None:
        raise ScenarioError("--quick writes no files: leave --out away, or --quick")
    if motion is not None and rig is None:
        raise ScenarioError("--motion: name the machine with --rig")
    if motion is not None and (worn := _given(_WORN_ONLY)):
        verb_form = "is" if len(worn) == 1 else "are"
        raise ScenarioError(f"--motion: {', '.join(worn)} {verb_form} for machines that are worn: leave away one or the other")
    joints = tuple(name.strip() for name in (only or "").split(",") if name.strip())
    if only is not None and not joints:
        raise ScenarioError(f'--joints "{only}": name at least one, like knee_l,knee_r, or leave it away for all')
    asked: dict[str, Any] = dict(
        scenarios=scenarios, payloads=payloads, speeds=speeds, reach=reach, pressure_limit=pressure_limit, catalogue=catalogue, fix=fixes,
        travel=travel, springs=springs, own_mass=own_mass, heights=heights, robust=robust, valves=valves, tank=tank,
        joints=joints,
    )  # fmt: skip
    if quick:
        from exo_sim.sizing.hand_calculation import joint_by_hand, papers_example

        found = question(rig or rig_at_250_psi(), **asked)
        example = papers_example()
        by_joint = {
            f"{kind.name}, {one.condition}": joint_by_hand(found.machine, kind, one, pressure_limit)
            for one in found.loads
            for kind in found.space.kinds
        }
        printing.show(summary_text.by_hand_numbers(example, by_joint), summary_text.by_hand_words(example, by_joint), as_json=as_json)
        return
    result = search(
        rig or rig_at_250_psi(), **asked, motion=motion, trials=trials, jobs=jobs, scheduler=scheduler, seed=seed, out=out or Path("sized"),
        quiet=quiet, tell=lambda words: printing.remark(words, quiet=quiet),
    )  # fmt: skip
    printing.show(result.summary, str(result), as_json=as_json)
