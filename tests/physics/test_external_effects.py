"""What docs/add_an_effect.md says is so: an effect from outside the package is declared, read, simulated, and held at its bounds."""

from __future__ import annotations

import importlib
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from exo_sim.errors import ModelError
from exo_sim.physics import external_effects


def blocks(repository: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (repository / "docs" / "add_an_effect.md").read_text(), re.DOTALL)


@pytest.fixture(autouse=True, scope="module")
def code_of_its_own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep machine code apart: a few sets of effects are more versions than are kept, and those of all other tests would go."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("EXO_SIM_CACHE", str(tmp_path_factory.mktemp("code")))
        yield


@pytest.fixture
def example(repository: Path, tmp_path: Path) -> Path:
    """Return a folder with the page's effect and a bench that has it."""
    effect, copying, *_ = blocks(repository, "python")
    (tmp_path / "blow_off.py").write_text(effect)
    done = run(tmp_path, "-c", copying, named=False)
    assert done.returncode == 0, done.stderr
    (tmp_path / "with_blow_off.toml").write_text((tmp_path / "rig.toml").read_text() + "\n" + blocks(repository, "toml")[0])
    return tmp_path


def run(folder: Path, *words: str, named: bool = True) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **({external_effects.VARIABLE: str(folder / "blow_off.py")} if named else {})}
    return subprocess.run([sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=1200, check=False)


@pytest.mark.slow
def test_the_page_s_effect_simulates(repository: Path, example: Path) -> None:
    """The valve lets off above 4 bar what a supply of 7 bar brings; at its bounds and with tiny volumes the step holds, the books close."""
    script = blocks(repository, "python")[2] + """
import json
import numpy as np
from exo_sim.physics.gas_effects_off import effects_on_gas
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world
found = {"pressures": plugin.pressures().tolist(), "seen": "blow_off" in effects_on_gas(), "residuals": []}
for conductance, dead in ((1e-7, 4e-6), (1e-5, 1e-8)):
    cylinder = paper_cylinder(0.032, 0.012, 0.1, 5e-6, dead, dead)
    cylinder["blow_off"]["pressure"], cylinder["blow_off"]["conductance"] = 4e5, conductance
    gas = Pneumatics(paper_world(), cylinder, dt=5e-3)
    x = 0.05 - 0.05 * np.cos(np.arange(60) * 0.3)
    gas.fill(x[:1], 3e5, 3e5)
    for i in range(1, 60):
        gas.advance(x[i - 1 : i], x[i : i + 1], np.array([np.sin(0.7 * i)]))
    books = gas.books()
    found["residuals"] += [books.mass_residual, books.energy_residual, float(gas.pressures(x[-1:]).max())]
print(json.dumps(found))
"""
    done = run(example, "-c", script, named=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["seen"]
    assert 4e5 < found["pressures"][0][0] < 5e5
    mass, energy, highest, mass_fast, energy_fast, highest_fast = found["residuals"]
    assert max(mass, energy, mass_fast, energy_fast) < 1e-9
    assert highest < 7e5 and highest_fast < 4.2e5


RECORDED = """
import numpy as np
from exo_sim.recording import Recording, write_table
from pathlib import Path
plugin.reset(data)
chance, command, until, rows = np.random.default_rng(1), 0.0, 0, []
for step in range(3000):
    if step >= until:  # the valve is held open, or closed, for a while
        command = float(chance.uniform(-0.5, 0.5)) if chance.uniform() < 0.7 else 0.0
        until = step + int(chance.integers(80, 400))
    x = float(data.qpos[0])
    command = max(command, 0.2) if x < 0.02 else min(command, -0.2) if x > 0.14 else command
    plugin.command[:] = command
    rows.append((data.time, command, *np.ravel(plugin.pressures()), x))
    plugin.step(data)
time, *signals = np.array(rows).T
noise = (0.0, 150.0, 150.0, 1e-5)
names = ("piston.valve_command", "piston.pressure_1", "piston.pressure_2", "slide.position")
columns = {name: signal + chance.normal(0.0, 1.0, time.size) * size for name, signal, size in zip(names, signals, noise)}
write_table(Path("recording.csv"), Recording("r", time, columns, dict(zip(names, ("1", "Pa", "Pa", "m")))))
"""


@pytest.mark.slow
def test_a_diagnosis_names_the_page_s_effect_and_measures_it(repository: Path, example: Path) -> None:
    """One file, and nothing else in the house: what the nominal rig leaves out is found, named, and its numbers are those of the truth."""
    _, _, simulating, diagnosing = blocks(repository, "python")
    done = run(example, "-c", simulating + RECORDED, named=False)
    assert done.returncode == 0, done.stderr
    done = run(example, "-c", diagnosing.replace("hidden.rrd", "recording.csv"), named=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "['blow_off']"
    effects = json.loads((example / "found" / "diagnosis.json").read_text())["effects"]
    assert [effect["name"] for effect in effects] == ["blow_off"]
    for name, truth in (("pressure", 4e5), ("conductance", 1e-7)):
        estimate = effects[0]["parameters"][name]
        assert abs(estimate["value"] / truth - 1.0) < 0.01
        assert estimate["low"] < truth < estimate["high"]


def test_the_command_knows_the_page_s_effect(example: Path) -> None:
    done = run(example, "-m", "exo_sim", "effects", "blow_off", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["effect"]["family"] == "leak"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("x = 1", "declares no EFFECT"),
        ("from exo_sim.physics.effects.coulomb_friction import EFFECT", "there is an effect coulomb_friction already"),
        (None, "there is no such file"),
    ],
)
def test_a_file_that_is_no_effect_is_refused_in_one_line(tmp_path: Path, text: str | None, said: str) -> None:
    if text is not None:
        (tmp_path / "blow_off.py").write_text(text)
    done = run(tmp_path, "-m", "exo_sim", "effects")
    assert done.returncode == 2
    assert "blow_off.py" in done.stderr and said in done.stderr and len(done.stderr.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("change", "said"), [('family="leaks"', 'did you mean "leak"'), ('places=("cylindre",)', 'did you mean "cylinder"')]
)
def test_a_misspelt_declaration_says_what_there_is(example: Path, change: str, said: str) -> None:
    key = change.split("=")[0]
    path = example / "blow_off.py"
    path.write_text(re.sub(rf"    {key}=.*,\n", f"    {change},\n", path.read_text(), count=1))
    done = run(example, "-m", "exo_sim", "effects")
    assert done.returncode == 2 and said in done.stderr


def test_it_is_too_late_once_the_physics_is_loaded(example: Path) -> None:
    importlib.import_module("exo_sim.physics.compiled")
    with pytest.raises(ModelError, match="before anything that simulates is imported"):
        external_effects.use(example / "blow_off.py")


@pytest.fixture(scope="module")
def site(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder into which the page's package is installed."""
    folder = tmp_path_factory.mktemp("installed")
    effect = blocks(repository, "python")[0]
    package = folder / "package"
    (package / "my_effects").mkdir(parents=True)
    (package / "my_effects" / "__init__.py").write_text("")
    (package / "my_effects" / "blow_off.py").write_text(effect)
    build = '[build-system]\nrequires = ["setuptools"]\nbuild-backend = "setuptools.build_meta"\n'
    (package / "pyproject.toml").write_text(build + blocks(repository, "toml entry-point")[0])
    words = ["install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation", "--disable-pip-version-check"]
    done = subprocess.run(
        [sys.executable, "-m", "pip", *words, "--target", str(folder / "site"), str(package)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return folder / "site"


@pytest.fixture
def installed(repository: Path, site: Path, tmp_path: Path) -> Path:
    """Return a folder with the page's package in `site`, and a bench that has its effect."""
    shutil.copytree(site, tmp_path / "site")
    (tmp_path / "bench.xml").write_text((repository / "assets" / "bench.xml").read_text())
    (tmp_path / "rig.toml").write_text((repository / "assets" / "bench.toml").read_text() + "\n" + blocks(repository, "toml")[0])
    return tmp_path


def with_site(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder / "site"), *sys.path])}
    return subprocess.run([sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=1200, check=False)


@pytest.mark.slow
def test_an_installed_package_brings_its_effect(installed: Path) -> None:
    done = with_site(installed, "-m", "exo_sim", "effects", "blow_off", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["effect"]["family"] == "leak"
    said = with_site(installed, "-c", "import exo_sim as exo; print(exo.Rig.load('rig.toml').effects[0].name, 'blow_off' in exo.effects)")
    assert said.returncode == 0, said.stderr
    assert said.stdout.split() == ["blow_off", "True"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = 1", "declares no EFFECT"),
        ("import nothing_of_this_name", "ModuleNotFoundError"),
        ("EFFECT = 3", "no Effect"),
        (None, "there is no such module: mend the package, or uninstall it"),
    ],
)
def test_an_installed_package_without_an_effect_is_named_in_one_line(installed: Path, text: str | None, said: str) -> None:
    module = installed / "site" / "my_effects" / "blow_off.py"
    module.unlink() if text is None else module.write_text(text)
    done = with_site(installed, "-m", "exo_sim", "effects")
    assert done.returncode == 2
    assert said in done.stderr and 'my-effects: entry point "blow_off"' in done.stderr and len(done.stderr.strip().splitlines()) == 1
