"""`exo.simulate`: a person walks in the machine, and everything is recorded."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import Columns, Quantity, RigLike, columns_of, payload_of, rig_of
from exo_sim.api.following import MOTIONS, follow, is_motion, nobody_walks
from exo_sim.api.moment import Moment
from exo_sim.api.recording import Recording
from exo_sim.api.simulated import Run, summary_of, target_of
from exo_sim.errors import ScenarioError
from exo_sim.gait import scenario as scenario_files
from exo_sim.outputs import check_writable
from exo_sim.recording import table as table_of

if TYPE_CHECKING:
    from exo_sim.gait.scenario_record import Scenario


def simulate(
    rig: RigLike | None = None, scenario: str | os.PathLike[str] | Recording | None = None, *,
    gait: str | os.PathLike[str] | None = None, ground: str | os.PathLike[str] | None = None, whole: bool = False,
    payload: Quantity | None = None, speed: float | str = 1.0, strides: int | None = None, assist: str = "on", controller: Any = "model",
    demand: str = "least_load", wearer: str | None = None, signals: str = "exact", seed: int = 0,
    out: str | os.PathLike[str] | bool = False, quiet: bool = True,
    tell: Callable[[str], None] = lambda words: None, columns: Columns = None,
) -> Run:  # fmt: skip
    """Simulate a person in the machine, or a machine that nobody wears following a motion.

    Args:
        rig: A path or `exo.Rig`; the worn machine that comes with the package when None.
        scenario: One of `exo.scenarios()`, or a scenario file (`.toml`); "level_walk" when neither it nor `gait` is given. For a machine
            that nobody wears, a recording (path or `exo.Recording`) with the positions of its joints.
        gait: Joint angles to walk by: `.mot`, `.sto`, `.c3d`, or a recording.
        ground: Ground forces of the same trial.
        whole: Walk every stride of `gait` as it was recorded, one after the other, instead of their mean; `strides` then counts trials.
        payload: On the back: kilograms, or text like "75 lb"; what the rig's `[bodies.payload]` says when None, or else 34 kg.
        speed: Factor on the recorded cadence, 0.7 to 1.3, strides staying as long; or text like "1.3 m/s", for which strides get longer
            and quicker as people's do.
        strides: How many strides or repetitions; the scenario's own number when None.
        assist: "on"; "off": valves closed; "vented": both chambers open to the atmosphere.
        controller: How valves get forces: "model" inverts the gas equations, "pi" is plain PI; or a controller of your own, as an object
            with `reset(context)` and `act(observation)`, or as "FILE.py:NAME".
        demand: Law that gives the joint torques demanded: "least_load", "causal" (from what the machine itself measures),
            "inverse_dynamics" or "virtual_support".
        wearer: "prescribed" (the default, where a scenario file does not say otherwise): the wearer's motion is given whatever happens;
            "torques": he is a body with mass on his own feet, moved by torques, and yields to the straps.
        signals: What "model" and "pi" go by: "exact" (what is), or "measured" (what noisy pressure gauges and encoders show; nothing
            measures the temperature of the gas).
        seed: Travels with the recording, is handed to a controller of your own, and is where the noise of signals starts.
        out: Where the recording for the viewer (`.rrd`) is written while it runs, with its table beside it; memory then does not grow
            with length. True names it after what is done, in the folder that you are in; False keeps the run in memory.
        quiet: No progress.
        tell: Takes remarks as soon as they are known.
        columns: Foreign names in the table of a gait or a motion: a column map (TOML) or a dictionary.

    Raises:
        ScenarioError, RecordingError, RigError, ModelError: it cannot be carried out; one line each.
        Diverged: the simulation left the range of numbers that mean anything, or the machine fell.
    """
    from exo_sim.control import user_controller
    from exo_sim.machine.worn_model import is_worn
    from exo_sim.simulation import streamed_run
    from exo_sim.simulation.summary import summarise
    from exo_sim.simulation.walk import Request
    from exo_sim.simulation.worn import Simulation

    machine = rig_of(rig)
    mass = payload_of(machine, payload)
    if isinstance(controller, str):
        brought, called = user_controller.load(controller) if user_controller.is_path(controller) else controller, controller
    else:
        brought = user_controller.of(controller)
        called = type(brought).__name__
    if is_motion(scenario) and not is_worn(machine):
        nobody_walks(
            machine, gait=gait, ground=ground, whole=whole, payload=payload, speed=speed, strides=strides, assist=assist, demand=demand,
            wearer=wearer, signals=signals,
        )  # fmt: skip
        return follow(machine, scenario, brought, called, out, seed, quiet, tell, columns)  # type: ignore[arg-type]
    name, given = what_to_do(scenario, gait, ground, whole, columns)
    target = target_of(out, name)
    mine = None if isinstance(brought, str) else brought
    request = Request(
        name, payload=mass, speed=speed, cycles=strides, assist=assist, controller=called, law=demand, given=given, wearer=wearer,
        signals=signals, driven="" if mine is None else "valves",
    )  # fmt: skip
    if target is not None:
        import pyarrow.parquet  # noqa: F401 - both now, so that their start is not taken for work
        import rerun  # noqa: F401
    begun = Moment.now()
    if target is not None:
        check_writable(target.parent)
    of_gait = () if given is None else given.remarks
    for words in of_gait:  # now: what cannot be walked is often a gait of which they tell
        tell(words)
    simulation = Simulation(machine, request, mine, seed)
    prepared = Moment.now()
    before = simulation.remarks
    for words in before:
        if words not in of_gait:
            tell(words)
    walk = None
    if target is None:
        walk = simulation.run(quiet)
        numbers, interrupted = summarise(walk), walk.interrupted
    else:
        numbers, interrupted = streamed_run.run(simulation, target, target.with_suffix(".parquet"), seed, quiet)
    for words in simulation.remarks[len(before) :]:  # what only the run showed, of a controller's commands
        tell(words)
    if simulation.unreliable is not None:
        numbers["unreliable"] = simulation.unreliable
    summary = summary_of(numbers, begun, prepared, simulation.remarks)
    return Run(machine, name, summary, simulation.remarks, target, interrupted, walk, seed)


def what_to_do(
    scenario: str | os.PathLike[str] | Recording | None, gait: str | os.PathLike[str] | None, ground: str | os.PathLike[str] | None,
    whole: bool = False, columns: Columns = None,
) -> tuple[str, Scenario | None]:
    """Return what a run is called, and the scenario where it is no built-in one.

    Raises:
        ScenarioError: both a scenario and a gait were named, a ground or columns without a gait, or the files cannot be read.
    """
    from exo_sim.gait import own_gait, scenario_file
    from exo_sim.recording.column_map import read_column_map

    if isinstance(scenario, table_of.Recording):
        raise ScenarioError("a motion in memory is for machines that nobody wears; save a gait to a file and name it with gait")
    if scenario is not None and gait is None and Path(scenario).suffix.lower() in (*MOTIONS, ".mot", ".sto", ".c3d"):
        gait, scenario = scenario, None  # a person's motion
    if gait is not None:
        if scenario is not None:
            raise ScenarioError(f'"{scenario}" and --gait {gait}: name one; a scenario file with a [gait] table holds more settings')
        foreign = columns_of(columns)
        if foreign is not None and Path(gait).suffix.lower() not in MOTIONS:
            raise ScenarioError(
                f'{gait}: a column map is for tables; labels are named in the [gait] table of a scenario file, like knee_l = "coordinate7"'
            )
        read = read_column_map(foreign) if isinstance(foreign, Path) else foreign
        beside = None if ground is None else Path(ground)
        return Path(gait).stem, own_gait.scenario(own_gait.GaitFile(Path(gait), beside, columns=read, whole=whole))
    if columns is not None:
        raise ScenarioError("columns: name the gait or the motion whose columns they are; a scenario file has a table [gait.columns]")
    if ground is not None:
        raise ScenarioError(f"--ground {ground}: name the gait that it belongs to with --gait")
    if whole:
        raise ScenarioError("whole: name the gait that is to be walked through; a scenario file says whole = true in its [gait] table")
    name = os.fspath(scenario) if scenario is not None else "level_walk"
    if name.lower().endswith(".toml"):
        return Path(name).stem, scenario_file.read(name)
    return name, None


def scenarios() -> dict[str, str]:
    """Return the names of all scenarios, each with one line that says what is done."""
    return {name: scenario_files.find(name).summary for name in scenario_files.names()}


