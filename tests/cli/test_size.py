"""The verb: its JSON, what it writes, its hand calculation, and one line for what cannot be."""

import json

import pytest

from exo_sim import rig as rigs
from exo_sim.cli import main
from exo_sim.outputs import alone_in


def test_by_hand_gives_the_papers_number(capsys):
    assert main(["size", "--quick", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    steps = {step["what"]: step for step in data["by_hand"]["example"]}
    flow = steps["supply flow, half of the gauge pressure as back-pressure"]
    assert flow["value"] == pytest.approx(52.8) and flow["unit"] == "in^3/s"
    assert steps["with half of the absolute pressure instead"]["value"] == pytest.approx(49.868538, rel=1e-6)
    assert steps["as mass"]["value"] == pytest.approx(18.76523, rel=1e-5)
    assert data["schema"] == "exo-sim/size/1" and data["pareto"] == [] and data["chosen"] is None
    assert len(data["by_hand"]["joints"]) == 2


@pytest.fixture(scope="module")
def sized(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sized")
    owner = rigs.read(rigs_default())
    rig = folder / "improved.toml"
    text = owner.text.replace('model = "exo.xml"', f'model = "{owner.model}"')
    for name in owner.cylinders:
        text += f'\n[effects.coulomb_friction.{name}]\nforce = "60 N"\n\n[effects.wall_heat_transfer.{name}]\nconductance = "1 W/K"\n'
    rig.write_text(text, encoding="utf-8")
    out = folder / "out"
    arguments = ["size", "--rig", str(rig), "--trials", "45", "--jobs", "1", "--out", str(out), "--seed", "3", "--json", "--quiet"]
    return arguments, out


def rigs_default():
    from exo_sim.simulation.walk import rig_at_250_psi

    return rig_at_250_psi()


def test_json_and_files(sized, capsys):
    arguments, out = sized
    assert main(arguments) == 0
    captured = capsys.readouterr()
    data = json.loads(captured.out)
    assert captured.err == ""
    assert data["schema"] == "exo-sim/size/1" and data["evaluated"] >= 45 and data["chosen"].endswith("sized.toml")
    keys = {"bore_mm", "stroke_mm", "supply_pa", "valve_area_mm2", "torque_margin", "gas_kg_per_stride", "actuator_mass_kg",
            "torque_error_rms_nm"}  # fmt: skip
    assert data["pareto"] and all(keys <= set(entry) for entry in data["pareto"])
    margins = [entry["torque_margin"] for entry in data["pareto"]]
    assert margins == sorted(margins, reverse=True) and min(margins) >= 0.0

    listed = sorted(number for numbers in data["designs_by_fate"].values() for number in numbers)
    assert listed == list(range(data["evaluated"]))
    assert {what: len(numbers) for what, numbers in data["designs_by_fate"].items()} == data["fates"]
    assert sorted(data["designs_by_fate"]["on the front"]) == sorted(entry["design"] for entry in data["pareto"])

    chosen = data["recommended"]
    rig = rigs.read(out / "sized.toml")
    assert rig.cylinders["knee_r"].bore == pytest.approx(chosen["bore_mm"]["knee"] * 1e-3)
    attachment = rig.cylinders["hip_l"].attachment
    assert attachment is not None and attachment.base[0] == pytest.approx(chosen["attachment_mm"]["hip"]["from"][0] * 1e-3)
    assert rig.supply.pressure == pytest.approx(chosen["supply_pa"]) and rig.supply.pressure <= 1.101325e6
    assert {effect.name for effect in rig.effects} == {"coulomb_friction", "wall_heat_transfer"}

    without = {entry["what"]: entry["same_design"] for entry in data["without"]}
    assert set(without) == {"friction", "heat loss", "any effect"}
    assert without["friction"]["torque_margin"] > chosen["torque_margin"]
    assert without["heat loss"]["torque_margin"] == chosen["torque_margin"]
    assert without["heat loss"]["gas_kg_per_stride"] != chosen["gas_kg_per_stride"]

    assert (out / "sized.rrd").is_file() and (out / "sized.parquet").is_file()
    page = (out / "report.html").read_text(encoding="utf-8")
    assert page.count("<details><summary>numbers</summary>") >= 2 and "on the Pareto front" in page  # hundreds of numbers are folded
    assert "lowest margin: " in page and "thinnest" not in page and "in hand" not in page
    assert page.count("<svg") == 4 and "http://" not in page.replace("http://www.w3.org", "").replace("http://purl.org", "").replace(
        "http://creativecommons.org", "")  # fmt: skip

    again = main(arguments)
    second = json.loads(capsys.readouterr().out)
    assert again == 0 and second["new"] == 0 and second["pareto"] == data["pareto"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--scenario", "level_wlak"], "did you mean"),
        (["--payload", "34"], "unit"),
        (["--payload", "80 kg"], "45 kg"),
        (["--pressure-limit", "2 bar"], "leaves nothing"),
        (["--pressure-limit", "150 psig"], "gauge"),
        (["--jobs", "0"], "--jobs"),
        (["--payload", "-5 kg"], "too small"),
        (["--rig", "nowhere.toml"], "no file"),
        (["--trials", "0"], "range"),
        (["--scheduler", "nonsense", "--trials", "1"], "tcp://HOST:PORT"),
        (["--speed", "3"], "0.7 to 1.3"),
        (["--quick"], "writes no files"),
        (["--joints", ","], "name at least one"),
        (["--catalogue", "smcc"], 'did you mean "smc"'),
        (["--fix", "hip.valve=1 m^2"], "is the unit right"),
        (["--fix", "hip.from=3 m"], "is the unit right"),
        (["--springs"], "--valves independent"),
        (["--tank", "2 l"], "--valves independent"),
        (["--motion", __file__], "--rig"),
        (["--motion", __file__, "--rig", "bench", "--robust", "--tank", "2 l"], "--tank, --robust are for machines that are worn"),
    ],
)
def test_bad_input_is_one_line(arguments, words, capsys, tmp_path):
    assert main(["size", *arguments, "--out", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    assert words in err and err.count("\n") == 1


def test_two_in_one_folder_do_not_score_twice(capsys, tmp_path):
    with alone_in(tmp_path, "size"):
        assert main(["size", "--trials", "1", "--jobs", "1", "--out", str(tmp_path)]) == 2
    err = capsys.readouterr().err
    assert "another size is at work" in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_file_where_the_folder_should_be_is_one_line(capsys, tmp_path):
    (tmp_path / "out").write_text("mine", encoding="utf-8")
    assert main(["size", "--trials", "1", "--jobs", "1", "--out", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    assert "is a file; name a folder" in err and err.count("\n") == 1
    assert (tmp_path / "out").read_text(encoding="utf-8") == "mine"
