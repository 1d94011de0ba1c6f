"""Cases with their truth open, for those who build a diagnosis.

python -m exo_sim.trials.develop --out cases --effects all --draws 1
"""

from __future__ import annotations

import argparse
from pathlib import Path

from exo_sim.errors import ExoSimError
from exo_sim.trials.cases import Case, make_case, write_case
from exo_sim.trials.conditions import ALL_KNOWN, Conditions, LegConditions
from exo_sim.trials.hidden_effects import CALIBRATIONS, EFFECTS, LISTED, OUTSIDE, SENSORS
from exo_sim.trials.leg_cases import FORCE, GAS, LegCase, make_leg_case
from exo_sim.trials.truth.excitation import PROGRAMS

GROUPS = {
    "all": tuple(EFFECTS),
    "listed": LISTED,
    "outside": OUTSIDE,
    "sensor": SENSORS,
    "calibration": CALIBRATIONS,
    "none": ("",),
    "gas": GAS,
    "force": FORCE,
}


def main(argv: list[str] | None = None) -> int:
    """Write cases; see `--help`."""
    parser = argparse.ArgumentParser(prog="python -m exo_sim.trials.develop", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument(
        "--effects", default="all", help="all, listed, outside, sensor, calibration, none, or keys: a,b,c+d"
    )
    parser.add_argument("--draws", type=int, default=1)
    parser.add_argument("--size", default="1", help="1 is clearly visible; 10x means ten times the detection limit")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--program", default="mixed", choices=PROGRAMS)
    parser.add_argument("--known", default="draw", choices=("draw", "none", "all"))
    parser.add_argument("--recordings", type=int, default=1)
    parser.add_argument("--duration", type=float, default=24.0)
    parser.add_argument("--jitter", type=float, default=0.0)
    parser.add_argument("--oddities", action="store_true")
    parser.add_argument("--no-supply", action="store_true")
    parser.add_argument(
        "--leg", action="store_true", help="a walking leg instead of the bench; --effects gas, force or keys"
    )
    parser.add_argument("--format", default="csv", choices=("csv", "parquet"))
    options = parser.parse_args(argv)
    known = {"draw": None, "none": (), "all": ALL_KNOWN}[options.known]
    conditions = Conditions(
        known=known, program=options.program, recordings=options.recordings, duration=options.duration, jitter=options.jitter,
        oddities=options.oddities, supply_recorded=not options.no_supply,
    )  # fmt: skip
    chosen = [key for name in options.effects.split(",") for key in GROUPS.get(name, (name,))]
    try:
        for j, entry in enumerate(chosen):
            keys = [key for key in entry.split("+") if key]
            for draw in range(options.draws):
                seed = options.seed + 1000 * draw + 7 * j
                label = entry.replace(":", "-") or "nothing"
                size: float | list[float]
                if options.size.endswith("x"):
                    from exo_sim.trials.detection_limit import sized

                    size = sized(keys, float(options.size[:-1]))
                else:
                    size = float(options.size)
                case: Case | LegCase
                if options.leg:
                    case = make_leg_case(f"{label}_{draw}", keys, seed, size, LegConditions(known=known, duration=options.duration))
                else:
                    case = make_case(f"{label}_{draw}", keys, seed, size, conditions)
                write_case(case, options.out / case.name, options.format, open_truth=True)
                print(options.out / case.name)
    except ExoSimError as error:
        parser.exit(2, f"{error}\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
