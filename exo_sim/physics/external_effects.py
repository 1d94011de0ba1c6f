"""Effects that are declared outside this package: by installed packages, and in Python files that the environment names.

A package names a module with an `EFFECT` under the entry point group `exo_sim.effects`; installing it is enough. They count from the first
import of the physics on: the records of a plant and its machine code are made for them.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any

from exo_sim.errors import ModelError, misspelt

#: Environment variable with the files, separated as in PATH; processes started from this one see it too.
VARIABLE = "EXO_SIM_EFFECTS"
#: Entry point group under which installed packages name modules that declare an effect.
GROUP = "exo_sim.effects"


@dataclass(frozen=True)
class Source:
    """Where an effect is declared.

    Attributes:
        label: What to call it in messages.
        path: Its file: machine code is kept for the text that is in it.
        module: Name of an installed module, "" for a file by itself.
        attribute: What in the module is the effect.
    """

    label: str
    path: Path
    module: str = ""
    attribute: str = "EFFECT"

    def effect(self) -> Any:
        """Import what is declared and return it.

        Raises:
            ModelError: it cannot be run, or declares no effect.
        """
        module = _run(self)
        if not hasattr(module, self.attribute):
            raise ModelError(f"{self.label}: declares no {self.attribute}")
        return getattr(module, self.attribute)


def sources() -> list[Source]:
    """Return where effects are declared outside: of installed packages by name, then the files in their order.

    Raises:
        ModelError: a file is not there, or a module that a package names.
    """
    return [*_installed(), *(Source(str(path), path) for path in files())]


def files() -> list[Path]:
    """Return the files that the environment names, in their order.

    Raises:
        ModelError: one of them is not there.
    """
    named = [Path(name) for name in os.environ.get(VARIABLE, "").split(os.pathsep) if name]
    for path in named:
        if not path.is_file():
            what = "it is a folder: name the files in it" if path.is_dir() else f"there is no such file{misspelt(path)}"
            raise ModelError(f"{VARIABLE}: {path}: {what}")
    return [path.resolve() for path in named]


def use(path: str | Path) -> None:
    """Count the effect that a file declares, here and in processes started from here.

    Raises:
        ModelError: there is no such file, or the physics is loaded already.
    """
    if "exo_sim.physics.compiled" in sys.modules:
        raise ModelError(f"{path}: the physics is loaded already: name effects of your own before anything that simulates is imported")
    found = [str(known) for known in files()] + [str(Path(path).resolve())]
    os.environ[VARIABLE] = os.pathsep.join(dict.fromkeys(found))
    files()


def _installed() -> list[Source]:
    """Return what installed packages declare, by name of the entry point."""
    found = []
    for point in sorted(metadata.entry_points(group=GROUP), key=lambda point: (point.name, point.value)):
        package = point.dist.name if point.dist is not None else "a package"
        label = f'{package}: entry point "{point.name}" ({point.value})'
        try:
            spec = importlib.util.find_spec(point.module)
        except Exception as error:  # whatever the package above it raises
            raise ModelError(f"{label}: {type(error).__name__}: {error}") from error
        if spec is None or spec.origin is None or not Path(spec.origin).is_file():
            raise ModelError(f"{label}: there is no such module: mend the package, or uninstall it")
        found.append(Source(label, Path(spec.origin), point.module, point.attr or "EFFECT"))
    return found


def _run(source: Source) -> ModuleType:
    try:
        if source.module:
            return importlib.import_module(source.module)
        name = f"exo_sim_effects.{source.path.stem}"
        spec = importlib.util.spec_from_file_location(name, source.path)
        if spec is None or spec.loader is None:
            raise ModelError(f"{source.label}: is not a Python file")
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        return module
    except (ModelError, KeyboardInterrupt):
        raise
    except BaseException as error:  # SystemExit too: this process is not that file's to end
        raise ModelError(f"{source.label}: {type(error).__name__}: {error}") from error
