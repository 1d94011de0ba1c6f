"""What the documentation says runs: Python blocks as they stand, commands with options that exist, pages in step with the declarations."""

from __future__ import annotations

import re
import runpy
import shlex
from pathlib import Path

import click
import pytest

from exo_sim.cli import frame, main
from exo_sim.rig import key_reference

ROOT = Path(__file__).resolve().parents[1]
#: Pages whose blocks run in a process of their own, or take files that are not there.
ELSEWHERE = ("add_an_effect.md",)
#: Pages whose Python shows calls with files that the reader has.
WITH_FILES = ("recordings.md",)
#: Pages whose Python takes more than a few seconds.
NOTEBOOKS = ("one_diagnosis.md",)  # a block goes on where the one before it ended
SLOW = ("run_a_walk.md", *NOTEBOOKS)
PAGES = sorted(path for path in (ROOT / "docs").glob("*.md") if path.name not in ELSEWHERE)


def blocks(path: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("page", [
    pytest.param(path, marks=[pytest.mark.slow] if path.name in SLOW else [], id=path.stem) for path in PAGES
    if blocks(path, "python") and path.name not in WITH_FILES
])  # fmt: skip
def test_the_python_of_a_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "__main__"}
    for block in blocks(page, "python"):
        exec(compile(block, page.name, "exec"), names if page.name in NOTEBOOKS else dict(names))
    assert capsys.readouterr().out


def test_a_comparison_is_read_back_as_the_page_of_recordings_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import numpy as np

    from exo_sim.recording import Recording, write_rrd

    time = np.arange(100) / 100.0
    key, recorded = "piston.pressure_1", 2e5 + 1e4 * np.sin(9.0 * time)
    shown, after = (Recording("r", time, {key: values}, {key: "Pa"}) for values in (recorded, recorded + 300.0 * (-1.0) ** np.arange(100)))
    write_rrd(tmp_path / "comparison.rrd", shown, overlays={"before": after, "after": after})
    monkeypatch.chdir(tmp_path)
    for block in blocks(ROOT / "docs" / "recordings.md", "python run"):
        exec(compile(block, "recordings.md", "exec"), {})
    first, second = capsys.readouterr().out.splitlines()
    assert float(first.split()[0]) == pytest.approx(300.0) and first.split()[1] == "Pa"
    assert second.split(maxsplit=1) == ["100", "[2.0]"]


def test_the_python_of_the_page_of_recordings_runs_on_files_like_the_reader_s(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import numpy as np

    from exo_sim.recording import Recording, write_table

    time = np.arange(400) / 200.0
    key = "piston.pressure_1"
    simulated = Recording("bench", time, {key: 2e5 + 1e4 * np.sin(9.0 * time)}, {key: "Pa"})
    monkeypatch.chdir(tmp_path)
    write_table("bench.csv", simulated)
    for block in blocks(ROOT / "docs" / "recordings.md", "python"):
        exec(compile(block, "recordings.md", "exec"), {"simulated": simulated})
    assert (tmp_path / "bench.parquet").is_file() and (tmp_path / "bench.rrd").is_file()


def test_the_page_of_recordings_has_every_signal_that_is_measured() -> None:
    from exo_sim import signals

    page = (ROOT / "docs" / "recordings.md").read_text(encoding="utf-8")
    for signal in signals.TABLE:
        if signal.measured:
            known = signal.name.removesuffix(f"_{signal.name[-1]}") if signal.name[-2:] in ("_y", "_z") else signal.name
            assert re.search(rf"`(?:supply\.|exhaust\.)?{known}(?:_x)?(?: \[[^`]*)?`", page), signal.name


def test_the_page_of_recordings_has_every_unit_that_is_put_right() -> None:
    from exo_sim.conventions import positions, pressures, signs

    page = (ROOT / "docs" / "recordings.md").read_text(encoding="utf-8")
    told = page[page.index("## What is put right") : page.index("## What is looked for")]
    clocks = [unit for unit in signs.CLOCKS if "not" not in unit]
    for unit in (*pressures.UNITS, *positions.SLIDING, *positions.TURNING, *clocks):
        assert re.search(rf"\b{unit}\b", told), unit


@pytest.mark.parametrize(("page", "number"), [("run_a_walk.md", 0), ("your_gait.md", 1)])
def test_a_scenario_file_of_a_page_is_a_scenario(page: str, number: int, tmp_path: Path) -> None:
    from exo_sim.gait import scenario_file

    (tmp_path / "mine.toml").write_text(blocks(ROOT / "docs" / page, "toml")[number])
    assert scenario_file.read(tmp_path / "mine.toml").variation is not None


@pytest.mark.parametrize(("number", "climb"), [(1, 0.08), (2, 0.16 / 0.30)])
def test_the_scenario_files_of_other_ground_climb(number: int, climb: float, tmp_path: Path) -> None:
    from exo_sim.gait import scenario, scenario_file
    from exo_sim.machine.person import Person

    (tmp_path / "mine.toml").write_text(blocks(ROOT / "docs" / "run_a_walk.md", "toml")[number])
    motion = scenario.motion(scenario_file.read(tmp_path / "mine.toml"), Person(), 1.0)
    assert motion.climb / motion.advance == pytest.approx(climb)


@pytest.mark.parametrize("page", [pytest.param(path, id=path.stem) for path in PAGES])
def test_the_commands_of_a_page_exist(page: Path) -> None:
    lines = [shlex.split(line, comments=True) for block in blocks(page, "sh") for line in block.replace("\\\n", " ").splitlines()]
    for words in lines:
        while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
            words = words[1:]
        if words[:1] != ["exo-sim"] or len(words) < 2:
            continue
        verb = frame.program.get_command(click.Context(frame.program), words[1])
        assert verb is not None, words
        rest = words[2:]
        if isinstance(verb, click.Group):
            inner = verb.get_command(click.Context(verb), rest[0])
            assert inner is not None, words
            verb, rest = inner, rest[1:]
        verb.make_parser(click.Context(verb)).parse_args(rest)  # an option that is not there is refused


def test_the_page_of_the_api_has_every_name_of_it() -> None:
    import exo_sim

    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    for line in Path(exo_sim.__file__).with_suffix(".pyi").read_text().splitlines():
        if match := re.match(r"from (\S+) import (\w+) as (\w+)", line):
            name = "Effects" if match[2] == "effects" else match[2]
            assert f"::: {match[1]}.{name}\n" in page + "\n" or match[2] == "ExoSimError", line


def test_the_column_map_of_the_page_of_recordings_is_one(tmp_path: Path) -> None:
    from exo_sim.recording.column_map import read_column_map

    (tmp_path / "map.toml").write_text(blocks(ROOT / "docs" / "recordings.md", "toml")[0])
    found = read_column_map(tmp_path / "map.toml")
    assert set(found.columns) == {"t(ms)", "Pos", "P1"} and not found.header and found.delimiter == ";"


def test_the_gait_of_the_page_of_gaits_is_read_up_to_its_file(tmp_path: Path) -> None:
    from exo_sim.errors import ScenarioError
    from exo_sim.gait import scenario_file

    (tmp_path / "mine.toml").write_text(blocks(ROOT / "docs" / "your_gait.md", "toml")[0])
    with pytest.raises(ScenarioError, match=r'walk\.csv": there is no such gait file'):
        scenario_file.read(tmp_path / "mine.toml")


@pytest.mark.slow
def test_the_controller_and_the_motion_of_the_pages_run_a_bench(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    mine = blocks(ROOT / "docs" / "your_controller.md", "python")[0].partition("run = exo.")[0]
    (tmp_path / "mine.py").write_text(mine)
    (make,) = (block for block in blocks(ROOT / "docs" / "your_machine.md", "python") if "motion.csv" in block)
    exec(compile(make, "your_machine.md", "exec"), {})
    assert main(["run", "motion.csv", "--rig", "bench", "--controller", "mine.py:Impedance", "--quiet"]) == 0
    assert "error rms" in capsys.readouterr().out


@pytest.mark.slow
def test_the_catalogue_of_the_page_of_sizing_sizes_a_walk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "sizing.md").read_text(encoding="utf-8")
    (table,) = re.findall(r"A catalogue of one's own:\n\n((?:    .*\n)+)", page)
    (tmp_path / "mine.toml").write_text(re.sub(r"(?m)^    ", "", table))
    assert main(["size", "--catalogue", "mine.toml", "--trials", "60", "--out", "sized", "--quiet"]) == 0
    assert (tmp_path / "sized" / "sized.toml").is_file()


@pytest.mark.slow
def test_the_first_quarter_of_an_hour_shows_what_comes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from exo_sim.trials import develop

    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "first_quarter_of_an_hour.md").read_text(encoding="utf-8")
    assert develop.main(["--out", "cases", "--effects", "piston_leakage"]) == 0
    case = "cases/piston_leakage_0"
    assert main(["diagnose", f"{case}/recording.csv", "--rig", f"{case}/rig.toml", "--out", "found", "--quiet"]) == 3
    printed = capsys.readouterr().out.splitlines()
    first = next(number for number, line in enumerate(printed) if line.startswith("MISMATCH"))
    assert "\n".join(printed[first : first + 2]) in page


@pytest.mark.slow
def test_the_diagnosis_of_the_page_of_python_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import benches

    from exo_sim.recording import write_table

    monkeypatch.chdir(tmp_path)
    machine = benches.bench(tmp_path)
    write_table("recording.csv", benches.recorded(machine))
    write_table("another.csv", benches.recorded(machine, 2.0))
    (block,) = blocks(ROOT / "docs" / "python.md", "python files")
    exec(compile(block, "python.md", "exec"), {})
    verdict = capsys.readouterr().out.split(maxsplit=1)[0]
    assert verdict in ("consistent", "calibration", "mismatch", "undetermined") and (tmp_path / "found" / "improved.toml").is_file()


def test_every_block_of_a_page_is_of_a_kind_that_a_test_knows() -> None:
    """Python, commands, and tables for files are run, parsed or read by a test here or in `test_external_effects`; the rest is shown."""
    known = {"sh", "python", "python run", "python files", "toml", "toml entry-point", ""}
    for page in sorted((ROOT / "docs").glob("*.md")):
        fences = re.findall(r"^```(.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
        assert not set(fences) - known, (page.name, set(fences) - known)


def test_the_reference_of_the_rig_is_what_the_reader_asks_for() -> None:
    found = runpy.run_path(str(ROOT / "scripts" / "document_rig"))["text"]()
    assert found == (ROOT / "docs" / "rig_reference.md").read_text(encoding="utf-8"), "run scripts/document_rig"


def test_every_key_has_a_meaning() -> None:
    keys = {key.name: key for key in key_reference.every_key()}
    assert keys.keys() == key_reference.MEANINGS.keys()
    assert all(key.meaning for key in keys.values())
    assert keys["cylinders.NAME.bore"].unit == "m" and keys["cylinders.NAME.bore"].default == "required"
    assert keys["name"].default == "of the file"  # not what the rig that the reference is made of is called


def test_the_site_builds_strictly_and_fetches_nothing(tmp_path: Path) -> None:
    mkdocs = pytest.importorskip("mkdocs.commands.build")
    pytest.importorskip("mkdocstrings")
    from mkdocs.config import load_config

    config = load_config(str(ROOT / "mkdocs.yml"), site_dir=str(tmp_path / "site"), strict=True)
    mkdocs.build(config)
    pages = list((tmp_path / "site").glob("*.html"))
    assert len(pages) > 15 and "exo_sim.api.diagnosing.diagnose" in (tmp_path / "site" / "api.html").read_text()
    for page in pages:
        fetched = re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="(https?://[^"]*)"', page.read_text(encoding="utf-8"))
        assert not [url for url in fetched if not url.startswith("http://127.0.0.1")], page
