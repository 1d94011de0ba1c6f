"""Errors on held-out time as records: of every signal and balance, and what each finding gains there."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from exo_sim.diagnosis.data.split import Spans
from exo_sim.diagnosis.findings import Series, SignalFit, Subsystem
from exo_sim.diagnosis.selection.held_out_gain import HeldOutGain

Key = TypeVar("Key")
Value = TypeVar("Value")


@dataclass(frozen=True)
class BalanceError:
    """The error of one balance on held-out time, in units of the noise.

    Attributes:
        error: Root mean square there.
        fitted: What the fit leaves on the training data.
        bound: Largest error of a healthy machine.
        log10_odds: That it is more than noise.
    """

    error: float
    fitted: float
    bound: float
    log10_odds: float

    @property
    def ratio(self) -> float:
        """The error in units of what the fit leaves, or of the noise where that is larger; 0 where it is not a number."""
        return finite(self.error / max(self.fitted, 1.0))

    def exceeds_bound(self, times: float = 1.0) -> bool:
        """Return whether the error is more than so many times that of any healthy machine."""
        return self.error > times * self.bound

    def newly_exceeds_bound(self, times: float = 1.0) -> bool:
        """Return whether it is, while that of the fit is within the bound."""
        return self.exceeds_bound(times) and self.fitted < self.bound


@dataclass(frozen=True)
class HeldOutErrors:
    """Errors on held-out time.

    Attributes:
        signals: By column, before and after.
        drops: By `effect@where` (by place for an unknown effect), the share by which the error falls with it.
        influence: By the keys of `drops`, how much predictions change with it [units of the noise].
        left: By the keys of `drops`, the error of the time that was fitted when all the rest is fitted without it [units of the noise].
        where_acting: By the keys of `drops`, the error without it where predictions change with it, in units of the most that noise by
            itself leaves there but for chance: each row's square is weighed by that of the change; where predictions of held-out time do
            not change with it by `LEAST_INFLUENCE`, of the time that was fitted.
        beyond_healthy: By the keys of `drops`, how much predictions of the time that was fitted change with it where they change, in units
            of what the laws of a healthy machine get wrong there; only where anybody knows that.
        costs: By the keys of `drops`, `influence` as a share of how much the predicted signals vary; 0 for a shared supply: it is measured.
        balances: By subsystem and name.
        series: For the report.
        spans: The held-out time, by recording.
        gains: By the keys of `drops`, what a finding gains; only where predictions change with it by `LEAST_INFLUENCE`.
        relief: By the keys of `drops`, by how much -2 log of the prior of all nuisance parameters is less with it.
    """

    signals: Mapping[str, SignalFit] = field(default_factory=dict)
    drops: Mapping[str, float] = field(default_factory=dict)
    influence: Mapping[str, float] = field(default_factory=dict)
    left: Mapping[str, float] = field(default_factory=dict)
    where_acting: Mapping[str, float] = field(default_factory=dict)
    beyond_healthy: Mapping[str, float] = field(default_factory=dict)
    costs: Mapping[str, float] = field(default_factory=dict)
    balances: Mapping[tuple[Subsystem, str], BalanceError] = field(default_factory=dict)
    series: tuple[Series, ...] = ()
    spans: Spans = field(default_factory=dict)
    gains: Mapping[str, HeldOutGain] = field(default_factory=dict)
    relief: Mapping[str, float] = field(default_factory=dict)

    @property
    def ratio(self) -> float:
        """The largest ratio of a balance; infinite where no signal could be compared."""
        return max((one.ratio for one in self.balances.values()), default=0.0) if self.signals else math.inf

    def lacks(self, times: float) -> bool:
        """Return whether a balance misses held-out time by more than any healthy machine, and by so many times what the fit leaves.

        Also where no signal could be compared.
        """
        return not self.signals or any(one.ratio > times and one.exceeds_bound() for one in self.balances.values())

    @property
    def tested(self) -> dict[str, HeldOutGain]:
        """What those findings gain that held-out time tests: without them more than the noise is missing there."""
        return {key: one for key, one in self.gains.items() if one.missing > 0.0}

    def updated(self, later: HeldOutErrors, gone: Collection[str]) -> HeldOutErrors:
        """Return these errors with those of a later look at some subsystems in the place of theirs.

        Args:
            later: The later ones.
            gone: Keys of `drops` that are no findings any more.
        """

        def both(mine: Mapping[Key, Value], theirs: Mapping[Key, Value]) -> dict[Key, Value]:
            return {key: value for key, value in {**mine, **theirs}.items() if key not in gone}

        seen = {(one.recording, one.signal): one for one in later.series}
        return replace(
            self,
            signals={**self.signals, **later.signals},
            drops=both(self.drops, later.drops), influence=both(self.influence, later.influence), costs=both(self.costs, later.costs),
            left=both(self.left, later.left), where_acting=both(self.where_acting, later.where_acting),
            beyond_healthy=both(self.beyond_healthy, later.beyond_healthy), relief=both(self.relief, later.relief),
            gains={key: one for key, one in both(self.gains, later.gains).items() if key in later.gains or key not in later.drops},
            balances={**self.balances, **later.balances},
            series=tuple(seen.get((one.recording, one.signal), one) for one in self.series),
        )  # fmt: skip


def finite(value: float) -> float:
    """Return the value, or 0 where it is not a number."""
    return float(value) if np.isfinite(value) else 0.0
