import html.parser
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from report import made_up_diagnoses as made_up

from exo_sim.diagnosis.findings import Estimate, Finding, Kind, NextExperiment, Rejected, SignalFit, Unexplained
from exo_sim.diagnosis.result import Diagnosis, Verdict
from exo_sim.physics.declaration import declared
from exo_sim.report import diagnosis_picture, diagnosis_text, diagnosis_words, finding_lines
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


def test_the_summary_fits_on_a_screen_and_ends_with_the_files():
    many = made_up.whole(effects=(made_up.LEAK,) * 12, sensor_remarks=tuple(f"remark {i}" for i in range(40)))
    for diagnosis in (made_up.whole(), many):
        lines = diagnosis_text.text(diagnosis, ["found/report.html: the page"]).splitlines()
        assert len(lines) <= diagnosis_text.MOST_LINES
        assert max(map(len, lines)) <= finding_lines.WIDTH
        assert lines[-1] == "found/report.html: the page"
    text = diagnosis_text.text(made_up.whole())
    assert "area = 0.0300 mm²  (95 %: 0.0290 to 0.0310 mm²)" in text
    assert "cannot be distinguished: piston leakage 80 %, external leakage 20 %" in text
    assert re.search(r"^  \(\d+ lines more in the report\)$", diagnosis_text.text(many), re.MULTILINE)
    assert diagnosis_text.text(many).count("0.0290 to 0.0310 mm²") == 12


def test_every_finding_is_told_with_its_number_however_many_they_are():
    every = tuple(replace(made_up.LEAK, where=f"cylinder_{i}", ambiguous_with=()) for i in range(50))
    text = diagnosis_text.text(made_up.whole(effects=every))
    assert all(f"piston leakage at cylinder_{i}: area 0.0300 mm² (95 %: 0.0290 to 0.0310 mm²)" in text for i in range(50))
    fewer = diagnosis_text.text(made_up.whole(effects=every[:8]))
    assert "piston leakage at cylinder_0 (missing physics): Gas leaks past the piston." in fewer  # all that is said of the first
    assert len(fewer.splitlines()) <= diagnosis_text.MOST_LINES


def test_a_run_free_stands_beside_the_windows_of_the_same_column_in_the_terminal() -> None:
    runs = {"piston.pressure_1": SignalFit("Pa", 86400.0, 1280.0, 256.0), "slide.position": SignalFit("m", 7.66e-2, 2.85e-4, 2e-5)}
    lines = diagnosis_text.text(made_up.whole(effects=(made_up.LEAK,), free_run=runs)).splitlines()
    rows = [" ".join(line.split()) for line in lines if ("run free" in line and "before" in line) or line.startswith("  slide.position")]
    assert rows == [
        "piston.pressure_1 before 9.42 after 0.279 run free 86.4 1.28 noise 0.250 kPa",
        "slide.position run free 76.6 0.285 noise 0.0200 mm",
    ]


def test_the_verdict_counts_what_is_off_and_names_what_is_missing():
    assert diagnosis_words.verdict(made_up.whole()) == (
        "The rig leaves out piston leakage or external leakage at piston; something without a name acts at piston; "
        "slide.position is late; one nominal number is off as well."
    )


def test_a_rest_far_above_the_noise_is_never_silent() -> None:
    loud = Unexplained("piston/force balance", (), 0.1, error=12.0, noise=0.2, unit="N")
    quiet = replace(loud, error=0.3)
    agree = Diagnosis(Verdict.CONSISTENT, ("monday",), "bench")
    assert "agree to within the noise" in diagnosis_words.verdict(replace(agree, unexplained=(quiet,)))
    assert "60 times the noise" in diagnosis_words.verdict(replace(agree, unexplained=(loud,)))
    drifts = replace(agree, free_run={"slide.position": SignalFit("m", 1e-3, 8.6e-4, 2e-5)})
    assert "50 times the noise (860 µm with improved.toml)" in diagnosis_words.verdict(drifts)
    named = Finding("coulomb_friction", "piston", Kind.MISSING_PHYSICS, "Dry friction.", {}, 60.0, 0.9)
    found = Diagnosis(Verdict.MISMATCH, ("monday",), "bench", effects=(named,), unexplained=(loud,))
    assert "Coulomb friction" in diagnosis_words.verdict(found) and "60 times the noise" in diagnosis_words.verdict(found)


@pytest.mark.parametrize(
    ("probability", "words"), [(0.95, "almost certain"), (0.9, "very likely"), (0.7, "likely"), (0.5, "as likely"), (0.1, "doubtful")]
)
def test_probabilities_are_words_and_a_number(probability: float, words: str) -> None:
    said = diagnosis_words.likelihood(probability)
    assert said.startswith(words) and f"{100 * probability:.0f} %" in said


def test_of_two_that_look_the_same_the_probability_is_that_of_either() -> None:
    alone = Finding("coulomb_friction", "piston", Kind.MISSING_PHYSICS, "", {}, 60.0, 0.0)
    both = replace(alone, ambiguous_with=("asymmetric_friction",))
    assert "looks like it" in diagnosis_words.evidence(both) and "looks like it" not in diagnosis_words.evidence(alone)


def test_nobody_is_sent_to_a_rig_that_holds_nothing_new() -> None:
    off = Finding("payload_mass", "slide", Kind.CALIBRATION, "The moved mass is 1.4 % smaller.", {}, 4.0, 0.0)
    found = Diagnosis(Verdict.CALIBRATION, ("monday",), "bench", effects=(off,), improved="[rig]")
    assert "improved.toml" in diagnosis_words.first_step(found)
    assert diagnosis_words.first_step(replace(found, improves=False)).startswith("Keep the rig as it is")


def test_what_leaving_it_out_costs_and_how_to_see_it_on_the_machine_are_said() -> None:
    leak = replace(made_up.LEAK, ambiguous_with=(), probabilities={}, cost=0.183)
    experiment = declared()["piston_leakage"].experiment
    words, _ = read(page(made_up.whole(effects=(leak,)), made_up.RIG))
    assert "puts the predictions off by 18 % of how much these signals vary" in words
    assert f"To see it on the machine: {experiment}." in words
    assert diagnosis_words.cost(replace(leak, cost=0.0)) == ""
    assert diagnosis_words.on_the_machine(made_up.LEAK) == ""  # two look the same: the next experiment settles it
    assert diagnosis_words.on_the_machine(replace(leak, name="made_up")) == ""


def test_what_was_put_aside_for_one_reason_stands_together() -> None:
    put_aside = tuple(
        Rejected(name, where, why)
        for name, where, why in (
            ("viscous_friction", "piston", "nothing"), ("wall_heat_transfer", "piston", "worse"), ("return_spring", "piston", "nothing"),
            ("viscous_friction", "slide", "nothing"), ("viscous_friction", "piston", "nothing"),
        )
    )  # fmt: skip
    assert diagnosis_words.weighed_against(made_up.whole(rejected=put_aside)) == [
        ("viscous friction and return spring at piston; viscous friction at slide", "nothing"), ("wall heat transfer at piston", "worse"),
    ]  # fmt: skip


def test_what_costs_most_comes_first() -> None:
    cheap = Finding("viscous_friction", "piston", Kind.MISSING_PHYSICS, "", {}, 60.0, 0.9, cost=0.01)
    dear = Finding("piston_leakage", "piston", Kind.MISSING_PHYSICS, "", {}, 9.0, 0.5, cost=0.2)
    improved = "[effects.piston_leakage.piston]\n[effects.viscous_friction.piston]\n"
    found = Diagnosis(Verdict.MISMATCH, ("monday",), "bench", effects=(cheap, dear), improved=improved)
    assert "piston leakage at piston matters most" in diagnosis_words.first_step(found)
    assert "does without it" in diagnosis_words.first_step(replace(found, improved=""))
    stuck = Finding("sensor_stuck", "slide.position", Kind.SENSOR, "", {}, 10.0, 0.0)
    assert "Check the sensor of slide.position" in diagnosis_words.first_step(replace(found, effects=(dear, stuck)))
    assert diagnosis_words.first_step(Diagnosis(Verdict.CONSISTENT, ("monday",), "bench")) == ""


def test_a_column_that_nothing_reads_is_to_be_renamed_before_anything_else() -> None:
    checks = ({"what": "part", "columns": ["slid.position"], "says": "", "meant": "slide.position"},)
    found = made_up.whole(checks=checks)
    assert diagnosis_words.first_step(found).startswith('Rename column "slid.position" to "slide.position" and diagnose again: under that')
    both = replace(found, checks=(*checks, {"what": "column", "columns": ["piston.presure_2"], "says": "", "meant": "piston.pressure_2"}))
    assert 'and "piston.presure_2" to "piston.pressure_2" and diagnose' in diagnosis_words.first_step(both)
    assert "Rename" not in diagnosis_words.first_step(replace(found, checks=({"what": "gauge", "columns": ["a"], "says": ""},)))


def test_errors_of_columns_without_noise_are_told_beside_what_a_sensor_shows():
    key = "piston.pressure_1"
    computed = Diagnosis(Verdict.CONSISTENT, ("r",), "bench", signals={key: SignalFit("Pa", 5.2, 3.6, 54.0)}, computed=(key,))
    assert "agree to within what a sensor could show" in diagnosis_words.verdict(computed)
    assert "(noise none; a sensor shows 54 Pa)" in diagnosis_words.proof(computed)
    drifting = replace(computed, free_run={key: SignalFit("Pa", 5400.0, 5400.0, 54.0)})
    assert "100 times what a sensor shows of noise" in diagnosis_words.verdict(drifting)
    measured = replace(computed, computed=())
    assert "agree to within the noise" in diagnosis_words.verdict(measured) and "(noise 54 Pa)" in diagnosis_words.proof(measured)


def test_errors_far_below_the_noise_are_none():
    rounding = Diagnosis(Verdict.CONSISTENT, ("r",), "bench", signals={"rod.force_balance": SignalFit("N", 5e-14, 5e-14, 0.06)})
    assert "10⁻" not in diagnosis_text.text(rounding)
    series = made_up.whole().series[0]
    quiet = replace(series, recorded=series.before, after=series.before, noise=1.0)
    errors = diagnosis_picture.shown_errors(quiet, np.linspace(quiet.time[0], quiet.time[-1], 5))
    assert all(np.allclose(error, diagnosis_picture.LEAST_SHOWN) for error in errors)


def test_sizes_that_must_be_checked_come_first_with_what_the_improved_rig_still_misses():
    far = {"slide.position": SignalFit("m", 0.114, 0.1, 2e-5)}
    wrong = replace(made_up.whole(), sizes="bore in cylinders.piston of j.toml", free_run=far)
    said = diagnosis_words.first_step(wrong)
    assert said.startswith("Check bore in cylinders.piston of j.toml. Run free, improved.toml is still 100 mm off")
    assert "(110 before, noise 0.020)" in said
    for nothing_said in (replace(wrong, free_run={}), replace(wrong, by_chance=("slide.position",))):
        assert diagnosis_words.first_step(nothing_said) == "Check bore in cylinders.piston of j.toml."


def test_sizes_are_not_blamed_first_where_the_time_was_up_before_everything_had_been_sought():
    far = {"slide.position": SignalFit("m", 0.114, 0.1, 2e-5)}
    cut = replace(made_up.whole(), sizes="bore in cylinders.piston of j.toml", free_run=far, stopped=True)
    said = diagnosis_words.first_step(cut)
    assert said.startswith("Diagnose again with a longer budget") and "do not build on it yet. If it stays so, check bore" in said


def test_a_column_that_could_not_be_used_is_to_be_put_right_first():
    found = made_up.whole(checks=({"what": "unread", "columns": ["piston.pressure_1 [mm]"], "says": ""},))
    assert diagnosis_words.first_step(found) == (
        'Put column "piston.pressure_1 [mm]" right and diagnose again: this was found without it.'
    )
    both = replace(found, checks=({"what": "unread", "columns": ["a", "b"], "says": ""},))
    assert diagnosis_words.first_step(both).startswith('Put columns "a" and "b" right')
    percent = Finding("sensor_scale", "piston.valve_command", Kind.SENSOR, "", {}, 10.0, 0.0)
    said = diagnosis_words.first_step(made_up.whole(effects=(percent,)))
    assert said.startswith('Put the unit of "piston.valve_command" right')


def test_a_valve_that_the_rig_lacks_comes_first() -> None:
    found = made_up.whole(checks=({"what": "valve", "columns": ["piston.valve_command"], "says": ""},))
    assert diagnosis_words.first_step(found).startswith("Write [cylinders.piston.valve] in rig.toml and diagnose again")
    found = made_up.whole(checks=({"what": "valve kind", "columns": ["piston.valve_command_1"], "says": ""},))
    assert diagnosis_words.first_step(found).startswith("Put kind in [cylinders.piston.valve] of rig.toml right and diagnose again")


def test_the_curve_of_what_has_no_name_is_said_to_be_in_the_rig_only_where_it_is():
    words, _ = read(page(made_up.whole(), made_up.RIG))
    assert "The fitted curve, with twice" in words
    held, _ = read(page(made_up.whole(improved="[effects.unknown.piston]"), made_up.RIG))
    assert "The fitted curve that stands for it in improved.toml, with twice" in held


def test_what_a_curve_predicts_of_what_no_name_explains_is_said():
    left = Unexplained("piston/force balance", ("slide.position",), 0.999, 9.3, 0.55, "N", by_curve=0.865)
    assert diagnosis_words.unexplained(left).endswith("follows slide.position, of whose variance a curve predicts 86 %")
    assert "held-out error 60 % lower with its curve" in diagnosis_words.evidence(made_up.NAMELESS)


def test_how_much_better_one_experiment_is_than_another_is_said():
    ranked = (("slowly", 2057.0), ("quickly", 90.0), ("blocked", 1.2))
    assert diagnosis_words.settles(ranked) == [
        ("slowly", "surely"), ("quickly", "surely, with 4 % of that evidence"), ("blocked", "most likely, with under 1 % of that evidence"),
    ]  # fmt: skip
    assert diagnosis_words.settles(()) == []
    following = NextExperiment("both explain it", "slowly", ("piston_leakage", "external_leakage"), ranked)
    found = made_up.whole(next_experiment=following)
    assert [one["expected_log10_odds"] for one in found.as_dict()["next_experiment"]["ranked"]] == [2060.0, 90.0, 1.2]
