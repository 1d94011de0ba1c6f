"""Rig files that cannot be: one clear line each, with the nearest right name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exo_sim.errors import ExoSimError, RigError
from exo_sim.machine.linkage import check_strokes
from exo_sim.machine.rig_model import load
from exo_sim.rig import parse, read
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation

ROOT = Path(__file__).resolve().parents[2]
BENCH = ROOT / "assets" / "bench.toml"
TEXT = BENCH.read_text(encoding="utf-8")


def refusal(text: str) -> str:
    """Return the one line with which a rig is refused, by its text, its model or its linkage."""
    with pytest.raises(ExoSimError) as error:
        rig = parse(text, BENCH)
        model = load(rig)
        check_strokes(rig, model)
        PneumaticPlugin(model, rig)
    message = str(error.value)
    assert "\n" not in message and "bench" in message
    return message


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('bore             = "32 mm"', 'bore = "-32 mm"', "cylinders.piston.bore = .-32 mm.: must be more than 0 m"),
        ('bore             = "32 mm"', 'bore = "32 bar"', "cylinders.piston.bore: .*not a unit of this kind"),
        ('bore             = "32 mm"', "bore = 32", "cylinders.piston.bore: .*has no unit"),
        ('bore             = "32 mm"', 'bohre = "32 mm"', "cylinders.piston.bore is missing.*bohre"),
        ('rod              = "12 mm"', 'rod = "33 mm"', "cylinders.piston.rod.*thinner than the bore"),
        ('rod              = "12 mm"', 'rod = "12 mm"\nrodd = "1 mm"', "rodd is not a key of a rig; did you mean .rod.*"),
        ('pressure    = "7 bar"', 'pressure = "7 barg"', "supply.pressure: .*gauge.*absolute"),
        ('pressure    = "7 bar"', 'pressure = "100 psig"', "supply.pressure: .*gauge.*absolute"),
        ('pressure    = "7 bar"', 'pressure = "0.5 bar"', "supply.pressure.*below the atmosphere"),
        ('pressure    = "7 bar"', 'pressure = "seven bar"', "supply.pressure: .*not a quantity"),
        ("[supply]", "[suply]", "suply is not a key of a rig; did you mean .supply"),
        ('temperature = "293.15 K"', 'temperature = "20 K"', "temperature = .20 K.: must be more than 100 K"),
        ('area = "5 mm^2"', 'area_supply_1 = "5 mm^2"\narea_exhaust_1 = "5 mm^2"', "area_supply_2 is missing: give it like .5 mm"),
        ("[cylinders.piston]", "[[cylinders.piston]]", r"\[\[cylinders.piston\]\] is a list of tables: write \[cylinders.piston\], once"),
        ('acting           = "double"', 'acting = "duble"', "acting.*did you mean .double"),
        ('stroke           = "160 mm"', 'stroke = "90 mm"', "stroke = 90.0 mm.*does not cover.*slide"),
        ('actuator         = "piston"', 'actuator = "pistn"', "no such actuator.*did you mean .piston"),
        ('model = "bench.xml"', 'model = "bensh.xml"', "bensh.xml.*no such MJCF"),
        ('area = "5 mm^2"', 'area = "5 mm"', "valve.area: .*not a unit of this kind"),
        ('area = "5 mm^2"', 'area = "5 m^2"', "valve.area.*larger than the piston"),
        ("heat_capacity_ratio   = 1.4", "heat_capacity_ratio   = 0.9", "gas.heat_capacity_ratio"),
        ("heat_capacity_ratio   = 1.4", "heat_capacity_ratio   = 0.9", "must be more than 1$"),
        ("[gas]", "[gas", "is not TOML"),
        ("[cylinders.piston]", "[cylinder.piston]", "bench.toml: cylinder is not a key of a rig; did you mean .cylinders"),
        ("[environment]", "[joints.slid]\ndamping_factor = 0.7\n[environment]", "joints.slid.*did you mean .slide"),
        ("[environment]", "[joints.slide]\ndamping_factor = 0\n[environment]", "joints.slide.damping_factor.*more than 0"),
        ("[environment]", "[joints.slide]\ndamping = 0.7\n[environment]", "damping is not a key.*damping_factor|damping_factor is missing"),
        ("[environment]", "[bodies.lod]\nmass = \"3 kg\"\n[environment]", "bodies.lod.*did you mean .load"),
    ],
)  # fmt: skip
def test_numbers_and_names_that_cannot_be(old: str, new: str, says: str) -> None:
    assert old in TEXT
    assert re.search(says, refusal(TEXT.replace(old, new, 1)))


@pytest.mark.parametrize(
    ("effects", "says"),
    [
        ('[effects.my_leak.piston]\narea = "1 mm^2"', "my_leak is not an effect; .*; one of your own is named in EXO_SIM_EFFECTS"),
        ('[effects.coulomb_frction.piston]\nforce = "1 N"', "coulomb_frction is not an effect; did you mean .coulomb_friction"),
        ('[effects.wall_heat_transfer.pistn]\nconductance = "1 W/K"', "pistn.*did you mean .piston"),
        ('[effects.coulomb_friction.slid]\nforce = "1 N"', "slid.*did you mean .slide"),
        ('[effects.wall_heat_transfer.piston]\nconductance = "-1 W/K"', "conductance = .-1 W/K.: is outside 0 to"),
        ("[effects.valve_deadband.piston]\nwidth = 0.95", "width = 0.95: is outside 0 to 0.9$"),
        ('[effects.valve_deadband.piston]\nwidth = "5 mm"', "width"),
        ("[effects.valve_deadband.piston]", "width is missing"),
        ("[effects.wall_heat_transfer.piston]", "needs conductance"),
        ('[effects.supply_droop.piston]\nvolume = "1 L"', r"supply_droop acts on supply: write \[effects.supply_droop.supply"),
        ('[effects.piston_leakage.slide]\narea = "1 mm^2"', ".slide. is not a cylinder"),
        ('[effects.sensor_bias.piston]\nvalue = "1 Pa"', "acts on one column"),
        ('[effects.sensor_bias."piston.presure_1"]\nvalue = "1 Pa"', "presure_1.*did you mean .pressure_1"),
        ('[effects.sensor_bias."piston.pressure_1"]\nvalue = "1 barg"', "gauge"),
        ('[effects.moving_wall_temperature.piston]\nheat_capacity = "9 J/K"\noutside_conductance = "1 W/K"', "needs .effects.wall"),
        (
            '[effects.coulomb_friction.piston]\nforce = "1 N"\n[effects.asymmetric_friction.piston]\nforward = "1 N"\nbackward = "2 N"',
            "exclude each other.*keep one",
        ),
        ('[effects.payload_mass.load]\nfactor = 1.1', "nominal number.*bodies.NAME. mass"),
        ('[effects.coulomb_friction.piston]\nforce = "1 N"\nfroce = "2 N"', "froce is not a key.*did you mean .force"),
        ('[effects.line_restriction.piston]\narea = "5 mm^2"\nsensor = "vlave"', "sensor.*did you mean .valve"),
        ('[effects.coulomb_friction]\nforce = "1 N"', "write .effects.coulomb_friction.WHERE. above its keys, .*cylinder or a joint"),
        ('[effects.wall_heat_transfer.supply]\nconductance = "1 W/K"', "cannot act on the supply; it acts on a cylinder"),
        ('[effects.viscous_friction.piston]\ncoefficient = "1 N m s/rad"', "piston. is a cylinder here.*like .1 N s/m.*another name"),
        ('[effects.coulomb_friction.piston]\ntorque = "1 N m"', "piston. is a cylinder here.*like .1 N.;"),
        ('[effects.viscous_friction.piston]\ncoefficient = "1 kg"', "not a unit of this kind"),
        ('[effects.viscous_friction.slide]\ncoefficient = "1 N m s/rad"', "slide. of bench.xml slides: give it like .1 N s/m"),
        ('[effects.unknown.piston]\nacts = "force"\ndepends_on = "position"\nat = ["0 m"]\nvalues = ["1 N"]', "needs from 2 to 16"),
        ('[effects.unknown.piston]\nacts = "force"\ndepends_on = "position"\nat = ["0 m", "1 m"]\nvalues = ["1 N", "2 m"]', "values"),
        ('[effects.unknown.piston]\nacts = "force"\ndepends_on = "position"\nat = ["1 m", "0 m"]\nvalues = ["1 N", "2 N"]', "increase"),
        (
            '[effects.unknown.slide]\nacts = "flow_1"\ndepends_on = "position"\nat = ["0 m", "1 m"]\nvalues = ["1 kg/s", "2 kg/s"]',
            "joint knows no",
        ),
    ],
)  # fmt: skip
def test_effects_that_cannot_be(effects: str, says: str) -> None:
    assert re.search(says, refusal(f"{TEXT}\n{effects}\n"))


def test_parts_that_a_cylinder_does_not_have() -> None:
    single = TEXT.replace('"double"', '"single"') + '\n[effects.external_leakage.piston]\narea_2 = "1 mm^2"\n'
    assert re.search("single acting", refusal(single))
    valveless = TEXT[: TEXT.index("[cylinders.piston.valve]")] + "\n[effects.valve_offset.piston]\nshift = 0.1\n"
    assert re.search("has no valve", refusal(valveless))
    curve = 'acts = "flow_2"\ndepends_on = "position"\nat = ["0 m", "1 m"]\nvalues = ["1 kg/s", "2 kg/s"]\n'
    assert re.search("single acting", refusal(TEXT.replace('"double"', '"single"') + f"\n[effects.unknown.piston]\n{curve}"))


def test_what_acts_on_a_hinge_is_given_in_angles() -> None:
    text = (ROOT / "assets" / "exo_250_psi.toml").read_text(encoding="utf-8")
    wrong = parse(text + '[effects.coulomb_friction.ankle_r]\nforce = "1 N"\n', ROOT / "assets" / "exo_250_psi.toml")
    with pytest.raises(ExoSimError, match=r"force: joint .ankle_r. of exo.xml turns: give it like .1 N.m"):
        load(wrong)
    with pytest.raises(ExoSimError, match="turns"):
        Simulation(wrong, Request("level_walk"))
    load(parse(text + '[effects.coulomb_friction.ankle_r]\ntorque = "1 N m"\n', ROOT / "assets" / "exo_250_psi.toml"))


def test_two_cylinders_on_one_actuator() -> None:
    again = TEXT[TEXT.index("[cylinders.piston]") :].replace("cylinders.piston", "cylinders.second")
    assert re.search('already driven by cylinder "piston"', refusal(TEXT + "\n" + again))


def test_missing_and_unreadable_files(tmp_path: Path) -> None:
    with pytest.raises(RigError, match="no such rig file"):
        read(tmp_path / "none.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00name")
    with pytest.raises(RigError, match="is UTF-16 text"):
        read(tmp_path / "bytes.toml")
    with pytest.raises(RigError, match="cannot be read"):
        read(tmp_path)


CRANK = """
<mujoco model="crank">
  <worldbody>
    <site name="base" pos="0 0 0.05"/>
    <body>
      <joint name="hinge" type="hinge" axis="0 1 0" range="{range}" limited="true"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.02" mass="2"/>
      <site name="end" pos="{end}"/>
    </body>
  </worldbody>
  <tendon><spatial name="rod"><site site="base"/><site site="end"/></spatial></tendon>
  <actuator><motor name="piston" tendon="rod"/></actuator>
</mujoco>
"""


def test_linkage_through_its_dead_centre(tmp_path: Path) -> None:
    (tmp_path / "bench.xml").write_text(CRANK.format(range="-60 60", end="0 0 -0.1"))
    rig = parse(TEXT.replace('retracted_length = "0 m"', 'retracted_length = "0.05 m"'), tmp_path / "bench.toml")
    with pytest.raises(RigError, match=r"the linkage is singular inside the range of joint .hinge.*move an attachment"):
        check_strokes(rig, load(rig))


_LINES = [line for line in TEXT.splitlines() if line and not line.startswith("#")]
_NUMBERS = ["nan", "inf", "-1", '"nan mm"', '"1e400 m"', "true", "[]", "{}", '""', '"1 furlong"', "1979-05-27", '"5 m^2 s"', '"1e-320 m"']


@settings(max_examples=300)
@given(st.data())
def test_whatever_a_rig_holds_it_is_read_or_refused_in_one_line(data: st.DataObject) -> None:
    lines = list(_LINES)
    lines += data.draw(
        st.sampled_from(
            [[], ["[effects.coulomb_friction.piston]", 'force = "3 N"'], ["[effects.sensor_bias.slide.position]", 'value = "1 mm"'],
             ["[effects.unknown.slide]", 'acts = "force"', 'depends_on = "velocity"', 'at = ["0 m/s", "1 m/s"]', 'values = ["0 N", "1 N"]']]
        )
    )  # fmt: skip
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(lines) - 1))
        kind = data.draw(st.sampled_from(["drop", "swap", "value", "text", "double"]))
        if kind == "drop":
            lines.pop(at)
        elif kind == "swap":
            other = data.draw(st.integers(0, len(lines) - 1))
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == "value" and "=" in lines[at]:
            lines[at] = lines[at].split("=")[0] + "= " + data.draw(st.sampled_from(_NUMBERS))
        elif kind == "text":
            lines[at] = data.draw(st.text(max_size=30))
        else:
            lines.insert(at, lines[at])
    try:
        parse("\n".join(lines), BENCH)
    except RigError as error:
        assert "\n" not in str(error)


RECOVERY = '[recovery]\nvolume = "2 l"\npressure = "3 bar"\n'
EDGES = TEXT.replace("[cylinders.piston.valve]", '[cylinders.piston.valve]\nkind = "independent"')


def test_a_recovery_tank_is_read_and_needs_edges_of_each_chambers_own() -> None:
    found = parse(EDGES + RECOVERY, BENCH)
    assert found.recovery is not None and (found.recovery.volume, found.recovery.pressure) == (2e-3, 3e5)
    assert "kind = \"4-way\"" in refusal(TEXT + RECOVERY)
    assert "must lie between atmosphere" in refusal(EDGES + RECOVERY.replace("3 bar", "8 bar"))
    with pytest.raises(RigError, match="leave the table out"):
        found.check_no_recovery("a recording")
