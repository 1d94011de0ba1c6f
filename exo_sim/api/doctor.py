"""`exo.doctor`: what is installed, what is missing, what works here."""

from __future__ import annotations

import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement

from exo_sim.errors import one_line
from exo_sim.plain_text import table
from exo_sim.version import VERSION

#: What each extra is for.
_EXTRAS = {
    "c3d": "gait from .c3d files",
    "gymnasium": "environments in Gymnasium",
    "notebook": "export to pandas and xarray",
    "files": "MATLAB 7.3, MCAP and ROS 2 bags",
    "cluster": "sizing and trials spread by Dask",
    "docs": "building the documentation",
    "opensim": "comparison with OpenSim's inverse dynamics",
    "truths": "trials computed by Cantera",
}
#: What packages are for that are installed where they can be, and are no extra.
_PARTS = {"dm-control": "environments.load (dm_env)"}
#: Seconds for a check that starts a process.
_PATIENCE = 60.0


@dataclass(frozen=True)
class Check:
    """One thing that was looked at.

    Attributes:
        what: "numpy", "OpenGL".
        state: "ok", "missing" (an extra: something needs it), "fault" (a verb will not work).
        says: Version, or what is wrong and what to do.
        needed_by: What works only with it; empty for what all needs.
    """

    what: str
    state: str
    says: str
    needed_by: str = ""


@dataclass(frozen=True, repr=False)
class Health:
    """What was found; `checks` in the order in which they print."""

    checks: tuple[Check, ...]

    @property
    def summary(self) -> dict[str, Any]:
        """Return what `exo-sim doctor --json` prints."""
        return {
            "schema": "exo-sim/doctor/1", "version": VERSION, "python": platform.python_version(),
            "platform": platform.platform(), "package": str(Path(__file__).parents[1]), "works": not self.exit_status,
            "checks": [vars(check) for check in self.checks],
        }  # fmt: skip

    @property
    def exit_status(self) -> int:
        """Return 2 where a required part is at fault, else 0."""
        return 2 if any(check.state == "fault" and not check.needed_by for check in self.checks) else 0

    def __str__(self) -> str:
        head = f"exo-sim {VERSION}, Python {platform.python_version()}, {platform.platform()}"
        rows = [[one.state, one.what, f"for {one.needed_by}" if one.needed_by else "", one.says] for one in self.checks]
        return f"{head}\n{Path(__file__).parents[1]}\n\n{table(rows)}"

    def __repr__(self) -> str:
        return str(self)


def doctor() -> Health:
    """Look at everything that a verb may need: packages and their versions, graphics, the cache of compiled code, the machines inside."""
    checks = [*_packages(), _machines(), _compiled_code(), _graphics(), _viewer()]
    return Health(tuple(checks))


def _packages() -> list[Check]:
    """Return one check for each requirement of the package, extras last."""
    try:
        wanted = [Requirement(text) for text in metadata.requires("exo-sim-pneumatic") or []]
    except metadata.PackageNotFoundError:
        return [Check("exo-sim-pneumatic", "fault", "not installed as a package: pip install .")]
    found, seen = [], set()
    for requirement in wanted:
        of_extra = "extra" in str(requirement.marker or "")
        extras = [name for name in _EXTRAS if of_extra and requirement.marker and requirement.marker.evaluate({"extra": name})]
        if (of_extra and not extras) or requirement.name in seen:
            continue
        seen.add(requirement.name)
        use = _EXTRAS[extras[0]] if extras else _PARTS.get(requirement.name, "")
        install = f"pip install 'exo-sim-pneumatic[{extras[0]}]'" if extras else f"pip install '{requirement.name}{requirement.specifier}'"
        try:
            version = metadata.version(requirement.name)
        except metadata.PackageNotFoundError:
            if not of_extra and requirement.marker and not requirement.marker.evaluate():
                install = f"cannot be installed on Python {platform.python_version()}"
            found.append(Check(requirement.name, "missing" if use else "fault", install, use))
            continue
        if requirement.specifier.contains(version, prereleases=True):
            found.append(Check(requirement.name, "ok", version, use))
        else:
            found.append(Check(requirement.name, "fault", f"{version}, but {requirement.specifier} is needed: {install}", use))
    return sorted(found, key=lambda check: bool(check.needed_by))


def _machines() -> Check:
    """Compile the worn machine that comes along."""

    def compiled() -> str:
        from exo_sim.api.rig import Rig

        rig = Rig.included()
        rig.mujoco_model()
        folder = rig.path.parent
        return f"{', '.join(sorted(path.stem for path in folder.glob('*.toml')))} in {folder}"

    return _tried("included machine", compiled, "reinstall the package: its data files are missing")


def _compiled_code() -> Check:
    """Look where machine code is kept between starts."""

    def kept() -> str:
        from exo_sim.physics import compiled_cache

        place = compiled_cache.root()
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            pass
        size = sum(path.stat().st_size for path in place.rglob("*") if path.is_file())
        return f"{place}, {size / 1e6:.0f} MB"

    return _tried("compiled code", kept, "name a folder of your own with EXO_SIM_CACHE", "quick starts")


def _graphics() -> Check:
    """Draw a small picture with MuJoCo, in a process of its own: graphics drivers may end one."""
    code = (
        "import os, sys\n"
        "if sys.platform == 'linux' and 'DISPLAY' not in os.environ: os.environ.setdefault('MUJOCO_GL', 'egl')\n"
        "import mujoco\n"
        "model = mujoco.MjModel.from_xml_string('<mujoco><worldbody><geom size=\".1\"/></worldbody></mujoco>')\n"
        "with mujoco.Renderer(model, 32, 32) as renderer:\n"
        "    renderer.update_scene(mujoco.MjData(model)); renderer.render()\n"
    )
    return _tried("OpenGL", lambda: _process(code) or "draws", "apt-get install libegl1 libgl1-mesa-dri, or set MUJOCO_GL", "pictures")


def _viewer() -> Check:
    """Look whether a Vulkan driver is there, which the rerun viewer paints with."""
    if sys.platform != "linux":
        return Check("Vulkan", "ok", "comes with the system", "exo-sim view")
    drivers = [path for folder in ("/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d") for path in Path(folder).glob("*.json")]
    if drivers:
        return Check("Vulkan", "ok", ", ".join(sorted(path.stem for path in drivers)[:4]), "exo-sim view")
    return Check("Vulkan", "missing", "no driver: apt-get install mesa-vulkan-drivers libvulkan1", "exo-sim view")


def _process(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=_PATIENCE, check=False)
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1])
    return done.stdout.strip()


def _tried(what: str, trial: Callable[[], str], remedy: str, needed_by: str = "") -> Check:
    try:
        return Check(what, "ok", trial(), needed_by)
    except Exception as error:  # whatever a driver or a package raises
        return Check(what, "missing" if needed_by else "fault", f"{one_line(str(error), 120)}: {remedy}", needed_by)
