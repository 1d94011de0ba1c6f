"""Effects that are declared outside this package, in Python files that the environment names.

They count from the first import of the physics on: the records of a plant and its machine code are made for them.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path
from types import ModuleType

from exo_sim.errors import ModelError

#: Environment variable with the files, separated as in PATH; processes started from this one see it too.
VARIABLE = "EXO_SIM_EFFECTS"


def files() -> list[Path]:
    """Return the files that are named, in their order.

    Raises:
        ModelError: one of them is not there.
    """
    named = [Path(name) for name in os.environ.get(VARIABLE, "").split(os.pathsep) if name]
    for path in named:
        if not path.is_file():
            raise ModelError(f"{VARIABLE}: {path}: there is no such file")
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


def load(path: Path) -> ModuleType:
    """Return a file as a module.

    Raises:
        ModelError: it cannot be run, or declares no EFFECT.
    """
    name = f"exo_sim_effects.{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ModelError(f"{path}: is not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except ModelError:
        raise
    except Exception as error:
        raise ModelError(f"{path}: {type(error).__name__}: {error}") from error
    if not hasattr(module, "EFFECT"):
        raise ModelError(f"{path}: declares no EFFECT")
    return module
