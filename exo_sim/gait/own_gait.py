"""Somebody's own gait: from a file of joint angles to a scenario that the machine walks in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from exo_sim.errors import ScenarioError, misspelt
from exo_sim.gait import contact_fit, fourier, strides, whole_trial
from exo_sim.gait.angle_signs import counted_as_machine
from exo_sim.gait.recorded_gait import RecordedGait
from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.walking import walking_as
from exo_sim.gait.walking_trial import GroundForce, Trial
from exo_sim.machine.person import REFERENCE_HEIGHT, Person
from exo_sim.recording.column_map import ColumnMap

#: Spreads between strides below this count as this [rad]: a person of other lengths moved the angles.
LEAST_SPREAD = np.radians(1.5)
#: How far a stance foot of the fitted stride may slide or sink before a remark says so [m].
_LOOSE = 0.02


@dataclass(frozen=True)
class GaitFile:
    """Where a gait is.

    Attributes:
        path: The file of joint angles.
        ground: The file of ground forces beside it, or None.
        named: Angle (`trial.JOINTS`, `trial.PELVIS`) to the label of its column, where the labels do not tell.
        columns: Foreign columns of a table, or None.
        start, stop: The part of the trial that counts [s].
        whole: Walk the strides as they are, one after the other, not their mean.
        stamps: When the files were changed last and their sizes: figures are computed anew where these differ.
    """

    path: Path
    ground: Path | None = None
    named: Mapping[str, str] = field(default_factory=dict, hash=False)
    columns: ColumnMap | None = field(default=None, hash=False)
    start: float = -np.inf
    stop: float = np.inf
    whole: bool = False
    stamps: tuple[tuple[int, int], ...] = field(default=(), init=False)

    def __post_init__(self) -> None:
        there = [path.stat() for path in (self.path, self.ground) if path is not None and path.exists()]
        object.__setattr__(self, "stamps", tuple((each.st_mtime_ns, each.st_size) for each in there))


def scenario(gait: GaitFile, cycles: int = 10, summary: str = "") -> Scenario:
    """Return walking with the mean stride of a trial, or through the whole of it.

    Raises:
        ScenarioError, RecordingError: the file cannot be read, an angle is missing, or there is no stride in it.
    """
    if gait.whole:
        part, remarks = whole_of(gait)
        return Scenario(
            summary=summary or f"walking through {gait.path.name}", motion=whole_trial.factory(part), cycle="trial", cycles=1,
            remarks=remarks, doubts=_fitted(gait).doubts,
        )  # fmt: skip
    figures, remarks = figures_of(gait)
    return Scenario(
        summary=summary or f"walking as in {gait.path.name}", motion=partial(walking_as, figures), cycles=cycles, remarks=remarks,
        doubts=_fitted(gait).doubts,
    )  # fmt: skip


class _Fitted(NamedTuple):
    """A trial, its strides, their mean moved so that the foot rests, remarks, and what may be wrong with its angles."""

    trial: Trial
    found: strides.Strides
    figures: RecordedGait
    remarks: tuple[str, ...]
    doubts: tuple[str, ...]


@lru_cache(maxsize=16)
def figures_of(gait: GaitFile) -> tuple[RecordedGait, tuple[str, ...]]:
    """Return the mean stride of a trial as figures, and remarks on how they were come by.

    Raises:
        ScenarioError, RecordingError: as `scenario`.
    """
    fitted = _fitted(gait)
    return fitted.figures, fitted.remarks


@lru_cache(maxsize=16)
def whole_of(gait: GaitFile) -> tuple[whole_trial.Cut, tuple[str, ...]]:
    """Return the strides of a trial as they are, and remarks on how they were come by.

    Raises:
        ScenarioError, RecordingError: as `scenario`.
    """
    trial, found, figures, remarks, _ = _fitted(gait)
    part = whole_trial.cut(trial, found, figures)
    return part, (
        *remarks[:-1],
        f"{trial.file_name}: {part.strides} strides from {part.start:.2f} to {part.stop:.2f} s are walked as they are; the end is moved by "
        f"at most {np.degrees(part.led_back):.1f} degrees to meet the beginning",
    )


@lru_cache(maxsize=16)
def _fitted(gait: GaitFile) -> _Fitted:
    """Return what a gait file comes to."""
    as_read, ground = read(gait)
    trial = counted_as_machine(as_read)
    remarks, doubts = list(trial.remarks), []
    if len(trial.remarks) > len(as_read.remarks):
        doubts.append("signs or zeros of its angles were guessed wrong")
    if "tilt" not in trial.angles:
        doubts.append("the pelvis's tilt is missing")
        remarks.append(f"{trial.file_name}: no tilt of the pelvis; hip angles are taken as those of the thigh in space")
    found = strides.find(trial, ground)
    if ground is not None and not found.by_force:
        remarks.append(f"{ground.file_name}: the forces tell of no whole stride; strides were found by the angles")
    mean = {name: fourier.fit(values.mean(axis=0), contact_fit.HARMONICS) for name, values in found.angles.items()}
    count = len(found.spans)
    spread = {name: values.std(axis=0, ddof=1) if count > 1 else np.zeros(contact_fit.PHASES) for name, values in found.angles.items()}
    sway = None if found.path is None else contact_fit.sway_of(found.path)
    moved = contact_fit.fit(mean, spread, sway, found.stance_end, Person(REFERENCE_HEIGHT), LEAST_SPREAD)
    remarks.append(_summary(trial, found, moved))
    worst = max(moved.rest[key] for key in ("heel_height", "toe_height", "heel_slide", "toe_slide"))
    if worst > _LOOSE:
        doubts.append(f"a foot on the ground slides or sinks by {1e3 * worst:.0f} mm")
        remarks.append(
            f"{trial.file_name}: on the ground the foot still slides or sinks by {1e3 * worst:.0f} mm with these angles; are they of level "
            "walking, and counted as the machine counts?"
        )
    even = np.arange(1, contact_fit.HARMONICS + 1) % 2 == 0
    tilt = fourier.Series(0.0, np.where(even, mean["tilt"].cosine, 0.0), np.where(even, mean["tilt"].sine, 0.0))
    figures = RecordedGait(
        source=trial.source, period=found.period, stride=moved.stride, stance_end=found.stance_end, ankle_offset=moved.foot_offset,
        mass=Person().mass, motion={**moved.series, "tilt": tilt}, recorded=mean,
        spread={name: fourier.fit(values, contact_fit.HARMONICS) for name, values in spread.items()}, moment={},
    )  # fmt: skip
    return _Fitted(trial, found, figures, tuple(remarks), tuple(doubts))


def _summary(trial: Trial, found: strides.Strides, moved: contact_fit.Fitted) -> str:
    count = {side: sum(1 for span in found.spans if span[0] == side) for side in "lr"}
    by = "the ground's force" if found.by_force else "the angles"
    change = ", ".join(f"{name} {np.degrees(most):.1f}" for name, (most, _) in moved.moved.items())
    return (
        f"{trial.file_name}: {count['l']} left and {count['r']} right strides by {by}, {found.period:.2f} s each; walked are their mean of "
        f"{moved.stride:.2f} m, moved by at most {change} degrees so that the foot rests on the ground"
    )


def read(gait: GaitFile) -> tuple[Trial, GroundForce | None]:
    """Read the angles of a trial and the forces beside them.

    Raises:
        ScenarioError: a format that is not read, or an angle is missing.
        RecordingError: a file cannot be read.
    """
    from exo_sim.gait.files import c3d, opensim_motion, table

    if not gait.path.exists():
        raise ScenarioError(f'"{gait.path}": there is no such gait file{misspelt(gait.path)}')
    ending, ground = gait.path.suffix.lower(), None
    if ending in (".mot", ".sto"):
        trial = opensim_motion.read_angles(gait.path, gait.named)
    elif ending == ".c3d":
        trial, ground = c3d.read_angles(gait.path, gait.named)
    elif ending in (".csv", ".tsv", ".txt", ".parquet", ".pq", ".rrd"):
        trial, ground = table.read_angles(gait.path, gait.named, gait.columns)
    else:
        raise ScenarioError(f'"{gait.path}": a gait ends in .mot, .sto, .c3d, .csv, .parquet or .rrd, not in "{ending}"')
    if gait.ground is not None:
        if not gait.ground.exists():
            raise ScenarioError(f'"{gait.ground}": there is no such file of ground forces{misspelt(gait.ground)}')
        kind = gait.ground.suffix.lower()
        ground = (opensim_motion if kind in (".mot", ".sto") else c3d if kind == ".c3d" else table).read_ground(gait.ground)
    return _part(trial, gait), ground


def _part(trial: Trial, gait: GaitFile) -> Trial:
    keep = (trial.time >= gait.start) & (trial.time <= gait.stop) & np.isfinite(trial.time)
    if np.any(np.diff(trial.time[keep]) <= 0.0):
        raise ScenarioError(f"{trial.file_name}: its clock stands still or runs back; export it again with a rising time")
    if keep.sum() < 10:
        raise ScenarioError(f"{trial.file_name}: {int(keep.sum())} rows of angles count; at least one stride is needed")
    angles = {name: values[keep] for name, values in trial.angles.items()}
    return replace(trial, time=trial.time[keep], angles=angles, remarks=(*trial.remarks, *_gaps(trial, keep)))


def _gaps(trial: Trial, keep: np.ndarray) -> tuple[str, ...]:
    """Return a remark on the rows that count and have no number of an angle, or none."""
    found = []
    for name, values in trial.angles.items():
        rows = np.flatnonzero(keep & ~np.isfinite(values))
        if len(rows) and len(rows) < keep.sum():
            where = f"first in row {rows[0] + 1} ({trial.time[rows[0]]:.6g} s)"
            found.append(f"{name} has no number in {len(rows)} of {keep.sum()} rows, {where}")
    if not found:
        return ()
    filled = "gaps were filled in straight lines, strides with one of more than a tenth of them left out"
    return (f"{trial.file_name}: {'; '.join(found)}; {filled}",)
