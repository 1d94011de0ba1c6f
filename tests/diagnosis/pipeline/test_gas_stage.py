"""The stage of the gas: delays of slow loggers are found by whose card it is, and no search is run twice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import benches
import numpy as np
import pytest
from diagnosis import waves
from diagnosis.warm_vessel import recorded, vessel

from exo_sim.diagnosis.data.split import Split, split
from exo_sim.diagnosis.estimation.effort import Allowance
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.estimation.threads import SERIAL
from exo_sim.diagnosis.pipeline import gas_stage
from exo_sim.diagnosis.pipeline.gas_stage import Searched, examine_gas, felt_temperatures
from exo_sim.diagnosis.pipeline.plan import Plan
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.policy.budgets import LEAST_LATER
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.search import Search, WarmStart
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.nuisances import healthy_walls, nuisance_parameters
from exo_sim.recording import write_table
from exo_sim.trials.whole_machines.walk.case import make_worn_case, write_worn_case

#: A logger of 50 samples a second whose pressures come so late [s]; more than two sample periods, less than a quarter of a cycle.
LATE, PERIOD = 0.18, 0.02


def late_spring(folder: Path) -> Path:
    """Write closed chambers on a slowly led piston, both pressures of which come late, and noise that a sensor has."""
    rig = benches.bench(folder)
    cylinder = rig.cylinders["piston"]
    time = np.arange(3000) * PERIOD
    shown = np.maximum(time - LATE, 0.0)

    def position(at: np.ndarray) -> np.ndarray:
        return 0.05 * np.sin(2.0 * np.pi * 0.4 * at) * np.sin(0.21 * at)

    noise = np.random.default_rng(5).normal(0.0, 150.0, (2, len(time)))
    volume = {
        1: cylinder.dead_volume_1 + cylinder.area_1 * (position(shown) + 0.1),
        2: cylinder.dead_volume_2 + cylinder.area_2 * (0.1 - position(shown)),
    }
    columns = {f"piston.pressure_{side}": 4e5 * (v[0] / v) ** 1.4 + noise[side - 1] for side, v in volume.items()}
    columns |= {"piston.valve_command": np.zeros_like(time), "slide.position": position(time)}
    path = folder / "late.csv"
    write_table(path, benches.recording(time, columns))
    return path


@pytest.mark.slow
def test_pressures_of_a_slow_logger_are_late_as_one_and_a_search_is_run_once(tmp_path: Path) -> None:
    data = gather([late_spring(tmp_path)], tmp_path / "rig.toml", None)
    plan, searched = Plan(split([(table.name, table.time) for table in data.recordings])), Searched()
    after, (found,) = examine_gas(data, plan, SERIAL, lambda words: None, searched)
    assert not any("ended after the most predictions" in said for said in after.remarks)
    (finding,) = found.findings
    assert finding.name == "sensor_delay"
    assert [one.where for one in finding.at_each_place()] == ["piston.pressure_1", "piston.pressure_2"]
    assert finding.parameters["seconds"].value == pytest.approx(LATE, abs=0.1 * PERIOD)
    refuted_elsewhere = replace(plan, refuted={("viscous_friction", "slide"): "not there"})
    _, (again,) = examine_gas(data, refuted_elsewhere, SERIAL, lambda words: None, searched)
    assert again is found
    assert len(searched.results) == 1
    spent = searched.efforts["piston"]
    assert spent == found.model.effort.samples > 0 and not searched.stopped
    found.model.residual_of(found.model.nominal)  # what is asked of it when the search is over, is no search
    assert searched.efforts == {"piston": spent}


@pytest.mark.parametrize("conductance", [0.4, 0.0], ids=["walls that the rig knows", "walls that it does not know"])
@pytest.mark.parametrize(("warmth", "free"), [((25.0, 0.0), 2), ((0.0, -15.0), 2), ((0.0, 0.0), 0)])
def test_the_temperature_at_the_start_is_free_where_it_is_not_surely_the_room_s(
    warmth: tuple[float, float], free: int, conductance: float
) -> None:
    plant = vessel()
    plant.cylinder["wall_heat_transfer"]["conductance"] = conductance
    model = GasModel([recorded(warmth, travel=0.02)], plant, Split({}))
    nuisances = nuisance_parameters(plant, "piston", True, (1, 2))
    near = fit(model.residual, nuisances, {q: q.start for q in nuisances})
    assert len(felt_temperatures(model, near)) == free


def test_temperatures_beside_walls_that_a_first_fit_did_not_know_are_as_sure_as_from_scratch() -> None:
    plant = vessel()
    plant.cylinder["wall_heat_transfer"]["conductance"] = 0.0
    model = GasModel([recorded((0.0, 0.0), travel=0.02)], plant, Split({}))
    nuisances = nuisance_parameters(plant, "piston", True, (1, 2))
    near = fit(model.residual, nuisances, {q: q.start for q in nuisances})
    assert not set(healthy_walls(plant, "piston")) <= set(near.parameters)
    misled = replace(near, jacobian=np.zeros_like(near.jacobian))
    assert felt_temperatures(model, misled) == felt_temperatures(model, near) == ()


def test_gas_that_begins_quietly_is_not_fitted_for_it() -> None:
    model = GasModel([recorded((0.0, 0.0))], vessel(), Split({}))
    near = fit(model.residual, (), {})
    before = model.effort.samples
    assert felt_temperatures(model, near) == ()
    assert model.effort.samples == before


def test_searches_of_one_gas_share_what_they_may_predict_with_one_that_was_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where commands prove in the end to be samples, what was searched before that counts as well."""
    data, most, readings, asked = gather([late_spring(tmp_path)], tmp_path / "rig.toml", None), 10**9, list[GasModel](), list[int]()

    def read(model: GasModel, split: Split, *rest: object) -> GasModel:
        readings.append(model)
        return GasModel(model.all_runs, model.nominal, split, effort=model.effort) if len(readings) == 2 else model

    def search(model: GasModel, begun: WarmStart, *, allowed: Allowance, **rest: object) -> SimpleNamespace:
        asked.append(allowed.left)
        model.effort.add(most * 9 // 20)
        assert allowed.is_used_up() is (len(asked) > 2)
        end = SimpleNamespace(fit=SimpleNamespace(sse=0.0, values={}, columns={}), fixed=(), candidates=())
        return SimpleNamespace(
            name="piston", model=model, final=end, search=SimpleNamespace(final=end), has_unknown=False, is_empty=True
        )

    monkeypatch.setattr(gas_stage, "MOST_EFFORT", most)
    monkeypatch.setattr(gas_stage, "read_as_sampled", read)
    monkeypatch.setattr(gas_stage, "_searched", search)
    plan, searched = Plan(split([(table.name, table.time) for table in data.recordings])), Searched()

    def remarks(plan: Plan) -> bool:
        after, _ = examine_gas(data, plan, SERIAL, lambda words: None, searched)
        return any("ended after the most predictions" in said for said in after.remarks)

    assert not remarks(plan)
    assert asked == pytest.approx([most, 0.55 * most], rel=1e-3)
    assert searched.efforts["piston"] == pytest.approx(0.9 * most, rel=1e-3)
    assert remarks(replace(plan, refuted={("sensor_delay", "piston.pressure_1"): "not there"}))
    assert asked[2:] == [LEAST_LATER * most]
    assert not remarks(plan)  # the answer that was found first had not ended early


def test_a_search_in_another_division_of_the_time_begins_with_what_the_first_found() -> None:
    model, sought = waves.Waves(slow=4.0, quicker=3.0), (waves.BASE, waves.OTHER)
    search = Search(model, (), sought)
    first: SubsystemResult[Any] = decide("piston", model, search.fits, search.run())
    searched = Searched({("piston", "end", "asked", None): first})
    begun = searched.of_other_time("piston", "beginning", sought)
    assert begun is not None and begun.candidates == sought and begun.fit.values == first.search.final.fit.values
    less = searched.of_other_time("piston", "beginning", (waves.OTHER,))
    assert less is not None and less.candidates == (waves.OTHER,)  # what was refuted meanwhile is not asked
    assert searched.of_other_time("piston", "end", sought) is None
    standing = searched.standing("piston", "end", None, (waves.OTHER,))
    assert standing is not None and standing.candidates == (waves.OTHER,)  # the same time, one refuted: the other need not be found anew
    assert searched.standing("piston", "beginning", None, sought) is None
    assert searched.standing("piston", "end", "with friction", sought) is None
    assert searched.of_other_time("other", "beginning", sought) is None


def test_all_are_asked_together_once_unless_the_friction_of_a_piston_makes_a_transmission_give() -> None:
    model, sought = waves.Waves(slow=4.0, quicker=3.0), (waves.BASE, waves.OTHER)
    search = Search(model, (), sought)
    first: SubsystemResult[Any] = decide("piston", model, search.fits, search.run())
    found = first.search.final
    gives = replace(found, candidates=(waves.candidate("transmission_compliance", "base"),))
    key = ("piston", "end", "asked", None)

    def asked_by(results: Searched, friction: str | None, time: str = "end") -> tuple[bool, bool, bool]:
        begun = results.start_of("piston", time, friction, sought)
        assert begun.begun is None or begun.begun.candidates == sought
        return begun.begun is not None, begun.asks_together(found), begun.asks_together(gives)

    assert asked_by(Searched(), None) == (False, True, True)  # nothing before
    assert asked_by(Searched({key: first}), None) == (True, False, False)  # the same rows, one refuted
    assert asked_by(Searched({key: first}), None, "beginning") == (True, True, True)  # other rows
    assert asked_by(Searched({key: first}), "with friction") == (True, False, True)
    both = Searched({key: first, ("piston", "beginning", "asked", None): first})
    assert asked_by(both, "with friction", "beginning") == (True, False, True)  # rather with the same rows than with other ones
    assert asked_by(Searched({key: first}, {key}), "with friction") == (True, True, True)  # it ended early, perhaps before it asked
    interrupted = replace(first, search=replace(first.search, interrupted=True))
    assert asked_by(Searched({key: interrupted}), "with friction") == (True, True, True)


@pytest.mark.slow
def test_numbers_that_ended_where_they_stand_in_for_an_effect_begin_anew_where_effects_lead_them(tmp_path: Path) -> None:
    """A hip whose valve is late, lapped and leaks: alone they ended at a tenth of a dead volume, and every effect looked needless."""
    write_worn_case(make_worn_case("walk", "N", "whole", 5501, weigh=False), tmp_path)
    data = gather([tmp_path / "recording.csv"], tmp_path / "rig.toml")
    data = replace(data, cylinders={"hip_l": data.cylinders["hip_l"]})
    parts = split([(table.name, table.time) for table in data.recordings])
    _, (found,) = examine_gas(data, Plan(parts), SERIAL, lambda words: None)
    named = {finding.name for finding in found.findings}
    assert named == {"external_leakage", "valve_deadband", "valve_lag", "valve_null_leakage", "critical_ratio"} and not found.has_unknown
