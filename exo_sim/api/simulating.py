"""`exo.simulate`: a person walks in the machine, and everything is recorded."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import Quantity, RigLike, quantity, rig_of
from exo_sim.api.comparing import check_target
from exo_sim.api.notebook import html_table
from exo_sim.api.recording import Recording
from exo_sim.api.rig import Rig
from exo_sim.gait import scenario as scenario_files
from exo_sim.plain_text import table

if TYPE_CHECKING:
    from exo_sim.api.picture import Picture
    from exo_sim.simulation.walk import Walk

#: What `Run.plot` draws where it was recorded.
_SHOWN = ("torque", "torque_demanded", "pressure_1", "pressure_2", "ground_force_z", "strap_force_z")


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
    _walk: Walk | None
    _seed: int

    @property
    def table(self) -> Path | None:
        """Return where the table was written while it ran, or None."""
        return None if self.path is None else self.path.with_suffix(".parquet")

    @cached_property
    def recording(self) -> Recording:
        """Return every signal over time, as the rig's sensors show it."""
        from exo_sim.simulation import record

        if self._walk is None:
            assert self.table is not None
            return Recording.load(self.table)
        return Recording.of(record.recording(self._walk, self.scenario, self._seed))

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
        if self._walk is None:
            assert self.path is not None and self.table is not None
            for source, goal in ((self.path, target), (self.table, target.with_suffix(".parquet"))):
                _copied(source, goal)
            return target
        from exo_sim.recording import write_rrd
        from exo_sim.simulation import record

        write_rrd(target, self.recording, scene=record.scene(self._walk))
        self.recording.save(target.with_suffix(".parquet"))
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
            rows.append([f"torque at {name}", f"{one['torque_peak_nm']:.0f} N m peak, {one['torque_error_rms_nm']:.1f} N m rms error"])
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
    rig: RigLike | None = None, scenario: str = "level_walk", *, payload: Quantity = 34.0, speed: float = 1.0,
    strides: int | None = None, assist: str = "on", controller: str = "model", demand: str = "least_load", seed: int = 0,
    out: str | os.PathLike[str] | None = None, quiet: bool = True,
) -> Run:  # fmt: skip
    """Simulate a person in the machine.

    Args:
        rig: A path or `exo.Rig` of a worn machine; the one that comes with the package when None.
        scenario: One of `exo.scenarios()`.
        payload: On the back: kilograms, or text like "75 lb".
        speed: Factor on the recorded cadence, 0.7 to 1.3.
        strides: How many strides or repetitions; the scenario's own number when None.
        assist: "on"; "off": valves closed; "vented": both chambers open to the atmosphere.
        controller: How valves get forces: "model" inverts the gas equations, "pi" is plain PI.
        demand: Law by which joint torques are asked for: "least_load", "inverse_dynamics" or "virtual_support".
        seed: Travels with the recording; a walk has no chance in it.
        out: Where the recording for the viewer (`.rrd`) is written while it runs, with its table beside it; memory then does not grow
            with length. None keeps the run in memory.
        quiet: No progress.

    Raises:
        ScenarioError, RigError, ModelError: it cannot be carried out; one line each.
        Diverged: the simulation left the range of numbers that mean anything, or the machine fell.
    """
    from exo_sim.simulation import kept
    from exo_sim.simulation.coupled import Simulation
    from exo_sim.simulation.summary import summarise
    from exo_sim.simulation.walk import Request

    target = None if out is None else check_target(out)
    request = Request(
        scenario, payload=quantity(payload, "kg", "payload", low=0.0), speed=speed, cycles=strides, assist=assist,
        controller=controller, law=demand,
    )  # fmt: skip
    machine = rig_of(rig)
    begun = time.perf_counter()
    simulation = Simulation(machine, request)
    prepared = time.perf_counter()
    walk, interrupted = None, False
    if target is None:
        walk = simulation.run(quiet)
        numbers, interrupted = summarise(walk), walk.interrupted
    else:
        numbers, interrupted = kept.run(simulation, target, target.with_suffix(".parquet"), seed, quiet)
    times = {"wall_s": time.perf_counter() - prepared, "prepared_s": prepared - begun}
    first = {key: numbers.pop(key) for key in ("schema", "scenario", "simulated_s")}
    remarks = {"remarks": list(simulation.remarks)} if simulation.remarks else {}
    return Run(machine, scenario, first | times | numbers | remarks, simulation.remarks, target, interrupted, walk, seed)


def scenarios() -> dict[str, str]:
    """Return the names of all scenarios, each with one line that says what is done."""
    return {name: scenario_files.find(name).summary for name in scenario_files.names()}


def _copied(source: Path, target: Path) -> None:
    from exo_sim.outputs import replacing

    if target.exists() and target.samefile(source):
        return
    with replacing(target) as beside:
        shutil.copyfile(source, beside)
