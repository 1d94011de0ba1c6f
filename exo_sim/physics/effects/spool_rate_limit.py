"""A spool that can only move so fast."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter

EFFECT = Effect(
    name="spool_rate_limit",
    places=("cylinder",),
    family="valve",
    question="Do large steps of the command take longer than small ones?",
    says="The valve's spool moves no faster than a limit.",
    parameters=(Parameter("rate", "1/s", 0.1, 1e5, (20.0, 500.0), "full travel in 2-50 ms"),),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("valve_lag",),
    experiment="lock the rod and step the command by a tenth and by the whole: the time grows with the step",
    convention="full travel from closed to open is 1.",
    valid="the limit is the same both ways and at every supply pressure.",
    signature="opening grows as a ramp after a large step; small signals are untouched",
    identification=Identification(jerky=True, starts=((600.0,), (200.0,), (60.0,), (20.0,), (8.0,), (4.0,), (2.0,))),
)


@kernel
def limited(p, spool: float, wanted: float, h: float) -> float:
    """Return the spool after `h` seconds on its way to `wanted`; rate 0 means no limit."""
    if p.rate <= 0.0:
        return wanted
    reach = p.rate * h
    return min(max(wanted, spool - reach), spool + reach)


@kernel
def limited_speed(p, speed: float) -> float:
    """Return the speed at which a spool goes on that would move at `speed`; rate 0 means no limit."""
    return speed if p.rate <= 0.0 else min(max(speed, -p.rate), p.rate)
