"""One thing that is odd about a recording, said plainly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

Severity = Literal["info", "warning", "fault"]
Use = Literal["used", "set aside", "repaired"]


@dataclass(frozen=True)
class Finding:
    """One thing that was found, and what was done about it.

    Attributes:
        column: `"piston.pressure_1"`, `"time"`, or the name as the file has it where it is none of ours.
        kind: One word or two for machines: `"clock"`, `"missing samples"`, `"stuck"`, `"clipped"`, `"gauge"`, ...
        says: One plain sentence that names column, row and time.
        rows: Half-open ranges of rows of the recording as handed out, the first `MOST_SPANS` of them; empty where the
            whole column is meant.
        times: Seconds, start and stop of the same spans.
        severity: "info" (good to know), "warning" (may spoil results), "fault" (the sensor or the file is wrong).
        use: "used" as it is, "set aside" (the column or the spans must not be used), "repaired" (by the reader).
    """

    column: str
    kind: str
    says: str
    rows: tuple[tuple[int, int], ...] = ()
    times: tuple[tuple[float, float], ...] = ()
    severity: Severity = "warning"
    use: Use = "used"

    def as_dict(self) -> dict[str, Any]:
        """Return the finding as plain JSON types."""
        return {
            "column": self.column,
            "kind": self.kind,
            "says": self.says,
            "rows": [list(span) for span in self.rows],
            "times": [list(span) for span in self.times],
            "severity": self.severity,
            "use": self.use,
        }


#: How many spans a finding lists; its sentence says how many there are.
MOST_SPANS = 100
