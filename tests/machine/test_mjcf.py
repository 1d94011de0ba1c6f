"""Models that MuJoCo takes and no machine is: refused in one line. What MuJoCo warns of is given once and leaves no file."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import warnings
from pathlib import Path

import mujoco
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import ModelError, RigError
from exo_sim.machine import mujoco_warnings
from exo_sim.machine.rig_model import load
from exo_sim.simulation.plugin import PneumaticPlugin

MODEL = """
<mujoco>
  <option timestep="{step}"/>
  <worldbody><body name="load">
    <joint name="slide" type="slide" axis="1 0 0" {joint}/><geom type="sphere" size="0.05" mass="{mass}"/>
  </body></worldbody>
  <actuator><motor name="piston" joint="slide" {motor}/></actuator>
</mujoco>
"""
RIG = """
model = "bench.xml"
[supply]
pressure = "7 bar"
[cylinders.piston]
actuator = "piston"
bore = "32 mm"
rod = "12 mm"
stroke = "200 mm"
acting = "{acting}"
[cylinders.piston.valve]
area = "2 mm^2"
"""


def bench(folder: Path, acting: str = "double", **settings: str) -> rigs.Rig:
    folder.mkdir(exist_ok=True)
    (folder / "bench.xml").write_text(MODEL.format(**{"step": "0.001", "joint": "", "mass": "8", "motor": "", **settings}))
    (folder / "rig.toml").write_text(RIG.format(acting=acting))
    return rigs.read(folder / "rig.toml")


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"step": "0.02"}, "timestep"),
        ({"step": "1e9"}, "timestep"),
        ({"step": "0"}, "timestep"),
        ({"step": "-1"}, "timestep"),
        ({"step": "nan"}, "timestep"),
        ({"mass": "inf"}, 'body "load": mass'),
        ({"mass": "1e300"}, 'body "load": mass'),
        ({"joint": 'damping="-5"'}, 'joint "slide": damping'),
        ({"joint": 'damping="inf"'}, 'joint "slide": damping'),
        ({"joint": 'stiffness="-1"'}, 'joint "slide": stiffness'),
        ({"joint": 'armature="1e12"'}, 'joint "slide": armature'),
        ({"joint": 'frictionloss="-2"'}, 'joint "slide": frictionloss'),
        ({"motor": 'ctrlrange="-1 1"'}, "ctrlrange in bench.xml cuts its force to -1 to 1 N"),
        ({"motor": 'forcerange="-500 200"'}, "forcerange in bench.xml"),
        ({"motor": 'ctrlrange="0 600"'}, "ctrlrange in bench.xml"),
        ({"joint": 'actuatorfrcrange="-1 1"'}, "actuatorfrcrange in bench.xml"),
    ],
)
def test_what_no_machine_has_is_refused_in_one_line(tmp_path: Path, settings: dict[str, str], says: str) -> None:
    from exo_sim.simulation.plugin import PneumaticPlugin

    rig = bench(tmp_path, **settings)
    with pytest.raises(ModelError, match=says) as caught:
        PneumaticPlugin(load(rig), rig)
    assert "\n" not in str(caught.value) and "bench.xml" in str(caught.value)


@pytest.mark.parametrize("motor", ['ctrlrange="-500 500"', 'ctrlrange="-420 482"', 'ctrlrange="-1 1" ctrllimited="false"'])
def test_a_motor_that_lets_the_cylinders_force_through_is_taken(tmp_path: Path, motor: str) -> None:
    """32 mm at 7 bar absolute: (7e5 - 101325) Pa x 804 mm^2 = 481.5 N out, less the rod 413.8 N in."""
    from exo_sim.machine.linkage import linkages

    rig = bench(tmp_path, motor=motor)
    assert len(linkages(rig, load(rig))) == 1


def test_a_single_acting_cylinder_only_pushes(tmp_path: Path) -> None:
    from exo_sim.machine.linkage import linkages

    rig = bench(tmp_path, "single", motor='ctrlrange="0 500"')
    assert len(linkages(rig, load(rig))) == 1


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('pressure = "7 bar"', 'pressure = "1e300 bar"'),
        ('pressure = "7 bar"', 'pressure = "1e6 bar"'),
        ('pressure = "7 bar"', 'pressure = "7 bar"\ntemperature = "1e5 K"'),
        ("[supply]", "[gas]\nheat_capacity_ratio = 1e6\n[supply]"),
        ("[supply]", '[gas]\nspecific_gas_constant = "1e9 J/(kg K)"\n[supply]'),
        ('bore = "32 mm"', 'bore = "32 km"'),
        ('stroke = "200 mm"', 'stroke = "1e9 m"'),
        ('stroke = "200 mm"', 'stroke = "200 mm"\ndead_volume_1 = "1e9 m^3"'),
        ('stroke = "200 mm"', 'stroke = "200 mm"\nretracted_length = "1e20 m"'),
    ],
)
def test_numbers_of_a_rig_that_no_machine_has_are_refused(tmp_path: Path, old: str, new: str) -> None:
    bench(tmp_path)
    (tmp_path / "rig.toml").write_text(RIG.format(acting="double").replace(old, new))
    with pytest.raises(RigError, match=r"more than any machine|larger than the piston"):
        rigs.read(tmp_path / "rig.toml")


def test_actuation_that_is_switched_off_is_refused(tmp_path: Path) -> None:
    rig = bench(tmp_path)
    rig.model.write_text(rig.model.read_text().replace("<worldbody>", '<option><flag actuation="disable"/></option><worldbody>'))
    with pytest.raises(ModelError, match="actuation"):
        load(rig)


def test_a_model_that_is_no_xml_or_no_file_is_one_line(tmp_path: Path) -> None:
    rig = bench(tmp_path)
    for content in (b"\xff\xfe", b"<mujoco>", b"", b"<a/>", b"<mujoco><worldbody><body/><joint/></worldbody></mujoco>"):
        rig.model.write_bytes(content)
        with pytest.raises(ModelError) as caught:
            load(rig)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["load", "slide", "piston"])
def test_a_name_that_is_no_text_is_one_line(tmp_path: Path, name: str) -> None:
    rig = bench(tmp_path)
    content = rig.model.read_bytes()
    assert f'name="{name}"'.encode() in content
    rig.model.write_bytes(content.replace(f'name="{name}"'.encode(), b'name="\x9a"'))
    with pytest.raises(ModelError, match="is not UTF-8 text; save the file as UTF-8"):
        load(rig)
    with contextlib.suppress(ValueError):  # MuJoCo itself refuses a motor without its joint
        model = mujoco.MjModel.from_xml_path(str(rig.model))
        with pytest.raises(ModelError, match="is not UTF-8 text"):
            PneumaticPlugin(model, rig)


def test_mujocos_warnings_are_given_once_and_leave_no_file(tmp_path: Path) -> None:
    code = (
        "import mujoco, numpy as np\nfrom exo_sim.machine import linkage\n"
        f"model = mujoco.MjModel.from_xml_string('''{MODEL.format(step='0.001', joint='', mass='8', motor='')}''')\n"
        "for _ in range(3):\n    data = mujoco.MjData(model)\n    data.qvel[:] = np.nan\n    mujoco.mj_step(model, data)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert done.stderr.count("MuJoCo: Nan, Inf or huge value") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_warning_is_never_raised_into_mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mujoco_warnings, "_given", set())
    model = mujoco.MjModel.from_xml_string(MODEL.format(step="0.001", joint="", mass="8", motor=""))
    data = mujoco.MjData(model)
    data.qvel[:] = float("nan")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mujoco.mj_step(model, data)
    assert mujoco_warnings._given
