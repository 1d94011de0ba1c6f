"""From the name of a file, a class or an object to a controller that has what one must have."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

from exo_sim.control.user_controller import faults
from exo_sim.control.user_controller.protocol import Controller
from exo_sim.errors import ScenarioError, misspelt, nearest
from exo_sim.inputs import check_regular


def is_path(text: str) -> bool:
    """Return whether a controller's name tells a file of somebody's own."""
    return text.partition(":")[0].lower().endswith(".py") or ".py:" in text


def load(text: str) -> Controller:
    """Return the controller that `"FILE.py:NAME"` names; the name may be left out where the file has one controller.

    Raises:
        ScenarioError: no such file or class, or the file fails; the message names file and line.
    """
    file, _, name = text.rpartition(":") if ".py:" in text else (text, "", "")
    path = Path(file)
    try:
        check_regular(path)
    except FileNotFoundError:
        raise ScenarioError(f'controller "{text}": there is no file "{path}"{misspelt(path)}') from None
    except (OSError, ValueError) as error:
        raise ScenarioError(f'controller "{text}": "{path}" {error}') from None
    spec = importlib.util.spec_from_file_location(f"controller_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses and pickling look for it there
    try:
        spec.loader.exec_module(module)
    except BaseException as error:
        if faults.is_interrupt(error):
            raise
        raise ScenarioError(f"controller {faults.place(error, path)}") from None
    made = {
        key: value
        for key, value in vars(module).items()
        if isinstance(value, type) and value.__module__ == spec.name and callable(faults.attribute(value, "act"))
    }
    if not name:
        if len(made) != 1:
            raise ScenarioError(f'controller "{text}": name one class of the file, like {path.name}:NAME{nearest("", made)}')
        name = next(iter(made))
    given = faults.attribute(module, name)
    if given is None:
        raise ScenarioError(f'controller "{text}": {path} has no "{name}"{nearest(name, made)}')
    return of(given, f"{path}:{name}", path)


def of(given: Any, source: str = "", path: Path | None = None) -> Controller:
    """Return a controller from an object or a class, checked to have `reset` and `act`.

    Raises:
        ScenarioError: a method is missing, or making the object fails.
    """
    source = source or str(faults.attribute(given, "__name__", type(given).__name__))
    if isinstance(given, type) or (callable(given) and faults.attribute(given, "act") is None):
        try:
            given = given()
        except BaseException as error:
            if faults.is_interrupt(error):
                raise
            raise ScenarioError(
                f"controller {faults.place(error, path)}, while making {source}(); a controller is a class that needs no arguments, "
                "with reset(context) and act(observation)"
            ) from None
    for method in ("reset", "act"):
        if not callable(faults.attribute(given, method)):
            argument = "context" if method == "reset" else "observation"
            raise ScenarioError(f"controller {source}: it has no method {method}(self, {argument}); a controller has reset and act")
    return given  # type: ignore[no-any-return]
