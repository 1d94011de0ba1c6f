"""What a measured supply can show: a tank that sags, a regulator that droops; and the one nuisance parameter, the set pressure."""

from __future__ import annotations

import itertools

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.policy import priors
from exo_sim.physics.declaration import Effect, declared


def nuisance_parameters(plant: PlantParameters) -> tuple[FreeParameter, ...]:
    """Return the set pressure's error."""
    spread = priors.SET_PRESSURE * float(plant.world["supply_pressure"][0])
    return (FreeParameter("supply_pressure", "supply", "supply_pressure", "Pa", Target.SENSOR, spread, -1e6, 1e6, (0.0, spread)),)


def candidates(plant: PlantParameters) -> tuple[Candidate, ...]:
    """Return every candidate of the supply that the rig does not have on already."""
    found = []
    shared = [effect for effect in declared().values() if effect.places == ("supply",) and not effect.identification.excluded]
    for effect, form in ((e, form) for e in shared for form in e.identification.forms or (tuple(p.name for p in e.parameters),)):
        if plant.is_on(effect):
            continue
        parameters = tuple(_free(effect, name) for name in form)
        starts = tuple(itertools.product(*([_between(effect, p, share) for share in (0.15, 0.5, 0.85)] for p in form)))
        found.append(Candidate(effect.name, "supply", "+".join(form), parameters, starts, proportional=False))
    return tuple(found)


def _between(effect: Effect, name: str, share: float) -> float:
    low, high = effect.parameter(name).typical
    return low * (high / low) ** share


def _free(effect: Effect, name: str) -> FreeParameter:
    parameter = effect.parameter(name)
    return FreeParameter(
        effect.name,
        "supply",
        name,
        parameter.unit,
        Target.WORLD,
        _between(effect, name, 0.5),
        parameter.low,
        parameter.high,
        nonsmooth=name == "hysteresis",
        logarithmic=effect.identification.logarithmic,
    )
