"""Diagnoses made up for the tests of pages and summaries: every field filled, numbers chosen by hand."""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.findings import (
    Estimate,
    Finding,
    Kind,
    Located,
    NextExperiment,
    OpenQuestion,
    Rejected,
    Series,
    SignalFit,
    Unexplained,
)
from exo_sim.diagnosis.result import Diagnosis, Verdict

RIG = 'name = "bench"\nmodel = "bench.xml"\n\n[cylinders.piston.valve]\narea = "5 mm^2"\n'
LEAK = Finding(
    "piston_leakage", "piston", Kind.MISSING_PHYSICS, "Gas leaks past the piston.", {"area": Estimate(3e-8, "m^2", 2.9e-8, 3.1e-8)},
    57.0, 0.97, ("external_leakage",), {"piston_leakage": 0.8, "external_leakage": 0.2},
)  # fmt: skip
AREA = Finding(
    "flow_capacity", "piston", Kind.CALIBRATION, "The valve area is 2.0 % larger than nominal.",
    {"factor": Estimate(1.02, "1", 1.018, 1.022)},
    12.0, 0.0,
)  # fmt: skip
NAMELESS = Finding(
    "unknown", "piston", Kind.UNKNOWN, "Something without a name acts here.", {"size": Estimate(4.0, "N", 0.0, 8.0)}, 9.0, 0.6,
    depends_on=("slide.position",),
    curve={"acts": "force", "variable": "position", "unit": "N", "at": [0.0, 0.05, 0.1], "values": [0.0, 4.0, 1.0],
           "band": [0.5, 0.5, 0.5], "explains": 0.8},
)  # fmt: skip
LATE = Finding(
    "sensor_delay", "slide.position", Kind.SENSOR, "The channel is late.", {"seconds": Estimate(8e-3, "s", 7.8e-3, 8.2e-3)}, 30.0, 0.4
)


def series(recording: str = "monday", seconds: float = 6.0) -> tuple[Series, ...]:
    """Return a pressure that the rig misses by 9 kPa before and by its noise after."""
    time = np.arange(0.0, seconds, 0.005)
    recorded = 4e5 + 3e4 * np.sin(3.0 * time)
    recorded[100:104] = np.nan
    wobble = 250.0 * np.sin(97.0 * time)
    return (
        Series(recording, "piston.pressure_1", "Pa", time, recorded, recorded + 9e3 * np.sin(time), recorded + wobble, 250.0),
        Series(recording, "piston.force_balance", "N", time, 9.0 * np.cos(time), 8.0 * np.cos(time), 9.1 * np.cos(time), 0.5),
    )


def whole(**changes: object) -> Diagnosis:
    """Return a diagnosis with every field filled."""
    fields: dict = {
        "verdict": Verdict.MISMATCH,
        "recordings": ("monday",),
        "rig": "bench",
        "located": (
            Located("piston/chamber_1", "energy balance", 0.83, ((1.0, 1.5), (2.0, 2.25)),
                    "valve closed", 412.0, 250.0, "Pa",
                    "monday"),
        ),
        "effects": (LEAK, NAMELESS, LATE, AREA),
        "rejected": (Rejected("valve_offset", "piston", "it fits worse <than> the leak"),),
        "signals": {"piston.pressure_1": SignalFit("Pa", 9423.0, 279.0, 250.0)},
        "held_out": {"monday": ((4.2, 6.0),)},
        "unexplained": (Unexplained("piston/force balance", ("slide.position",), 0.02),),
        "next_experiment": NextExperiment("both explain it", "hold the valve closed", ("piston_leakage", "external_leakage")),
        "open_questions": (OpenQuestion("the joint's friction", ("coulomb_friction",), "the position was not recorded"),),
        "sensor_remarks": ("slide.position is missing in rows 100 to 103.",),
        "series": series(),
        "improved": RIG.replace('"5 mm^2"', '"5.1 mm^2"  # was "5 mm^2"'),
    }  # fmt: skip
    return Diagnosis(**(fields | changes))
