"""How a worn machine's simulation ends when it is interrupted, stopped, or cannot go on."""

import numpy as np
import pytest
from simulation.walked import simulate

from exo_sim import rig as rigs
from exo_sim.errors import Diverged, ModelError
from exo_sim.simulation import loop, record, worn
from exo_sim.simulation.walk import Request
from exo_sim.simulation.wearer_load import with_machine
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def exo(repository):
    return rigs.read(repository / "assets" / "exo_250_psi.toml")


@pytest.mark.parametrize("law", ["least_load", "inverse_dynamics"])
def test_an_interrupt_is_an_interrupt_while_rehearsing_and_while_running(exo, monkeypatch, law):
    """It must not teach the demand a walk that was cut short."""
    real = loop.run
    calls: list[int] = []

    def interrupted(first, count, *rest):
        if len(calls) == 5:
            raise KeyboardInterrupt
        calls.append(first)
        return real(first, count, *rest)

    monkeypatch.setattr(loop, "run", interrupted)
    with pytest.raises(KeyboardInterrupt):
        simulate(exo, Request("level_walk", law=law))
    assert len(calls) == 5


def test_a_walk_that_was_stopped_is_as_good_as_it_goes(exo):
    (walk,) = Simulation(exo, Request("level_walk", assist="vented")).pieces(stop=iter([False] * 4 + [True]).__next__)
    assert walk.interrupted
    assert len(walk.time) == 5 * worn._CHUNK
    table = record.recording(walk, "cut")
    assert len(table.time) == len(walk.time) and np.isfinite(with_machine(walk).moments).all()
    assert len(record.scene(walk).times) > 10


def test_a_machine_that_falls_is_said_so(exo):
    simulation = Simulation(exo, Request("level_walk", assist="vented"))
    simulation.straps.stiffness[:] = 0.0
    simulation.straps.damping[:] = 0.0
    with pytest.raises(Diverged, match=r"level_walk: the machine falls away from its wearer at \d.*try"):
        simulation.run()


def test_numbers_that_are_none_are_said_so(exo):
    simulation = Simulation(exo, Request("level_walk", assist="vented"))
    simulation.data.qvel[4] = np.nan
    with pytest.raises(Diverged, match=r"level_walk: .* s; try"):
        simulation.run()


def test_a_step_too_long_for_the_valves_is_refused(exo):
    with pytest.raises(ModelError, match=r"timestep = 0.01 s is too long for the valve of cylinder knee_l.*at most 0.009"):
        Simulation(exo, Request("level_walk", step=0.01))
    Simulation(exo, Request("level_walk", step=0.004, law="inverse_dynamics"))


def test_a_diverging_run_is_one_error_and_no_log_file(exo, monkeypatch, tmp_path, capfd):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(Diverged, match="MuJoCo warns of mjWARN_BADQACC"):
        simulate(exo, Request("level_walk", cycles=2, assist="vented", step=0.01))
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr().err == ""
