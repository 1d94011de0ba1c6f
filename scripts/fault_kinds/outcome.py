"""What a kind of fault came to."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field


@dataclass
class Outcome:
    """Counts and what was not kept.

    Attributes:
        kind: "kills", "disks", ...
        counts: How often each thing was tried.
        broken: Promises not kept, a sentence each.
        left_out: What could not be tried on this machine, and why.
        figures: Measured numbers, with their units.
    """

    kind: str
    counts: Counter[str] = field(default_factory=Counter)
    broken: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    figures: dict[str, str] = field(default_factory=dict)

    def count(self, what: str) -> None:
        """Count one that was tried."""
        self.counts[what] += 1

    def lines(self) -> list[str]:
        """Return it as text."""
        out = [f"{self.kind}: {sum(self.counts.values())} tried ({', '.join(f'{what} {n}' for what, n in sorted(self.counts.items()))})"]
        out += [f"  {name}: {value}" for name, value in self.figures.items()]
        out += [f"  not tried: {words}" for words in self.left_out]
        return out + [f"  BROKEN: {words}" for words in self.broken]
