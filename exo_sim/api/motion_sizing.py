"""`exo.size(motion=...)`: actuators of a machine that nobody wears against a motion that it is to follow."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import Quantity, RigLike, quantity, rig_of
from exo_sim.api.result_folder import result_folder
from exo_sim.api.rig import Rig
from exo_sim.api.sizing_result import SizingResult
from exo_sim.sizing import motion_result
from exo_sim.sizing.fixed_numbers import given_numbers
from exo_sim.sizing.motion_result import MotionSizing as Study

if TYPE_CHECKING:
    from exo_sim.recording.table import Recording


@dataclass(frozen=True, repr=False)
class MotionSizing(SizingResult[Study]):
    """The result of a search for actuators along a motion; `study` is a `exo_sim.sizing.motion_result.MotionSizing`."""

    _gas = "gas over the motion [g]"
    _columns = (*SizingResult._columns, "position_error_rms")

    @property
    def summary(self) -> dict[str, Any]:
        """Return what `exo-sim size --motion --json` prints."""
        return motion_result.numbers(self.study, self.folder)

    def __str__(self) -> str:
        return motion_result.words(self.study, self.folder)


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
    from exo_sim.rig.own_catalogue import find_catalogue, read_catalogue
    from exo_sim.sizing.motion_search import RodJudge, loads_of, search
    from exo_sim.sizing.rod_space import rod_space

    machine = rig_of(rig)
    limit = None if pressure_limit is None else quantity(pressure_limit, "Pa", "pressure_limit", low=0.0)
    loads = loads_of(machine, recording)
    own = None if catalogue is None else read_catalogue(find_catalogue(catalogue))
    space = rod_space(machine, limit, joints, own, given_numbers(fix))
    judge = RodJudge(machine, recording, space, loads)
    with result_folder(out, "size") as (folder, temporary):
        study = motion_result.result(judge, search(judge, trials, seed, quiet))
        path = motion_result.write(study, folder)
        with replacing(folder / "report.html") as beside:
            beside.write_text(motion_page(study), encoding="utf-8")
    return MotionSizing(study, folder, Rig.load(path), temporary)
