"""What both searches for actuators give back: the front, the chosen rig, and a folder of files."""

from __future__ import annotations

import os
import shutil
import tempfile
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from exo_sim.api.notebook import html_table
from exo_sim.api.rig import Rig

if TYPE_CHECKING:
    from exo_sim.api.figure import Picture

Study = TypeVar("Study")


@dataclass(frozen=True, repr=False)
class SizingResult(ABC, Generic[Study]):
    """The result of a search for actuators.

    Attributes:
        study: All of it.
        folder: Where `sized.toml`, `report.html` and whatever else the search wrote are.
        chosen: The rig with the recommended design.
    """

    study: Study
    folder: Path
    chosen: Rig
    _temporary: tempfile.TemporaryDirectory[str] | None = field(default=None)
    #: What a plot calls the gas, and the columns of a table in a notebook.
    _gas: ClassVar[str] = "gas a cycle [g]"
    _columns: ClassVar[tuple[str, ...]] = ("bore_mm", "supply_pa", "torque_margin", "gas_kg_per_stride", "actuator_mass_kg")

    @property
    @abstractmethod
    def summary(self) -> dict[str, Any]:
        """Return what `exo-sim size --json` prints."""

    @abstractmethod
    def __str__(self) -> str: ...

    @property
    def front(self) -> list[dict[str, Any]]:
        """Return the designs to choose from, none better than another in all: bores, supply, margin, gas, mass, error."""
        return list(self.summary["pareto"])

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write what the command writes into a folder: `sized.toml`, `report.html`, and what else there is.

        Raises:
            OutputError: it cannot be written.
        """
        from exo_sim.outputs import replacing

        place = Path(folder)
        self.chosen.save(place / "sized.toml")
        for source in sorted(self.folder.iterdir()):
            if source.is_file() and source.name != "sized.toml" and source.parent.resolve() != place.resolve():
                with replacing(place / source.name) as beside:
                    shutil.copyfile(source, beside)
        return place

    def plot(self) -> Picture:
        """Draw the front: gas drawn against the mass of the cylinders, the recommended design marked."""
        from exo_sim.api.figure import front

        mass, gas = "actuator_mass_kg", "gas_kg_per_stride"
        best = self.summary["recommended"]
        return front([(one[mass], one[gas]) for one in self.front], (best[mass], best[gas]), self._gas)

    def __repr__(self) -> str:
        return f"<exo.{type(self).__name__} of {self.chosen.name}: {len(self.front)} designs on the Pareto front>"

    def _repr_html_(self) -> str:
        rows = [[str(one[key]) for key in self._columns] for one in self.front]
        return html_table(rows, self._columns, f"sizing of {self.chosen.name}")
