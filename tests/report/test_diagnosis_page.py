import html.parser
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from report import made_up_diagnoses as made_up

from exo_sim.diagnosis.findings import Estimate, Finding, Kind, SignalFit
from exo_sim.diagnosis.result import Diagnosis, Verdict
from exo_sim.physics.declaration import declared
from exo_sim.report import diagnosis_picture, diagnosis_text, diagnosis_words
from exo_sim.report.diagnosis_page import page


class Reader(html.parser.HTMLParser):
    """What a person sees, and what a browser would fetch or leave open."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []
        self.open: list[str] = []
        self.fetched: list[str] = []

    def handle_starttag(self, tag, attrs):
        if tag not in ("meta", "br", "link", "img"):
            self.open.append(tag)
        self.fetched += [
            value for name, value in attrs if name in ("src", "href", "xlink:href") and value and not value.startswith("#")
        ]

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.words.append(data)


def read(text):
    reader = Reader()
    reader.feed(text)
    assert reader.open == []
    return re.sub(r"\s+", " ", " ".join(reader.words)), reader.fetched


def test_the_page_says_everything_that_the_diagnosis_says():
    words, fetched = read(page(made_up.whole(), made_up.RIG))
    assert fetched == []  # self-contained
    for said in (
        "The rig leaves out piston leakage or external leakage at piston",
        "falls from 9.4 to 0.28 kPa (noise 0.25 kPa)",
        "Gas leaks past the piston.",
        "0.0300 mm²",
        "0.0290 to 0.0310 mm²",
        "probability 95 %",
        "97 % lower",
        "piston leakage 80 %",
        "external leakage 20 %",
        "Hold the valve closed.",
        "It follows slide.position.",
        "The valve area is 2.0 % larger than nominal.",
        "× 1.0200",
        "83 %",
        "1–1.5 s",
        "it fits worse <than> the leak",
        "2 % of the error, in piston/force balance",
        "the position was not recorded",
        "rows 100 to 103",
        '-area = "5 mm^2"',
        '+area = "5.1 mm^2" # was "5 mm^2"',
        "slide.position is late",
        "exo-sim 0",
    ):
        assert said in words, said


def test_one_number_is_not_told_twice():
    def volume(*parts):
        numbers = {"factor": Estimate(1.08, "1", 1.07, 1.09), **{f"dead_volume_{side}": e for side, e in parts}}
        return Finding("dead_volume", "piston", Kind.CALIBRATION, "It is larger than nominal.", numbers, 9.0, 0.0)

    alone = volume((1, Estimate(1.08, "1", 1.07, 1.09)))
    both = volume((1, Estimate(1.06, "1", 1.05, 1.07)), (2, Estimate(1.1, "1", 1.09, 1.11)))
    assert list(diagnosis_words.estimates(alone)) == ["dead_volume_1"]
    assert list(diagnosis_words.estimates(both)) == ["dead_volume_1", "dead_volume_2"]
    for finding in (alone, both):
        words, _ = read(page(made_up.whole(effects=(finding,)), made_up.RIG))
        assert words.count("It is larger than nominal.") == 1
    assert "dead volume 2 × 1.10" in words


def test_the_same_diagnosis_gives_the_same_bytes():
    assert page(made_up.whole(), made_up.RIG) == page(made_up.whole(), made_up.RIG)


@pytest.mark.parametrize(
    ("verdict", "sentence"),
    [
        ("consistent", "Recording and rig agree"),
        ("undetermined", "cannot tell"),
        ("calibration", "No physics is missing, but one nominal number is off: flow capacity of piston."),
    ],
)
def test_a_page_of_little_is_a_page_all_the_same(verdict, sentence):
    effects = (made_up.AREA,) if verdict == "calibration" else ()
    diagnosis = Diagnosis(Verdict(verdict), ("monday",), "bench", effects=effects)
    words, _ = read(page(diagnosis, made_up.RIG))
    assert sentence in words
    for heading in ("Proof", "Before and after", "put aside", "What changes"):
        assert heading not in words
    assert sentence in " ".join(diagnosis_text.text(diagnosis).split())


def test_numbers_that_are_none_do_not_break_the_page():
    nothing = math.nan
    lost = replace(made_up.series()[0], before=np.full(1200, nothing), after=np.full(1200, nothing), noise=0.0)
    diagnosis = made_up.whole(
        signals={"piston.pressure_1": SignalFit("Pa", nothing, nothing, nothing)}, series=(lost, made_up.series()[1])
    )
    words, _ = read(page(diagnosis, made_up.RIG))
    assert "nan" not in words.lower()
    assert "nan" not in diagnosis_text.text(diagnosis).lower()


def test_names_from_files_cannot_become_markup():
    diagnosis = made_up.whole(recordings=("<script>alert(1)</script>",), rig="<b>", sensor_remarks=("<img src=x>",))
    text = page(diagnosis, made_up.RIG)
    assert "<script>" not in text and "<img" not in text


def test_recordings_in_which_the_mismatch_sits_are_drawn_first():
    recordings = ("monday", "tuesday", "wednesday")
    every = tuple(s for name in recordings for s in made_up.series(name))
    place = replace(made_up.whole().located[0], recording="wednesday")
    kept = {name: ((4.2, 6.0),) for name in recordings}
    diagnosis = made_up.whole(recordings=recordings, series=every, located=(place,), held_out=kept)
    drawn = [name for name, _ in diagnosis_picture.drawn(diagnosis)]
    assert drawn[0] == "wednesday" and len(drawn) == diagnosis_picture.MOST_RECORDINGS
    words, _ = read(page(diagnosis, made_up.RIG))
    assert "1 more recording in comparison.rrd" in words
    assert "On the held-out time of every recording, the error" in words


def test_located_spans_are_drawn_with_the_signal_that_they_are_about():
    place = made_up.whole().located[0]
    assert diagnosis_picture.concerns(place, "piston.pressure_1")
    assert not diagnosis_picture.concerns(place, "piston.pressure_2")
    assert not diagnosis_picture.concerns(place, "piston.force_balance")
    force = replace(place, where="piston", equation="force balance")
    assert diagnosis_picture.concerns(force, "piston.force_balance") and diagnosis_picture.concerns(force, "slide.position")
    assert not diagnosis_picture.concerns(force, "piston.pressure_1")


def test_the_near_look_lies_in_held_out_time_where_before_and_after_differ_most():
    one = made_up.series(seconds=12.0)[0]
    start, stop = diagnosis_picture.nearest_look(one, [(6.0, 9.5)])
    assert start >= 6.0 and stop <= 9.5
    assert start <= 2.5 * math.pi <= stop  # where the error's sine has its peak


def test_what_leaving_it_out_costs_and_how_to_see_it_on_the_machine_are_said() -> None:
    leak = replace(made_up.LEAK, ambiguous_with=(), probabilities={}, cost=0.183)
    experiment = declared()["piston_leakage"].experiment
    words, _ = read(page(made_up.whole(effects=(leak,)), made_up.RIG))
    assert "puts the predictions off by 18 % of how much these signals vary" in words
    assert f"To see it on the machine: {experiment}." in words
    assert diagnosis_words.cost(replace(leak, cost=0.0)) == ""
    assert diagnosis_words.cost(replace(leak, cost=240.0)) == "Left out, it puts the predictions off by more than these signals vary."
    assert diagnosis_words.on_the_machine(made_up.LEAK) == ""  # two look the same: the next experiment settles it
    assert diagnosis_words.on_the_machine(replace(leak, name="made_up")) == ""


def test_errors_far_below_the_noise_are_none():
    rounding = Diagnosis(Verdict.CONSISTENT, ("r",), "bench", signals={"rod.force_balance": SignalFit("N", 5e-14, 5e-14, 0.06)})
    assert "10⁻" not in diagnosis_text.text(rounding)
    series = made_up.whole().series[0]
    quiet = replace(series, recorded=series.before, after=series.before, noise=1.0)
    errors = diagnosis_picture.shown_errors(quiet, np.linspace(quiet.time[0], quiet.time[-1], 5))
    assert all(np.allclose(error, diagnosis_picture.LEAST_SHOWN) for error in errors)


def test_the_curve_of_what_has_no_name_is_said_to_be_in_the_rig_only_where_it_is():
    words, _ = read(page(made_up.whole(), made_up.RIG))
    assert "The fitted curve, with twice" in words
    held, _ = read(page(made_up.whole(improved="[effects.unknown.piston]"), made_up.RIG))
    assert "The fitted curve that stands for it in improved.toml, with twice" in held
