"""An accumulator and the feed that refills it."""

from __future__ import annotations

from collections.abc import Mapping

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.effects import supply_regulator
from exo_sim.physics.identification import Applicability, Twins

#: Square of the speed of sound in the air of a room [m^2/s^2]: a tank follows its feed within volume / (conductance times this).
SOUND_SQUARED = 1.4 * 287.05 * 293.15


def _is_as_quick_as_a_regulator(tank: Mapping[str, float]) -> bool:
    """Return whether a regulator can be as slow as a tank of these numbers behind its feed."""
    slowest = supply_regulator.EFFECT.parameter("time_constant").high
    return tank.get("volume", 0.0) <= slowest * SOUND_SQUARED * tank.get("conductance", 0.0)


EFFECT = Effect(
    name="supply_droop",
    places=("supply",),
    family="supply",
    question="Does the supply fall with every stroke and recover at rest?",
    says="The supply pressure sags when gas is drawn.",
    parameters=(
        Parameter("volume", "m^3", 1e-6, 1.0, (1e-4, 1e-2), "accumulators of 0.1-10 l"),
        Parameter("conductance", "kg/(s Pa)", 0.0, 1e-3, (1e-9, 1e-6), "feed of 0.1-10 g/s at 1-10 bar of sag"),
    ),
    cut="gas",
    reveals=("supply.pressure", "pressure_1", "pressure_2"),
    mistaken_for=("supply_regulator", "critical_ratio", "valve_null_leakage"),
    experiment="record the supply pressure; work for ten seconds and wait for thirty",
    convention="one accumulator for all cylinders; its feed has a check valve.",
    valid=(
        "gas in the accumulator is mixed and takes no heat from its wall: right over seconds; over minutes the tank looks up to "
        "k times as large."
    ),
    signature="supply dips in phase with the strokes and recovers slowly",
    identification=Identification(
        starts=((2e-3, 1e-7), (5e-4, 2e-8)),
        # a tank that takes heat from its walls looks larger, up to k times, and is fed warmer
        open_by={"volume": (1.0 / 1.4, 1.0), "conductance": (0.97, 1.025)},
        logarithmic=True,
        applicability=Applicability(commanded=True),
        # a tank behind a feed is the same first order between flow and pressure; that its gas cools while it is drawn is less than what
        # is known of the flow
        twins=Twins(unmeasured=("supply_regulator",), measured=("supply_regulator",), believed=_is_as_quick_as_a_regulator),
    ),
)


@kernel
def present(p) -> bool:
    """Return whether the supply has a volume of its own."""
    return p.volume > 0.0


@kernel
def feed(p, p_source: float, p_supply: float) -> float:
    """Return the mass flow from the source into the accumulator [kg/s]; a check valve lets none back."""
    return p.conductance * max(p_source - p_supply, 0.0)
