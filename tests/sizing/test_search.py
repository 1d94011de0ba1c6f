"""The search: a true front, the same one whoever scores, and nothing scored twice."""

import os
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from exo_sim.errors import OutputError, ScenarioError
from exo_sim.rig import EffectSetting
from exo_sim.sizing import evaluation, workers
from exo_sim.sizing.evaluation import OF_THE_MACHINE, Task
from exo_sim.sizing.recommendation import ENOUGH_MARGIN, WAYS_OUT, Walked, nothing_found, recommended
from exo_sim.sizing.screening import CONSTRAINTS
from exo_sim.sizing.search import _as_asked, search
from exo_sim.sizing.study import space_of
from exo_sim.sizing.workers import Workers

TRIALS = 60


@pytest.fixture(scope="module")
def outcome(task):
    with Workers(1) as crowd:
        return search(task, TRIALS, 5, crowd)


def _told(outcome):
    return [(one.design, one.score) for one in outcome.front]


def test_nothing_on_the_front_is_bettered(outcome):
    feasible = [one.score for one in outcome.trials if one.score.feasible]
    assert len(feasible) > TRIALS / 4 and len(outcome.front) > 3
    for one in outcome.front:
        mine = np.array([-one.score.objectives[0], *one.score.objectives[1:]])
        for other in feasible:
            theirs = np.array([-other.objectives[0], *other.objectives[1:]])
            assert not (np.all(theirs <= mine) and np.any(theirs < mine))


def test_a_catalogue_of_one_valve_is_a_range_that_its_own_first_design_fits():
    """A first design computes its valve's area, which differs from the catalogue's by rounding; the sampler refused it."""
    import optuna

    area = 2.0080835887127047e-05
    one = optuna.distributions.FloatDistribution(area, area, log=True)
    for value in (np.nextafter(area, 0.0), area, np.nextafter(area, 1.0)):
        study = optuna.create_study()
        study.enqueue_trial({"knee.valve": _as_asked(float(value), one)})
        assert study.ask({"knee.valve": one}).params == {"knee.valve": area}
    above = _as_asked(2.0, optuna.distributions.IntDistribution(0, 3))
    assert above == 2 and isinstance(above, int)


def test_screened_out_designs_are_not_simulated(outcome):
    out = [one.score for one in outcome.trials if max(one.score.violations) > 0 and not one.score.simulated]
    assert out and all(not score.feasible for score in out)


def test_chambers_keep_to_the_pressure_limit(outcome, space):
    simulated = [one.score for one in outcome.trials if one.score.simulated]
    assert any(score.peak > space.supply[1] and not score.feasible for score in simulated)
    assert all(one.score.peak <= space.supply[1] for one in outcome.front)


def test_the_recommended_design_keeps_torque_in_hand(outcome, loads, task):
    choice = recommended(outcome.front, (loads,), task)
    assert choice.confirmed.walk is not None
    assert f"reach {choice.confirmed.peak / 1e5:.1f} bar" in choice.why
    assert choice.found in outcome.front
    assert choice.found.score.margin >= ENOUGH_MARGIN and "margin" in choice.why


def test_same_seed_same_front_another_seed_another(task, outcome):
    with Workers(1) as crowd:
        assert _told(search(task, TRIALS, 5, crowd)) == _told(outcome)
        assert _told(search(task, TRIALS, 6, crowd)) != _told(outcome)


def test_two_processes_give_the_same_front(task, outcome):
    with Workers(2) as crowd:
        assert _told(search(task, TRIALS, 5, crowd)) == _told(outcome)


def test_killed_and_started_again_it_repeats_nothing(task, outcome, tmp_path, monkeypatch):
    journal = tmp_path / "search.journal"
    scored: list[object] = []
    whole = evaluation.Evaluator.score

    def counted(self, numbers, stop_at):
        if len(scored) == stop_at:
            raise KeyboardInterrupt
        scored.append(tuple(sorted(numbers.items())))
        return whole(self, numbers)

    monkeypatch.setattr(evaluation.Evaluator, "score", lambda self, numbers: counted(self, numbers, 47))
    with Workers(1) as crowd:
        half = search(task, TRIALS, 5, crowd, journal)
    assert half.interrupted and len(half.trials) == 47
    monkeypatch.setattr(evaluation.Evaluator, "score", lambda self, numbers: counted(self, numbers, 1000))
    with Workers(1) as crowd:
        rest = search(task, TRIALS, 5, crowd, journal)
        third = search(task, TRIALS, 5, crowd, journal)
    assert rest.new == TRIALS - 47 and third.new == 0
    assert len(scored) == len(set(scored)) == TRIALS
    assert _told(rest) == _told(outcome) == _told(third)


def test_a_line_half_written_at_the_kill_costs_one_design(task, outcome, tmp_path):
    journal = tmp_path / "search.journal"
    with Workers(1) as crowd:
        search(task, 5, 5, crowd, journal)
        journal.write_bytes(journal.read_bytes()[:-300])
        again = search(task, 5, 5, crowd, journal)
        assert again.new == 1 and [one.score for one in again.trials] == [one.score for one in outcome.trials[:5]]
        journal.write_text("shopping list", encoding="utf-8")
        with pytest.raises(OutputError, match="no journal"):
            search(task, 5, 5, crowd, journal)
        assert journal.read_text(encoding="utf-8") == "shopping list"


@pytest.mark.parametrize(
    "lines",
    [
        '{"op_code": "x"}',
        '{"op_code": 99, "worker_id": "a"}',
        '{"op_code": 0, "worker_id": "a", "study_name": "NAME", "directions": [1, 1, 1]}\n'
        '{"op_code": 4, "worker_id": "a", "study_id": 0, "state": 1, "values": [1, 1, 1], "value": null, "user_attrs": {}, '
        '"system_attrs": {}, "params": {}, "distributions": {}, "intermediate_values": {}}',
        '{"op_code": ' + "[" * 100_000,
    ],
)
def test_a_journal_that_something_else_wrote_is_one_line(task, tmp_path, lines):
    journal = tmp_path / "search.journal"
    with Workers(1) as crowd:
        search(task, 1, 5, crowd, journal)
        name = journal.read_text(encoding="utf-8").split('"study_name":"')[1].split('"')[0]
        written = lines.replace("NAME", name) + "\n"
        journal.write_text(written, encoding="utf-8")
        with pytest.raises(OutputError, match=r"no journal|another search"):
            search(task, 1, 5, crowd, journal)
        assert journal.read_text(encoding="utf-8").startswith(written)
        journal.unlink()
        os.mkfifo(journal)
        with pytest.raises(OutputError, match="no journal"):
            search(task, 1, 5, crowd, journal)


def test_a_journal_of_another_search_is_refused(task, tmp_path):
    with Workers(1) as crowd:
        search(task, 1, 5, crowd, tmp_path / "search.journal")
        with pytest.raises(OutputError, match="holds another search"):
            search(task, 1, 6, crowd, tmp_path / "search.journal")


def test_what_keeps_every_design_out_is_named(exo, condition):
    weak = Task(exo, (condition,), space_of(exo, 0.0, 4.2e5))
    starved = replace(weak, rig=replace(exo, effects=tuple(
        EffectSetting("coulomb_friction", name, {"force": 5000.0}) for name in exo.cylinders)))  # fmt: skip
    with Workers(1) as crowd:
        found = search(starved, 5, 0, crowd)
    assert not found.front
    error = nothing_found(found, starved)
    assert isinstance(error, ScenarioError) and "torque" in str(error) and "\n" not in str(error)
    assert "larger bores" in str(error)


def test_whatever_keeps_designs_out_there_is_a_way():
    assert WAYS_OUT.keys() == {*CONSTRAINTS, *OF_THE_MACHINE}


def test_a_design_that_was_walked_with_says_what_it_fails():
    kept = Walked(3, 2.0, 8e5, 11e5, "", "level_walk", 5.3)
    assert kept.fails == ""
    assert replace(kept, error=8.1).fails == "error beyond 5.3 N m rms"
    assert replace(kept, error=8.1, peak=12e5).fails == "error beyond 5.3 N m rms and pressure beyond 11.0 bar"
    assert replace(kept, error=np.inf, peak=np.inf, trouble="fell").fails == "fell"


def test_friction_asks_for_more(task, judge, outcome):
    """The same design has less margin with friction, and draws different gas with heat loss."""
    names = task.rig.cylinders
    rough = replace(task, rig=replace(task.rig, effects=tuple(
        EffectSetting("coulomb_friction", name, {"force": 120.0}) for name in names)))  # fmt: skip
    lossy = replace(task, rig=replace(task.rig, effects=tuple(
        EffectSetting("wall_heat_transfer", name, {"conductance": 3.0}) for name in names)))  # fmt: skip
    design = outcome.front[0].design
    plain = judge.judge(design)
    assert evaluation.Evaluator(rough).judge(design).margin < plain.margin - 0.02
    with_loss = evaluation.Evaluator(lossy).judge(design)
    assert with_loss.margin == plain.margin and with_loss.gas != plain.gas


@pytest.mark.slow
def test_a_dask_cluster_of_two_processes_gives_the_same_front(task, outcome):
    distributed = pytest.importorskip("distributed")
    make = partial(
        distributed.LocalCluster, n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None
    )
    with make() as cluster, Workers(scheduler=cluster.scheduler_address) as crowd:
        assert _told(search(task, TRIALS, 5, crowd)) == _told(outcome)


def test_what_is_no_address_is_one_line():
    pytest.importorskip("distributed")
    with pytest.raises(ScenarioError, match="tcp://HOST:PORT"):
        Workers(scheduler="nonsense")


def test_no_scheduler_there_is_one_line(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(workers, "_CONNECT", 1.0)
    with pytest.raises(ScenarioError, match="no Dask scheduler answers") as error:
        Workers(scheduler="tcp://127.0.0.1:9")
    assert "\n" not in str(error.value)
