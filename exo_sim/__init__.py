"""A pneumatic exoskeleton in MuJoCo, held against real recordings: `import exo_sim as exo`.

What stands in `exo_sim.api` is found here too, imported when it is first used; `__init__.pyi` says the same to editors and type checkers.
"""

from __future__ import annotations

from typing import Any

from exo_sim.version import VERSION

__version__ = VERSION

#: Name to the module of `exo_sim.api` that holds it.
_API = {
    "Comparison": "comparing",
    "Diagnosis": "diagnosing",
    "ExoSimError": "errors",
    "Inspection": "inspecting",
    "Recording": "recording",
    "Rig": "rig",
    "Run": "simulated",
    "Simulation": "stepping",
    "Sizing": "sizing",
    "compare": "comparing",
    "diagnose": "diagnosing",
    "doctor": "doctor",
    "effects": "effects",
    "inspect": "inspecting",
    "log_model": "model_logging",
    "scenarios": "simulating",
    "simulate": "simulating",
    "size": "sizing",
}


def __getattr__(name: str) -> Any:
    if name not in _API:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(f"{__name__}.api.{_API[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*_API, "__version__"])
