"""Kinds of values that options and arguments take: quantities with units, choices and files with nearest names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from exo_sim.errors import UnitError, misspelt, nearest


class Quantity(click.ParamType):
    """A number with a unit, read as SI: `--payload "34 kg"` gives 34.0; `usual` is the unit that help shows."""

    name = "quantity"

    def __init__(self, si_unit: str, low: float | None = None, high: float | None = None, usual: str = "") -> None:
        self.si_unit, self.low, self.high, self.usual = si_unit, low, high, usual or si_unit

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        if isinstance(value, float):
            return value
        from exo_sim import units

        try:
            si = units.parse(value, self.si_unit)
        except UnitError as error:
            self.fail(str(error), param, ctx)
        if self.low is not None and si < self.low:
            self.fail(f'"{value}" is too small; write at least "{self.low:g} {self.si_unit}"', param, ctx)
        if self.high is not None and si > self.high:
            self.fail(f'"{value}" is too large; write at most "{self.high:g} {self.si_unit}"', param, ctx)
        return si

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "NUMBER" if self.si_unit == "1" else f'"NUMBER {self.usual}"'


class Choice(click.Choice[str]):
    """One of a few words; a misspelt one is answered with the nearest."""

    def get_invalid_choice_message(self, value: Any, ctx: click.Context | None) -> str:
        return f'no "{value}"{nearest(str(value), self.choices)}'


class ControllerName(click.ParamType):
    """One of the built-in controllers, or FILE.py:NAME."""

    name = "controller"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if value not in ("model", "pi") and ".py" not in value:
            self.fail(f'no "{value}"{nearest(value, ("model", "pi"))}, or name a class of your own like mine.py:Impedance', param, ctx)
        return str(value)

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "[model|pi|FILE.py:NAME]"


class InputFile(click.Path):
    """A file that must be there; a misspelt one is answered with its nearest neighbours in the folder."""

    name = "file"

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        path = Path(value)
        if path.is_dir():
            self.fail(f'"{path}" is a folder; name a file in it', param, ctx)
        if not path.exists():
            if path.is_symlink():
                self.fail(f'"{path}" is a link that leads to no file; name the file itself', param, ctx)
            self.fail(f'there is no file "{path}"{misspelt(path)}', param, ctx)
        return path


class RigFile(InputFile):
    """A rig file, or the name of a machine that comes with the package."""

    name = "rig"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        path, included = Path(value), included_machines()
        if not path.exists() and str(value) in included:
            return included[str(value)]
        if not path.exists() and not path.suffix and path.name == str(value):
            self.fail(f'there is no file "{value}", and no included machine{nearest(str(value), included)}', param, ctx)
        return super().convert(value, param, ctx)

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return f"[FILE|{'|'.join(included_machines())}]"


class CatalogueFile(InputFile):
    """A catalogue file, or the name of a maker's that comes with the package."""

    name = "catalogue"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        from exo_sim.errors import RigError
        from exo_sim.rig.own_catalogue import find_catalogue

        try:
            path = find_catalogue(value)
        except RigError as error:
            self.fail(str(error), param, ctx)
        return super().convert(path, param, ctx)

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        from exo_sim.rig.own_catalogue import included_catalogues

        return f"[FILE|{'|'.join(included_catalogues())}]"


def included_machines() -> dict[str, Path]:
    """Return the rigs that come with the package, by name."""
    folder = Path(__file__).resolve().parents[1] / "assets"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}
