"""A finding of a sensor as plain JSON types."""

from __future__ import annotations

import json

from exo_sim.recording.data_quality_finding import Finding


def test_it_is_plain_json() -> None:
    found = Finding("piston.pressure_1", "stuck", "it is stuck", ((3, 9),), ((0.2, 0.8),), severity="fault", use="set aside").as_dict()
    assert json.loads(json.dumps(found)) == found == {
        "column": "piston.pressure_1", "kind": "stuck", "says": "it is stuck", "rows": [[3, 9]], "times": [[0.2, 0.8]],
        "severity": "fault", "use": "set aside",
    }  # fmt: skip
