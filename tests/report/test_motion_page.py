"""The page of a sizing along a motion: what was chosen, what became of the rest, and the same bytes twice."""

import numpy as np
import pytest

import exo_sim as exo
from exo_sim.recording.table import Recording
from exo_sim.report.motion_page import motion_page

TIME = np.arange(0.0, 1.0, 0.01)
MOTION = Recording(
    "lift", TIME, {"slide.position": 0.08 + 0.02 * np.sin(2 * np.pi * TIME), "slide.external_force": np.full(len(TIME), -100.0)},
    {"slide.position": "m", "slide.external_force": "N"},
)  # fmt: skip


@pytest.fixture(scope="module")
def found(repository, tmp_path_factory):
    return exo.size(repository / "assets" / "bench.toml", motion=MOTION, trials=4, out=tmp_path_factory.mktemp("sized"))


def test_the_page_says_what_was_chosen_and_what_became_of_the_rest(found):
    text = (found.folder / "report.html").read_text(encoding="utf-8")
    assert "Actuators that follow lift" in text and text.count("<svg") == 2
    for fate, count in found.summary["fates"].items():
        assert f'<td>{fate}</td><td class="n">{count}</td>' in text
    assert f'font-weight:600"><td class="n">{found.study.chosen.number}</td>' in text
    assert "<script" not in text and "<link" not in text


def test_the_same_sizing_gives_the_same_page(found):
    assert motion_page(found.study) == motion_page(found.study) == (found.folder / "report.html").read_text(encoding="utf-8")
