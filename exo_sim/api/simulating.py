"""`exo.simulate`: a person walks in the machine, and everything is recorded."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import Columns, Quantity, RigLike, check_target, columns_of, payload_of, reading_of, rig_of
from exo_sim.api.notebook import html_table
from exo_sim.api.recording import Recording
from exo_sim.api.rig import Rig
from exo_sim.errors import RecordingError, ScenarioError
from exo_sim.gait import scenario as scenario_files
from exo_sim.outputs import check_writable
from exo_sim.plain_text import table
from exo_sim.recording import table as table_of

if TYPE_CHECKING:
    from exo_sim.api.figure import Picture
    from exo_sim.gait.scenario import Scenario
    from exo_sim.simulation.unworn import MotionRun
    from exo_sim.simulation.walk import Walk

#: Endings of recordings that a machine can follow.
MOTIONS = (".csv", ".tsv", ".txt", ".parquet", ".pq", ".rrd")

#: What says how somebody walks, as it stands where nobody asked for anything.
_AS_EVER = {
    "gait": None, "ground": None, "whole": False, "payload": None, "speed": 1.0, "strides": None, "assist": "on", "demand": "least_load",
    "wearer": None, "signals": "exact",
}  # fmt: skip
#: What of a joint is printed.
_JOINT = ("torque_peak_nm", "torque_error_rms_nm", "position_error_rms_rad", "position_error_rms_m", "force_peak_n")
#: What `Run.plot` draws where it was recorded.
_SHOWN = ("position", "torque", "torque_demanded", "pressure_1", "pressure_2", "ground_force_z", "strap_force_z")


@dataclass(frozen=True, repr=False)
class Run:
    """A simulation that was run.

    Attributes:
        rig: The machine.
        scenario: What was done.
        summary: What `exo-sim run --json` prints, without file names.
        remarks: Plain sentences, such as that the cylinders cannot carry the payload.
        path: The recording for the viewer where it was written while it ran, its table beside it as `.parquet`; else None.
        interrupted: Whether it was stopped early.
    """

    rig: Rig
    scenario: str
    summary: dict[str, Any]
    remarks: tuple[str, ...]
    path: Path | None
    interrupted: bool
    _done: Walk | MotionRun | None
    _seed: int

    @property
    def table(self) -> Path | None:
        """Return where the table was written while it ran, or None."""
        return None if self.path is None else self.path.with_suffix(".parquet")

    @cached_property
    def recording(self) -> Recording:
        """Return every signal over time, as the rig's sensors show it."""
        from exo_sim.simulation import record, unworn_record
        from exo_sim.simulation.walk import Walk

        if self._done is None:
            assert self.table is not None
            return Recording.load(self.table)
        if isinstance(self._done, Walk):
            return Recording.of(record.recording(self._done, self.scenario, self._seed))
        return Recording.of(unworn_record.recording(self._done, self.scenario, self._seed))

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the run: `.rrd` for the viewer with the scene, and its table beside it as `.parquet`; or a table alone.

        Returns:
            The path.

        Raises:
            OutputError: the ending is another, or it cannot be written.
        """
        target = Path(path)
        if target.suffix.lower() != ".rrd":
            return self.recording.save(target)
        if self._done is None:
            assert self.path is not None and self.table is not None
            for source, goal in ((self.path, target), (self.table, target.with_suffix(".parquet"))):
                _copied(source, goal)
            return target
        from exo_sim.outputs import replacing_all
        from exo_sim.recording import write_rrd, write_table
        from exo_sim.simulation import record, unworn_record
        from exo_sim.simulation.walk import Walk

        scene = record.scene(self._done) if isinstance(self._done, Walk) else unworn_record.scene(self._done)
        with replacing_all(target, target.with_suffix(".parquet")) as (rrd, parquet):
            write_rrd(rrd, self.recording, scene=scene)
            write_table(parquet, self.recording)
        return target

    def plot(self, signals: Sequence[str] | None = None) -> Picture:
        """Draw signals over time; torques, pressures and forces when `signals` is None."""
        from exo_sim.api.plots import panels

        there = {key.rsplit(".", 1)[1] for key in self.recording.columns}
        return panels([("", self.recording)], [name for name in _SHOWN if name in there] if signals is None else signals)

    def _rows(self) -> list[list[str]]:
        straps = self.summary.get("strap_load_n", {})
        rows = [["simulated", f"{self.summary['simulated_s']:.2f} s in {self.summary['wall_s']:.2f} s"]]
        if "supported_weight_n" in self.summary:
            rows.append(["weight of frame and payload", f"{self.summary['supported_weight_n']:.1f} N"])
            rows.append(["ground carries", f"{self.summary['mean_ground_force_n']:.1f} N"])
        if straps:
            rows.append(["torso straps, up", f"{straps['torso_vertical_mean']:.0f} N mean, {straps['torso_rms']:.0f} N rms"])
        for name, one in self.summary.get("joints", {}).items():
            shown = [f"{key.replace('_', ' ')} {one[key]:.3g}" for key in _JOINT if key in one]
            rows.append([name, ", ".join(shown)])
        for name, one in self.summary.get("cylinders", {}).items():
            gas = one.get("gas_kg_per_stride")
            drawn = "" if gas is None else f", {1e3 * gas:.2f} g gas a cycle"
            rows.append([f"cylinder {name}", f"{one['pressure_peak_pa'] / 1e5:.1f} bar peak{drawn}"])
        return rows

    def __str__(self) -> str:
        return f"{self.scenario} in {self.rig.name}\n{table(self._rows())}"

    def __repr__(self) -> str:
        return f"<exo.Run {self.scenario} in {self.rig.name}: {self.summary['simulated_s']:.2f} s>"

    def _repr_html_(self) -> str:
        return html_table(self._rows(), caption=f"{self.scenario} in {self.rig.name}")


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
        demand: Law by which joint torques are asked for: "least_load", "causal" (from what the machine itself measures),
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
    from exo_sim.control import own
    from exo_sim.machine.worn_model import is_worn
    from exo_sim.simulation import streamed_run
    from exo_sim.simulation.summary import summarise
    from exo_sim.simulation.walk import Request
    from exo_sim.simulation.worn import Simulation

    machine = rig_of(rig)
    mass = payload_of(machine, payload)
    if isinstance(controller, str):
        brought, called = own.load(controller) if own.is_path(controller) else controller, controller
    else:
        brought = own.of(controller)
        called = type(brought).__name__
    if _is_motion(scenario) and not is_worn(machine):
        _nobody_walks(
            machine, gait=gait, ground=ground, whole=whole, payload=payload, speed=speed, strides=strides, assist=assist, demand=demand,
            wearer=wearer, signals=signals,
        )  # fmt: skip
        return _follow(machine, scenario, brought, called, out, seed, quiet, tell, columns)  # type: ignore[arg-type]
    name, given = what_to_do(scenario, gait, ground, whole, columns)
    target = _target(out, name)
    mine = None if isinstance(brought, str) else brought
    request = Request(
        name, payload=mass, speed=speed, cycles=strides, assist=assist, controller=called, law=demand, given=given, wearer=wearer,
        signals=signals, driven="" if mine is None else "valves",
    )  # fmt: skip
    if target is not None:
        import pyarrow.parquet  # noqa: F401 - both now, so that their start is not taken for work
        import rerun  # noqa: F401
    begun = time.perf_counter()
    if target is not None:
        check_writable(target.parent)
    simulation = Simulation(machine, request, mine, seed)
    prepared = time.perf_counter()
    for words in simulation.remarks:
        tell(words)
    walk = None
    if target is None:
        walk = simulation.run(quiet)
        numbers, interrupted = summarise(walk), walk.interrupted
    else:
        numbers, interrupted = streamed_run.run(simulation, target, target.with_suffix(".parquet"), seed, quiet)
    summary = _summary(numbers, begun, prepared, simulation.remarks)
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


def _target(out: str | os.PathLike[str] | bool, name: str) -> Path | None:
    """Return where the recording for the viewer goes, or None."""
    if out is False:
        return None
    return check_target(f"{name}.rrd" if out is True else out)


def _is_motion(scenario: object) -> bool:
    if isinstance(scenario, table_of.Recording):
        return True
    return isinstance(scenario, str | os.PathLike) and Path(scenario).suffix.lower() in MOTIONS


def _nobody_walks(rig: Rig, **given: object) -> None:
    """Refuse what says how somebody walks where a machine that nobody wears follows a motion."""
    for name, value in given.items():
        if str(value) != str(_AS_EVER[name]):
            raise ScenarioError(f"--{name} says how somebody walks, and nobody wears {rig.name}, which follows a motion: leave it out")


def _follow(
    rig: Rig, motion: str | os.PathLike[str] | Recording, controller: Any, called: str, out: str | os.PathLike[str] | bool, seed: int,
    quiet: bool, tell: Callable[[str], None], columns: Columns,
) -> Run:  # fmt: skip
    """Let a machine that nobody wears follow a motion."""
    from exo_sim.simulation import unworn_record
    from exo_sim.simulation.streamed_run import interrupts_noted
    from exo_sim.simulation.unworn import UnwornSimulation

    target = _target(out, f"{motion.name if isinstance(motion, table_of.Recording) else Path(motion).stem}_{rig.name}")
    if target is not None:
        source = None if isinstance(motion, table_of.Recording) else Path(motion)
        if source and source.exists() and any(p.exists() and p.samefile(source) for p in (target, target.with_suffix(".parquet"))):
            raise RecordingError(f'"{source}" would be overwritten by the run; name another file with --out')
        check_writable(target.parent)
    begun = time.perf_counter()
    reading = reading_of(motion, columns)
    for finding in reading.findings:
        if finding.severity != "info":
            tell(finding.says)
    simulation = UnwornSimulation(rig, reading.recording, controller, called, seed)
    prepared = time.perf_counter()
    with interrupts_noted() as asked_to_stop:
        done = simulation.run(quiet, asked_to_stop)
    for words in simulation.remarks:
        tell(words)
    summary = _summary(unworn_record.summarise(done), begun, prepared, simulation.remarks)
    name = reading.recording.name if target is None else target.stem
    run = Run(rig, name, summary, simulation.remarks, target, done.interrupted or asked_to_stop(), done, seed)
    if target is not None:
        run.save(target)
        run.summary["wall_s"] = time.perf_counter() - prepared
    return run


def _summary(numbers: dict[str, Any], begun: float, prepared: float, remarks: tuple[str, ...]) -> dict[str, Any]:
    times = {"wall_s": time.perf_counter() - prepared, "prepared_s": prepared - begun}
    first = {key: numbers.pop(key) for key in ("schema", "scenario", "simulated_s")}
    return first | times | numbers | ({"remarks": list(remarks)} if remarks else {})


def scenarios() -> dict[str, str]:
    """Return the names of all scenarios, each with one line that says what is done."""
    return {name: scenario_files.find(name).summary for name in scenario_files.names()}


def _copied(source: Path, target: Path) -> None:
    from exo_sim.outputs import replacing

    if target.exists() and target.samefile(source):
        return
    with replacing(target) as beside:
        shutil.copyfile(source, beside)
