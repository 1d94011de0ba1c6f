"""`exo.size(motion=...)`: actuators of a machine that nobody wears against a motion that it is to follow."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import Quantity, RigLike, quantity, rig_of
from exo_sim.api.result_folder import result_folder
from exo_sim.api.rig import Rig
from exo_sim.sizing import motion_result
from exo_sim.sizing.fixing import given_numbers
from exo_sim.sizing.motion_result import MotionSizing as Study

if TYPE_CHECKING:
    from exo_sim.api.picture import Picture
    from exo_sim.recording.table import Recording


@dataclass(frozen=True, repr=False)
class MotionSizing:
    """The result of a search for actuators along a motion.

    Attributes:
        study: All of it (`exo_sim.sizing.motion_result.MotionSizing`).
        folder: Where `sized.toml` and `report.html` are.
        chosen: The rig with the recommended design.
    """

    study: Study
    folder: Path
    chosen: Rig
    _temporary: tempfile.TemporaryDirectory[str] | None = field(default=None)

    @property
    def front(self) -> list[dict[str, Any]]:
        """Return the designs to choose from, none better than another in all."""
        return self.summary["pareto"]

    @property
    def summary(self) -> dict[str, Any]:
        """Return what `exo-sim size --motion --json` prints."""
        return motion_result.numbers(self.study, self.folder)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write `sized.toml` and `report.html` into a folder."""
        from exo_sim.outputs import replacing
        from exo_sim.report.motion_page import motion_page

        place = Path(folder)
        motion_result.write(self.study, place)
        with replacing(place / "report.html") as beside:
            beside.write_text(motion_page(self.study), encoding="utf-8")
        return place

    def plot(self) -> Picture:
        """Draw the front: gas drawn against the mass of the cylinders, the recommended design marked."""
        from exo_sim.api.picture import front

        chosen = self.study.chosen
        return front([(one.mass, one.gas) for one in self.study.front], (chosen.mass, chosen.gas), "gas over the motion [g]")

    def __str__(self) -> str:
        return motion_result.words(self.study, self.folder)

    def __repr__(self) -> str:
        return f"<exo.MotionSizing of {self.chosen.name}: {len(self.study.front)} designs on the front>"


def size_motion(
    rig: RigLike | None, recording: Recording, *, trials: int, pressure_limit: Quantity | None, joints: tuple[str, ...],
    catalogue: str | os.PathLike[str] | None, fix: Mapping[str, Quantity] | Sequence[str], seed: int,
    out: str | os.PathLike[str] | None, quiet: bool,
) -> MotionSizing:  # fmt: skip
    """Search bores, strokes, valves and supply of a machine that follows a recorded motion; arguments as of `exo.size`.

    Raises:
        RigError, ModelError, RecordingError, ScenarioError: it cannot be carried out, or no design does it.
    """
    from exo_sim.outputs import replacing
    from exo_sim.report.motion_page import motion_page
    from exo_sim.rig.own_catalogue import read_catalogue
    from exo_sim.sizing.motion_search import RodJudge, loads_of, rod_space, search

    machine = rig_of(rig)
    limit = None if pressure_limit is None else quantity(pressure_limit, "Pa", "pressure_limit", low=0.0)
    loads = loads_of(machine, recording)
    own = None if catalogue is None else read_catalogue(Path(catalogue))
    space = rod_space(machine, limit, joints, own, given_numbers(fix))
    judge = RodJudge(machine, recording, space, loads)
    with result_folder(out, "size") as (folder, temporary):
        study = motion_result.result(judge, search(judge, trials, seed, quiet))
        path = motion_result.write(study, folder)
        with replacing(folder / "report.html") as beside:
            beside.write_text(motion_page(study), encoding="utf-8")
    return MotionSizing(study, folder, Rig.load(path), temporary)
