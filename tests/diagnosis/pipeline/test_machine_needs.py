"""What balances call too small to matter is a finding all the same where the whole machine is predicted plainly worse without it."""

from __future__ import annotations

import pytest

from exo_sim.diagnosis.estimation.budget import Budget
from exo_sim.diagnosis.estimation.threads import SERIAL
from exo_sim.diagnosis.pipeline.machine_needs import is_needed, with_what_the_machine_needs
from exo_sim.diagnosis.pipeline.plan import Examination
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.pipeline.rounds import examine_until_stable, without_doubtful
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions

FRICTION = "coulomb_friction"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Examination:
    folder = tmp_path_factory.mktemp("needs")
    write_case(make_case("a", (FRICTION,), 11, 0.5, Conditions(duration=10.0, known=())), folder, "parquet")
    data = gather([folder / "recording.parquet"], folder / "rig.toml")
    return without_doubtful(examine_until_stable(data, SERIAL, lambda words: None, Budget(1e9)))


def called_small(whole: Examination) -> Examination:
    (finding,) = (f for one in whole.results.all for f in one.findings if f.name == FRICTION)
    return whole.holding_small((finding,))


def names(examination: Examination) -> set[str]:
    return {f.name for one in examination.results.all for f in one.findings}


def test_friction_without_which_the_machine_is_missed_stands_again(whole: Examination) -> None:
    found = called_small(whole)
    assert FRICTION not in names(found)
    kept = with_what_the_machine_needs(whole, found)
    assert FRICTION in names(kept) and kept.small == ()
    assert is_needed(found, kept)


def test_what_changes_no_prediction_stays_small(whole: Examination) -> None:
    found = called_small(whole)
    assert not is_needed(found, found)
    assert not is_needed(whole, found)  # the machine is worse with what the others would be then


def test_when_the_time_is_up_nothing_is_run(whole: Examination) -> None:
    found = called_small(whole)
    assert with_what_the_machine_needs(whole, found, is_spent=lambda: True) is found
