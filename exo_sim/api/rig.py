"""`exo.Rig`: the nominal machine, as its owner describes it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.api.notebook import html_table
from exo_sim.errors import RigError, nearest
from exo_sim.plain_text import table
from exo_sim.rig import changing, improved_text, reading, schema
from exo_sim.rig.included_machines import included_machines

if TYPE_CHECKING:
    import mujoco


@dataclass(frozen=True, repr=False)
class Rig(schema.Rig):
    """The nominal machine, as its owner describes it: `rig.toml` and the MJCF that it names. Everything in SI; pressures absolute.

    Attributes are those of `exo_sim.rig.schema.Rig`: `name`, `model` (path of the MJCF), `cylinders`, `supply`, `environment`, `effects`
    and so on. A rig does not change; `changed` returns another one.
    """

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Rig:
        """Read a rig file.

        Raises:
            RigError: one line that names the file, the key, the value and what to do.
        """
        return cls.of(reading.read(Path(path)))

    @classmethod
    def included(cls, name: str = "exo") -> Rig:
        """Return a machine that comes with the package: "exo", the worn one, "exo_250_psi", the same at the pressure of the
        paper, which its cylinders are not rated for, or "bench", one cylinder that lifts a mass.

        Raises:
            RigError: there is none of this name.
        """
        machines = included_machines()
        if name not in machines:
            raise RigError(f'no included machine "{name}"{nearest(name, machines)}')
        return cls.load(machines[name])

    @classmethod
    def parse(cls, text: str, folder: str | os.PathLike[str] = ".") -> Rig:
        """Read a rig from the text of a rig file; its MJCF is looked for from `folder`.

        Raises:
            RigError: as `load`.
        """
        return cls.of(reading.parse(text, Path(folder) / "rig.toml"))

    @classmethod
    def of(cls, rig: schema.Rig) -> Rig:
        """Return a rig of the package's inside as this class."""
        return rig if isinstance(rig, cls) else cls(**{each.name: getattr(rig, each.name) for each in fields(schema.Rig)})

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the rig file, comments and order as in the one that was read; the MJCF is named relative to the new place.

        Returns:
            The path.

        Raises:
            RigError: a field was replaced in memory, so that the text no longer says what the rig is; use `changed`.
            OutputError: it cannot be written.
        """
        from exo_sim.outputs import replacing

        target = Path(path)
        text = self.text_in(target.parent)
        with replacing(target) as beside:
            beside.write_text(text, encoding="utf-8")
        return target

    def text_in(self, folder: str | os.PathLike[str]) -> str:
        """Return the text of the rig file as it must stand in a folder: the MJCF is named from there.

        Raises:
            RigError: as `save`.
        """
        if not self._text_is_true():
            raise RigError(f"{self.name}: this rig was changed beside its text; change it with rig.changed({{key: value}})")
        return improved_text.improved(self, (), (), Path(folder))

    def changed(self, values: Mapping[str | tuple[str, ...], Any]) -> Rig:
        """Return the rig with other values in its file.

        Args:
            values: Dotted keys of the file to values as it holds them: `{"supply.pressure": "6 bar", "cylinders.piston.rod": "0 mm",
                "effects.coulomb_friction.slide.force": "5 N"}`; a tuple of keys where one of them holds a dot. None takes a key away;
                what is not there yet is added.

        Raises:
            RigError: the result is no rig.
        """
        return self.of(reading.parse(changing.with_values(self.text, values), self.path))

    def mujoco_model(self) -> mujoco.MjModel:
        """Return the compiled MuJoCo model, with the masses, joint numbers and attachment points that the rig knows better.

        Raises:
            ModelError: MuJoCo refuses the MJCF, or it lacks a part that the rig names.
        """
        from exo_sim.machine.rig_model import load

        return load(self)

    def _text_is_true(self) -> bool:
        try:
            read = reading.parse(self.text, self.path)
        except RigError:
            return False
        return all(getattr(read, each.name) == getattr(self, each.name) for each in fields(schema.Rig) if each.name != "path")

    def _rows(self) -> list[list[str]]:
        rows = [["model", str(self.model)], ["supply", f"{self.supply.pressure / 1e5:g} bar, {self.supply.temperature:g} K"]]
        for one in self.cylinders.values():
            valve = f"valve {1e6 * one.valve_area:g} mm²" if one.valve_area else "no valve"
            rows.append([one.name, f"{1e3 * one.bore:g} x {1e3 * one.rod:g} x {1e3 * one.stroke:g} mm (bore, rod, stroke), {valve}"])
        rows += [[f"{each.name} at {each.where}", _numbers(each)] for each in self.effects]
        return rows

    def __str__(self) -> str:
        return f"rig {self.name}\n{table(self._rows())}"

    def __repr__(self) -> str:
        held = f"{_many(len(self.cylinders), 'cylinder')}, {_many(len(self.effects), 'effect')}"
        return f"<exo.Rig {self.name}: {held}, {self.path}>"

    def _repr_html_(self) -> str:
        return html_table(self._rows(), caption=f"rig {self.name}")


def _numbers(setting: schema.EffectSetting) -> str:
    from exo_sim.physics.declaration import declared
    from exo_sim.rig.effect_text import unit_of

    effect = declared()[setting.name]
    shown = [f"{name} {value:g} {unit_of(effect.parameter(name), setting)}".removesuffix(" 1")
             for name, value in setting.parameters.items()]  # fmt: skip
    return ", ".join(shown + [f"{name}: {len(values)} points" for name, values in setting.curves.items()])


def _many(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"
