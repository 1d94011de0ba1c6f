"""`exo.Run`: what was simulated, to look at, to save and to draw."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import check_target
from exo_sim.api.moment import Moment
from exo_sim.api.notebook import html_table
from exo_sim.api.recording import Recording
from exo_sim.api.rig import Rig
from exo_sim.plain_text import table

if TYPE_CHECKING:
    from exo_sim.api.figure import Picture
    from exo_sim.simulation.unworn import MotionRun
    from exo_sim.simulation.walk import Walk

#: What of a joint is printed.
_JOINT = {
    "torque_peak_nm": ("torque {:.3g} N m peak", 1.0), "torque_error_rms_nm": ("torque error {:.3g} N m rms", 1.0),
    "position_error_rms_rad": ("position error {:.3g} deg rms", 57.29577951308232),
    "position_error_rms_m": ("position error {:.3g} mm rms", 1e3), "force_peak_n": ("force {:.3g} N peak", 1.0),
}  # fmt: skip
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
            shown = [words.format(factor * one[key]) for key, (words, factor) in _JOINT.items() if key in one]
            rows.append([name, ", ".join(shown)])
        for name, one in self.summary.get("cylinders", {}).items():
            gas = one.get("gas_kg_per_stride")
            drawn = "" if gas is None else f", {1e3 * gas:.2f} g gas a cycle"
            rows.append([f"cylinder {name}", f"{one['pressure_peak_pa'] / 1e5:.1f} bar peak{drawn}"])
        return rows

    def __str__(self) -> str:
        doubtful = f"{self.summary['unreliable']}\n" if "unreliable" in self.summary else ""
        return f"{doubtful}{self.scenario} in {self.rig.name}\n{table(self._rows())}"

    def __repr__(self) -> str:
        return f"<exo.Run {self.scenario} in {self.rig.name}: {self.summary['simulated_s']:.2f} s>"

    def _repr_html_(self) -> str:
        return html_table(self._rows(), caption=f"{self.scenario} in {self.rig.name}")


def target_of(out: str | os.PathLike[str] | bool, name: str) -> Path | None:
    """Return where the recording for the viewer goes, or None."""
    if out is False:
        return None
    return check_target(f"{name}.rrd" if out is True else out)


def summary_of(numbers: dict[str, Any], begun: Moment, prepared: Moment, remarks: tuple[str, ...]) -> dict[str, Any]:
    """Return what a run says: its numbers, how long preparing, simulating and compiling took, and what is to be said.

    Args:
        numbers: Of the simulation.
        begun, prepared: When preparing and simulating began.
        remarks: Plain sentences.
    """
    times = times_of(begun, prepared)
    first = {key: numbers.pop(key) for key in ("schema", "scenario", "simulated_s")}
    return first | times | numbers | ({"remarks": list(remarks)} if remarks else {})


def times_of(begun: Moment, prepared: Moment) -> dict[str, float]:
    """Return how long simulating and preparing took until now, and compiling, which neither counts [s]."""
    now = Moment.now()
    return {"wall_s": prepared.until(now), "prepared_s": begun.until(prepared), "compiled_s": now.compiled - begun.compiled}


def _copied(source: Path, target: Path) -> None:
    from exo_sim.outputs import replacing

    if target.exists() and target.samefile(source):
        return
    with replacing(target) as beside:
        shutil.copyfile(source, beside)
