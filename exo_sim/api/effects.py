"""`exo.effects`: the physics beyond the paper, by name."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path

from exo_sim.api.notebook import html_table
from exo_sim.errors import RigError, nearest
from exo_sim.physics import external_effects
from exo_sim.physics.declaration import Effect, declared
from exo_sim.plain_text import table


class Effects(Mapping[str, Effect]):
    """All declared effects: `exo.effects["wall_heat_transfer"].parameters`, `list(exo.effects)`, `print(exo.effects)`."""

    def __getitem__(self, name: str) -> Effect:
        if name not in declared():
            raise RigError(f'there is no effect "{name}"{nearest(name, declared())}')
        return declared()[name]

    def __contains__(self, name: object) -> bool:
        return name in declared()

    def __iter__(self) -> Iterator[str]:
        return iter(declared())

    def __len__(self) -> int:
        return len(declared())

    def page(self, name: str) -> str:
        """Return all that is known of an effect, as text: numbers, signature, rig text.

        Raises:
            RigError: there is none of this name.
        """
        from exo_sim.rig.effect_page import text

        return text(self[name])

    def register(self, path: str | os.PathLike[str]) -> None:
        """Count the effect that a Python file of your own declares, here and in processes started from here.

        Say it before anything that simulates is imported or called: the machine code of a step is made for the effects that there are.

        Raises:
            ModelError: there is no such file, it declares no effect, or something was simulated before.
        """
        external_effects.use(Path(path))
        declared.cache_clear()

    def _rows(self) -> list[list[str]]:
        return [[each.name, each.question] for each in self.values()]

    def __str__(self) -> str:
        return table(self._rows())

    def __repr__(self) -> str:
        return f"<exo.effects: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        return html_table(self._rows(), ("effect", "question"))


effects = Effects()
