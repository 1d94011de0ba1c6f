"""What is said of a diagnosis wherever it is shown: the verdict, what to do first, and what was put aside."""

from dataclasses import replace

import pytest
from report import made_up_diagnoses as made_up

from exo_sim.diagnosis.findings import Finding, Kind, NextExperiment, Rejected, SignalFit, Unexplained
from exo_sim.diagnosis.result import Diagnosis, Verdict
from exo_sim.report import diagnosis_words


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
