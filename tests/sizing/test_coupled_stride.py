"""The one coupled cycle of the search: no design leaves a trace, and the coarse step is accurate enough."""

from dataclasses import replace

import numpy as np
import pytest

from exo_sim.sizing.coupled_stride import CoupledStride
from exo_sim.sizing.design import fitted
from exo_sim.sizing.screening import chosen_bores

CHANGES: tuple[dict[str, float], ...] = (
    {}, {"supply": 9e5, "hip.valve": 2e-5, "knee.above": 1.0}, {"hip.turn": 0.15, "knee.to": 0.08, "knee.valve": 6e-6},
)  # fmt: skip


@pytest.fixture(scope="module")
def rigs_to_try(exo, space, loads):
    out = []
    for change in CHANGES:
        numbers = {**space.owners(exo), **change}
        out.append(fitted(exo, space.kinds, space.design(numbers, chosen_bores(exo, space, (loads,), numbers))))
    return out


def test_order_does_not_matter(exo, condition, rigs_to_try):
    bench = CoupledStride(exo, condition)
    first = [bench.run(rig) for rig in rigs_to_try]
    again = [bench.run(rig) for rig in reversed(rigs_to_try)]
    assert first == again[::-1]
    assert CoupledStride(exo, condition).run(rigs_to_try[1]) == first[1]


def test_half_the_step_and_two_more_cycles_change_little(exo, condition, rigs_to_try):
    """Gas within 4 %; error within 0.4 N m, where the torque's peak is 125."""
    coarse, fine = CoupledStride(exo, condition), CoupledStride(exo, condition, step=1e-3, lead=3.0)
    pairs = [(coarse.run(rig), fine.run(rig)) for rig in rigs_to_try]
    assert all(a.finished and b.finished for a, b in pairs)
    for a, b in pairs:
        assert a.gas == pytest.approx(b.gas, rel=0.04)
        assert a.error == pytest.approx(b.error, abs=0.4)
    assert np.argsort([a.gas for a, _ in pairs]).tolist() == np.argsort([b.gas for _, b in pairs]).tolist()


def test_less_pressure_less_gas_and_a_starved_valve_follows_worse(exo, condition, space, loads):
    bench = CoupledStride(exo, condition)

    def run(**change):
        numbers = {**space.owners(exo), **change}
        bores = chosen_bores(exo, space, (loads,), {**space.owners(exo)})
        return bench.run(fitted(exo, space.kinds, space.design(numbers, bores)))

    assert run(supply=9.5e5).gas < run(supply=1.1e6).gas
    starved = {"hip.valve": 2e-6, "knee.valve": 2e-6}
    assert run(**starved).error > 2 * run().error


@pytest.mark.parametrize("scenario", ["squat", "payload_step"])
def test_other_scenarios_go_through(exo, scenario, rigs_to_try):
    from exo_sim.sizing.loads import Condition

    stride = CoupledStride(exo, Condition(scenario, 20.0)).run(exo)
    assert stride.finished and stride.gas > 0.0


def test_independent_edges_follow_as_well_for_a_third_less_gas(exo, condition):
    """The same machine with an edge of its own for each chamber: planned pressures draw less and track as well."""
    edges = {name: replace(c, valve=replace(c.valve, independent=True)) for name, c in exo.cylinders.items()}
    four = CoupledStride(exo, condition).run(exo)
    machine = replace(exo, cylinders=edges)
    own = CoupledStride(machine, condition).run(machine)
    assert own.finished
    assert own.gas < 0.7 * four.gas
    assert own.error < 1.0
