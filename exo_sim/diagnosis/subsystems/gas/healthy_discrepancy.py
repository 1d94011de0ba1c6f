"""What healthy machines show of a gas beside the numbers that are fitted: errors of the rig's own laws, other forms of them, slow losses.

An owner who says that his valve lags and his hose throttles gives numbers of laws that his machine follows in a form of its own: a spool
on a spring closes more slowly than it opens, a hose is a line and not a volume. What such a law misses is in proportion to what the
effect does, and changes with the edge of the valve that acts and with the way it moves. So each effect of the rig gives some columns of a
discrepancy: what it does to the predictions, as it adds up while a chamber is filled or vented and the valve opens or closes. The laws
that every machine has in some form (its four edges, its subsonic flow, its walls) give one for each of their parameters, and so do leaks
and walls that no finding may be made of.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis, joined
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy import healthy
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs
from exo_sim.physics.declaration import Effect, declared

Array = NDArray[np.float64]

#: A valve opens or closes where its command does over this time [s]: longer than noise of a controller, shorter than a stroke.
TURN = 0.02


class PredictedGas(Protocol):
    """The gas of a cylinder: its rows, and what plants predict of it."""

    nominal: PlantParameters
    inputs: list[GasInputs]

    @property
    def size(self) -> int: ...

    def pressures(self, plant: PlantParameters) -> list[Array]: ...

    def as_rows(self, errors: Sequence[Array]) -> Array: ...

    def healthy_variants(self, plant: PlantParameters) -> tuple[PlantParameters, ...]: ...


def healthy_discrepancy(model: PredictedGas, plant: PlantParameters) -> DiscrepancyBasis:
    """Return what a healthy machine shows beside the numbers of a fit, as columns for the rows of a gas.

    Args:
        model: The gas.
        plant: Around which prediction.
    """
    here = model.pressures(plant)
    manners = [_manners(given) for given in model.inputs]
    parts: dict[str, list[Array]] = {}
    for effect in declared().values():
        if effect.cut == "gas" and model.nominal.is_on(effect):
            changes = [there - pressure for there, pressure in zip(model.pressures(_without(plant, effect)), here, strict=True)]
            parts[effect.name] = _by_manner(model, changes, manners)
    forms: dict[str, list[Array]] = {}
    for name, other in (*_other_laws(plant), *(("losses", lossy) for lossy in model.healthy_variants(plant))):
        change = model.as_rows([there - pressure for there, pressure in zip(model.pressures(other), here, strict=True)])
        forms.setdefault(name, []).append(change)
    shares = [(parts, float(healthy.LAW_ERROR)), (forms, 1.0)]
    kinds = [(name, [c for c in columns if c.any()], share) for of_some, share in shares for name, columns in of_some.items()]
    return joined([(name, np.stack(columns, axis=1), share) for name, columns, share in kinds if columns], model.size)


def _by_manner(model: PredictedGas, changes: Sequence[Array], manners: Sequence[NDArray[np.bool_]]) -> list[Array]:
    """Return rows of what changes of the predicted pressures add up to in each chamber and manner."""
    found = []
    for side in range(2):
        for manner in range(manners[0].shape[2]):
            parts = []
            for given, change, of_run in zip(model.inputs, changes, manners, strict=True):
                part = np.zeros_like(change)
                part[:, side] = _added_up(change[:, side], of_run[:, side, manner], given.windows.starts)
                parts.append(part)
            found.append(model.as_rows(parts))
    return found


def _other_laws(plant: PlantParameters) -> Iterator[tuple[str, PlantParameters]]:
    """Yield plants whose laws are of another form, by one standard deviation of what is known of each of its parameters."""
    contained = plant.contained_effects
    for effect in declared().values():
        declares = effect.identification
        if effect.cut != "gas" or effect.name in contained or not (declares.is_law or declares.every_law):
            continue
        if plant.is_on(effect) != declares.every_law:  # a law of every machine bends what is there, another one says what nobody said
            continue
        open_ = {name: known for name, known in declares.known.items() if float(plant.cylinder[effect.name][name][0]) == 0.0}
        for name in open_:
            other = plant.copy()
            for each, (mean, spread) in open_.items():
                other.cylinder[effect.name][each] = mean + (spread if each == name else 0.0)
            yield effect.name, other


def _manners(given: GasInputs) -> NDArray[np.bool_]:
    """Return where a chamber is filled or vented while its path opens or closes, shape (n, 2, 4)."""
    back = max(1, int(round(TURN / given.period)))
    found = np.zeros((len(given.time), 2, 4), dtype=bool)
    for side in range(2):
        command = given.run.towards(side)
        before = np.concatenate([np.full(min(back, len(command)), command[0]), command[:-back]])
        fills, opens = command >= 0.0, np.abs(command) >= np.abs(before)
        for manner, holds in enumerate((fills & opens, fills & ~opens, ~fills & opens, ~fills & ~opens)):
            found[:, side, manner] = holds
    return found


def _added_up(change: Array, holds: NDArray[np.bool_], starts: NDArray[np.int64]) -> Array:
    """Return what a change of the predicted pressure adds up to within each window while something holds, shape (n,) [Pa]."""
    grows = np.diff(change, prepend=0.0)
    grows[starts] = change[starts]
    total = np.cumsum(np.where(holds, grows, 0.0))
    before = np.concatenate([[0.0], total])[starts]
    return np.asarray(total - np.repeat(before, np.diff(np.append(starts, len(change)))))


def _without(plant: PlantParameters, effect: Effect) -> PlantParameters:
    other = plant.copy()
    for record in (other.world, other.cylinder):
        if effect.name in (record.dtype.names or ()):
            record[effect.name] = np.zeros(1, record.dtype[effect.name])
    return other
