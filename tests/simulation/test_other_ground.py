"""Short walks up and down slopes and stairs, slow and fast, with an uneven load: weight, ledger, and what is refused."""

import dataclasses

import pytest
from simulation.walked import simulate

from exo_sim import rig as rigs
from exo_sim.control.valve_control import ValveGains
from exo_sim.errors import ModelError, ScenarioError
from exo_sim.gait import scenario
from exo_sim.rig import EffectSetting
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def exo(repository):
    return rigs.read(repository / "assets" / "exo_250_psi.toml")


@pytest.mark.parametrize("name", ["slope_up", "slope_down", "stairs_up", "stairs_down", "slow_walk", "fast_walk", "uneven_load"])
def test_it_walks_and_its_books_balance(exo, name):
    walk = simulate(exo, Request(name, 20.0, cycles=4))
    numbers = summarise(walk)
    carried = numbers["mean_ground_force_n"] + numbers["strap_load_n"]["vertical_mean"]
    assert carried == pytest.approx(numbers["supported_weight_n"], rel=0.03)
    assert abs(numbers["ledger"]["closure"]) < 1.0
    cost = numbers["compared_with"]
    assert cost["backpack"]["metabolic_w"] > cost["no_machine"]["metabolic_w"]
    climbed = walk.columns["torso_z.position"][-1] - walk.columns["torso_z.position"][0]
    assert climbed == pytest.approx(4 * walk.motion.climb, abs=0.08)


@pytest.mark.parametrize("name", ["slow_walk", "fast_walk", "slope_down", "start_and_stop"])
def test_the_machine_takes_off_its_wearer_what_a_backpack_costs(exo, name):
    numbers = summarise(simulate(exo, Request(name, 34.0, cycles=3 if name == "start_and_stop" else 6)))
    assert numbers["wearer"]["metabolic_w"]["value"] < numbers["compared_with"]["backpack"]["metabolic_w"]
    assert abs(numbers["wearer"]["forward_push_n"]) < 30.0


def test_what_is_lifted_is_in_the_ledger(exo):
    walk = simulate(exo, Request("slope_up", 20.0, cycles=4))
    height = walk.motion.climb
    lifted = (walk.weight.mean() / 9.81 + walk.person.mass) * 9.81 * height
    assert summarise(walk)["ledger"]["stored"] == pytest.approx(lifted, rel=0.02)


def test_mass_hung_on_a_body_weighs(exo):
    plain, hung = (Simulation(exo, Request(name, 20.0, cycles=1, law="inverse_dynamics")) for name in ("level_walk", "uneven_load"))
    more = hung.model.body_mass - plain.model.body_mass
    assert more[hung.model.body("thigh_l").id] == pytest.approx(3.0) and more.sum() == pytest.approx(3.0)
    given = dataclasses.replace(scenario.find("level_walk"), hung={"thig_l": 3.0})
    with pytest.raises(ModelError, match=r'hung\.thig_l is not a body with mass.*did you mean "thigh_l"'):
        Simulation(exo, Request("mine", 20.0, given=given))


def test_a_wearer_who_is_a_body_refuses_slopes(exo):
    with pytest.raises(ScenarioError, match="level ground only"):
        Simulation(exo, Request("slope_up", 20.0, law="inverse_dynamics", wearer="torques"))


def test_a_law_with_gauges_follows_less_well_and_pi_can_be_tuned(exo):
    """Gauges' noise and a valve's lag cost the model-based law something; PI with gains of its own is no longer far from it."""

    def error(controller, signals, rig=exo, **settings):
        asked = Request("level_walk", 34.0, cycles=3, law="inverse_dynamics", controller=controller, signals=signals, **settings)
        return summarise(simulate(rig, asked))["joints"]["hip_r"]["torque_error_rms_nm"]

    lag = [EffectSetting("valve_lag", name, {"time_constant": 3e-3, "delay": 2e-3}) for name in exo.cylinders]
    lagging = dataclasses.replace(exo, effects=(*exo.effects, *lag))
    exact, measured, late = error("model", "exact"), error("model", "measured"), error("model", "measured", lagging)
    assert exact < measured < late
    fast = {name: ValveGains(proportional=75.0, integral=900.0) for name in exo.cylinders if name.startswith("hip")}
    assert error("pi", "measured", tuned=fast) < 0.5 * error("pi", "measured")
    assert error("model", "measured") == measured  # the same noise every time
