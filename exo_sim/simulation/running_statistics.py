"""Numbers over time that can be taken piece by piece: each knows how two pieces make one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Mean:
    """The mean of `count` values that sum to `total`."""

    total: float
    count: int

    @classmethod
    def of(cls, values: ArrayLike) -> Self:
        return cls(float(np.sum(values)), np.size(values))

    def joined(self, later: Self) -> Self:
        return type(self)(self.total + later.total, self.count + later.count)

    def value(self) -> float:
        return self.total / self.count


class Rms(Mean):
    """The root of the mean of `count` squares that sum to `total`."""

    @classmethod
    def of(cls, values: ArrayLike) -> Self:
        return cls(float(np.sum(np.square(values))), np.size(values))

    def value(self) -> float:
        return math.sqrt(self.total / self.count)


@dataclass(frozen=True)
class Peak:
    """The largest value."""

    most: float

    @classmethod
    def of(cls, values: ArrayLike) -> Self:
        return cls(float(np.max(values)))

    def joined(self, later: Self) -> Self:
        return type(self)(max(self.most, later.most))

    def value(self) -> float:
        return self.most


@dataclass(frozen=True)
class Least:
    """The smallest value."""

    least: float

    @classmethod
    def of(cls, values: ArrayLike) -> Self:
        return cls(float(np.min(values)))

    def joined(self, later: Self) -> Self:
        return type(self)(min(self.least, later.least))

    def value(self) -> float:
        return self.least


@dataclass(frozen=True)
class Change:
    """By how much something that is counted up has changed, a cycle."""

    first: float
    last: float
    cycles: float

    def joined(self, later: Self) -> Self:
        return type(self)(self.first, later.last, self.cycles + later.cycles)

    def value(self) -> float:
        return (self.last - self.first) / self.cycles


def joined(earlier: Any, later: Any) -> Any:
    """Join two pieces of the same nested dictionaries of reductions; of what is no reduction, the later stands."""
    if isinstance(earlier, Mapping):
        return {key: joined(entry, later[key]) for key, entry in earlier.items()}
    if isinstance(earlier, list):
        return [joined(entry, other) for entry, other in zip(earlier, later)]
    return earlier.joined(later) if hasattr(earlier, "joined") else later


def values(reduced: Any) -> Any:
    """Return nested dictionaries with the number of each reduction in its place."""
    if isinstance(reduced, Mapping):
        return {key: values(entry) for key, entry in reduced.items()}
    if isinstance(reduced, list):
        return [values(entry) for entry in reduced]
    return reduced.value() if hasattr(reduced, "value") else reduced
