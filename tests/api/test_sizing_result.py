"""What both searches for actuators give back, on a made-up one."""

from dataclasses import dataclass

import pytest

from exo_sim.api.rig import Rig
from exo_sim.api.sizing_result import SizingResult


def design(number, gas):
    return {
        "design": number, "bore_mm": {"knee": 40}, "supply_pa": 8e5, "torque_margin": 0.3, "gas_kg_per_stride": gas,
        "actuator_mass_kg": 2.0,
    }  # fmt: skip


@dataclass(frozen=True, repr=False)
class MadeUp(SizingResult[str]):
    @property
    def summary(self):
        return {"pareto": [design(0, 3e-3), design(4, 2e-3)], "recommended": design(4, 2e-3)}

    def __str__(self):
        return self.study


@pytest.fixture
def result(repository, tmp_path):
    kept = tmp_path / "kept"
    kept.mkdir()
    rig = Rig.load(repository / "assets" / "bench.toml")
    rig.save(kept / "sized.toml")
    (kept / "report.html").write_text("the page")
    return MadeUp("in words", kept, rig)


def test_front_and_words_are_those_of_its_summary(result):
    assert [one["design"] for one in result.front] == [0, 4]
    assert repr(result) == f"<exo.MadeUp of {result.chosen.name}: 2 designs on the Pareto front>" and str(result) == "in words"
    assert result._repr_html_().count("<tr>") == 3


def test_it_saves_a_rig_that_can_be_read_and_all_that_the_search_wrote(result, tmp_path):
    place = result.save(tmp_path / "elsewhere")
    assert (place / "report.html").read_text() == "the page"
    assert Rig.load(place / "sized.toml").name == result.chosen.name
    assert result.save(result.folder) == result.folder and (result.folder / "report.html").read_text() == "the page"
