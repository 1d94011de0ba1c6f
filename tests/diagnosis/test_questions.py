"""Which questions may be asked: what comes on top of another waits for it; what every machine at rest shows is believed."""

from __future__ import annotations

from dataclasses import replace

import cylinder_runs
import numpy as np
import pytest

from exo_sim.diagnosis import library
from exo_sim.diagnosis.fitting import Fit
from exo_sim.diagnosis.judging import judge
from exo_sim.diagnosis.quantity import Candidate, Quantity, Setting
from exo_sim.diagnosis.search import Search, Trial
from exo_sim.diagnosis.threads import Threads
from exo_sim.physics.records import CYLINDER, WORLD

AT = np.arange(400.0)


def candidate(effect: str, *waves: str, beside: str = "") -> Candidate:
    quantities = tuple(Quantity(effect, "piston", wave, "1", "cylinder", 1.0, -10.0, 10.0) for wave in waves)
    return Candidate(effect, "piston", "+".join(waves), quantities, ((1.0,) * len(waves),), beside=beside)


SHAPES = {"slow": np.sin(AT / 30.0), "quick": np.sin(AT / 11.0), "quicker": np.cos(AT / 5.0)}
BASE, ON_TOP, OTHER = candidate("base", "slow"), candidate("on_top", "quick", beside="base"), candidate("other", "quicker")


class Waves:
    """Noise and waves, of which each candidate has one or two."""

    sick = 1e9

    def __init__(self, **sizes: float):
        self.blocks = (AT // 40).astype(np.int64)
        self._error = np.random.default_rng(8).standard_normal(AT.size) - sum(size * SHAPES[name] for name, size in sizes.items())

    @property
    def size(self) -> int:
        return AT.size

    def residual(self, values: dict[Quantity, float], fixed: object = ()) -> np.ndarray:
        return self._error + sum((value * SHAPES[q.parameter] for q, value in values.items()), np.zeros(AT.size))


def trial(*chosen: Candidate) -> Trial:
    return Trial(chosen, Fit((), {}, np.zeros(0), np.zeros((0, 0))))


def search(problem: Waves, cheap: bool, library: tuple[Candidate, ...] = (BASE, ON_TOP, OTHER)) -> Search:
    return Search(problem, (), library, cheap=cheap)


def test_only_what_stands_on_its_own_or_on_what_is_there_is_borne() -> None:
    assert trial().bears(BASE) and trial().bears(OTHER)
    assert not trial().bears(ON_TOP)
    assert not trial(OTHER).bears(ON_TOP)
    assert trial(BASE).bears(ON_TOP) and trial(OTHER, BASE).bears(ON_TOP)


def test_a_screen_leaves_out_what_is_not_borne() -> None:
    one = search(Waves(quick=5.0), cheap=False)
    assert {found.effect for _, found in one.screen(one.sets.try_set(()))} == {"base", "other"}
    ranked = one.screen(one.sets.try_set((BASE,)))
    assert [found.effect for _, found in ranked] == ["on_top", "other"]
    assert ranked[0][0] > 100.0 * max(ranked[1][0], 1.0)


@pytest.mark.parametrize("cheap", [False, True])
def test_both_are_found_where_both_are_there(cheap: bool) -> None:
    found = search(Waves(slow=3.0, quick=2.0), cheap).run().end
    assert {c.effect for c in found.chosen} == {"base", "on_top"}
    for c, size in ((BASE, 3.0), (ON_TOP, 2.0)):
        assert found.fit.values[c.quantities[0]] == pytest.approx(size, abs=0.3)


@pytest.mark.parametrize("cheap", [False, True])
def test_what_comes_on_top_is_never_named_alone(cheap: bool) -> None:
    found = search(Waves(quick=5.0), cheap).run().end
    assert all(found.bears(c) for c in found.chosen)


def test_a_fuller_question_is_not_put_plainer_by_what_is_not_borne() -> None:
    fuller = candidate("other", "quick", "quicker")
    found = search(Waves(quick=5.0), True, (BASE, ON_TOP, fuller)).run().end
    assert [c.effect for c in found.chosen] == ["other"]
    assert found.fit.values[fuller.quantities[0]] == pytest.approx(5.0, abs=0.3)


def test_pruning_keeps_what_another_stands_on() -> None:
    one = search(Waves(quick=5.0), cheap=False)
    one._whole = one.sets.try_set(())
    kept = one._pruned(one.sets.try_set((BASE, ON_TOP)))
    assert {c.effect for c in kept.chosen} == {"base", "on_top"}
    assert one._pruned(one.sets.try_set((BASE, OTHER))).chosen == ()


def setting(conductance: float = 0.0) -> Setting:
    cylinder = np.zeros(1, CYLINDER)
    cylinder["wall_heat_transfer"]["conductance"] = conductance
    return Setting(np.zeros(1, WORLD), cylinder)


def believed(one: Setting, rests: bool, commanded: bool = False) -> dict[tuple[str, str], Quantity]:
    return {(q.effect, q.parameter): q for q in library.believed(one, "piston", commanded, (1, 2), rests)}


HEAT = ("wall_heat_transfer", "conductance")


@pytest.mark.parametrize("commanded", [False, True])
def test_gas_at_rest_may_warm_at_its_walls(commanded: bool) -> None:
    heat = believed(setting(), rests=True, commanded=commanded)[HEAT]
    assert heat.low == 0.0 < heat.high and heat.prior is not None and heat.prior[0] == heat.neutral == 0.0
    one = setting()
    heat.put(one, 1.5)
    assert one.cylinder["wall_heat_transfer"]["conductance"][0] == 1.5


def test_gas_that_works_has_no_such_excuse() -> None:
    assert HEAT not in believed(setting(), rests=False)


def test_walls_that_the_rig_knows_are_not_asked_twice() -> None:
    assert HEAT not in believed(setting(0.7), rests=True)
    assert HEAT in {(q.effect, q.parameter) for q in library.known_effects(setting(0.7), "piston")}


def test_nothing_is_believed_of_a_valve_that_nobody_commanded() -> None:
    names = {effect for effect, _ in believed(setting(), rests=True)}
    assert names == {"dead_volume", "sensor_zero", "wall_heat_transfer"}
    assert {"flow_capacity", "valve_offset", "valve_deadband", "valve_lag"} <= {
        effect for effect, _ in believed(setting(), rests=False, commanded=True)
    }


@pytest.mark.parametrize("cheap", [False, True])
@pytest.mark.parametrize("share", [0.95, 0.8])
def test_a_base_that_became_needless_is_not_left_out_alone(monkeypatch: pytest.MonkeyPatch, cheap: bool, share: float) -> None:
    mixed = share * SHAPES["quick"] + np.sqrt(1.0 - share**2) * np.sin(AT / 3.0)
    monkeypatch.setitem(SHAPES, "slow", mixed)
    found = search(Waves(quick=5.0), cheap).run().end
    assert all(found.bears(c) for c in found.chosen)


def test_a_set_asked_twice_is_fitted_for_the_first_who_asks() -> None:
    one = search(Waves(slow=3.0, quick=2.0), cheap=False)
    begun = one.sets.try_set(())
    first, other, again = one.sets.try_sets([((BASE, OTHER), begun), ((BASE,), begun), ((OTHER, BASE), begun)])
    assert first is again and first.chosen == (BASE, OTHER)
    assert other.chosen == (BASE,)


def test_threads_change_nothing() -> None:
    library, ends = (BASE, ON_TOP, OTHER), []
    for count in (1, 3):
        with Threads(count) as threads:
            ends.append(Search(Waves(slow=3.0, quick=2.0), (), library, threads).run().end)
    assert ends[0].keys == ends[1].keys
    assert list(ends[0].fit.values.values()) == list(ends[1].fit.values.values())


@pytest.mark.parametrize(("sick", "names"), [(1e9, 3), (1e-3, 2)], ids=["a machine's own", "another machine's"])
def test_names_are_sought_on_beside_a_hopeless_error_only_while_each_halves_it(sick: float, names: int) -> None:
    problem = Waves(slow=5.0, quick=4.0, quicker=3.0)
    problem.sick = sick
    found = search(problem, cheap=True, library=(BASE, OTHER, candidate("third", "quick"))).run()
    assert len(found.end.chosen) == names


@pytest.mark.parametrize(("sizes", "halted", "names"), [({"slow": 9.0, "quick": 4.0}, True, {"base"}), ({"slow": 9.0}, False, {"base"})])
def test_a_search_ends_where_it_is_asked_to_unless_everything_is_explained(sizes: dict[str, float], halted: bool, names: set[str]) -> None:
    library = (BASE, ON_TOP, OTHER)
    found = Search(Waves(**sizes), (), library, until=lambda one: any(c.effect == "base" for c in one.chosen)).run()
    assert found.halted is halted and {c.effect for c in found.end.chosen} == names


def test_what_a_halted_search_found_is_what_the_other_cuts_go_on_with() -> None:
    """However much it leaves unexplained: it is judged when everything has been sought."""
    problem = Waves(slow=9.0, quick=4.0)
    problem.sick = 1e-3
    one = Search(problem, (), (BASE, ON_TOP, OTHER), until=lambda trial: True)
    found = one.run()
    assert found.halted
    judged = judge("gas", "piston", one.sets.problem, one.sets, found, lambda trial: 1.0)  # type: ignore[arg-type]
    assert (judged.named, judged.trial, judged.nameless, judged.findings) == (found.end.chosen, found.end, False, [])


class Weight(Waves):
    """An error that is there all the time: a believed number far off, or something else that acts in one long spell."""

    def __init__(self, level: float, wave: float = 0.0):
        super().__init__(slow=wave)
        self._error = self._error - level

    def residual(self, values: dict[Quantity, float], fixed: object = ()) -> np.ndarray:
        return super().residual({q: v for q, v in values.items() if q is not MASS}, fixed) + 100.0 * (values.get(MASS, 1.0) - 1.0)


MASS = Quantity("mass", "piston", "mass", "1", "sensor", 0.02, 0.2, 5.0, (1.0, 0.05), neutral=1.0)


def test_a_believed_number_that_alone_explains_an_unchanging_error_is_not_held_back() -> None:
    one = Search(Weight(35.0), (MASS,), (BASE, OTHER), cheap=True).sets.try_set(())
    assert one.fit.values[MASS] == pytest.approx(1.35, abs=0.005)


def test_beside_something_else_it_is_held_back() -> None:
    """A wave of thirty cannot be the mass; the mass must not follow its mean."""
    one = Search(Weight(0.0, wave=30.0), (MASS,), (BASE, OTHER), cheap=True)
    alone = float(np.mean(one.sets.problem.residual({MASS: 1.0}))) / -100.0
    assert abs(one.sets.try_set(()).fit.values[MASS] - 1.0) < 0.7 * abs(alone)


def test_of_what_adds_up_to_one_thing_the_whole_is_fitted_beside_a_part() -> None:
    part, whole = (replace(candidate("lag", *waves), adds_up=True) for waves in (("slow",), ("slow", "quick")))
    found = search(Waves(slow=5.0), True, (part, whole, OTHER)).run()
    assert [c.form for c in found.end.chosen] == ["slow"]
    assert {q.parameter for q in found.whole[part.key].asked} == {"slow", "quick"}


def test_what_is_in_series_with_the_valve_is_not_sought_much_wider_than_it() -> None:
    setting = Setting(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    setting.cylinder["valve_area"], setting.cylinder["area_1"], setting.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    asked = library.candidates(setting, [run], "piston", "slide")
    areas = [q for c in asked if c.effect == "line_restriction" for q in c.quantities if q.parameter == "area"]
    assert areas and all(q.high == pytest.approx(library.WIDEST * 2e-6) for q in areas)
