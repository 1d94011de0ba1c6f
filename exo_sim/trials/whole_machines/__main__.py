"""Whole machines with their truth open, for those who build a diagnosis.

python -m exo_sim.trials.whole_machines make  --out CASES [--make A,B] [--cell whole] [--draws 4] [--seed 1] [--jobs 2]
python -m exo_sim.trials.whole_machines run   CASES --out ANSWERS [--jobs 2] [--only "A_*"]
python -m exo_sim.trials.whole_machines score CASES --out ANSWERS [--matters 2]
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from exo_sim.errors import ExoSimError, TrialError
from exo_sim.trials.whole_machines import diagnose_cases
from exo_sim.trials.whole_machines.draw import CELLS, cells_of
from exo_sim.trials.whole_machines.judge import MATTERS, Mark
from exo_sim.trials.whole_machines.makes import MAKES, find, letters


def main(argv: list[str] | None = None) -> int:
    """Make, diagnose or score; see `--help`."""
    parser = argparse.ArgumentParser(
        prog="python -m exo_sim.trials.whole_machines", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    verbs = parser.add_subparsers(dest="verb", required=True)
    make = verbs.add_parser("make", help="write cases: CASE/rig.toml, bench.xml, recording.csv, and what is true in CASE/truth")
    make.add_argument("--out", type=Path, required=True)
    make.add_argument(
        "--make", default="A,B,C,D",
        help=f"letters, X0-X9 (drawn by number), or learn, report, all; there is: {', '.join(MAKES)}  [default: A,B,C,D]",
    )  # fmt: skip
    make.add_argument("--cell", default="whole", help=f"of {', '.join(CELLS)}, several with commas, or all  [default: whole]")
    make.add_argument(
        "--effects", default="", help="hide these blocks instead of a draw, such as stribeck+viscous; several sets with commas"
    )
    make.add_argument("--draws", type=int, default=1, help="of each make, cell and set")
    make.add_argument("--seed", type=int, default=1)
    make.add_argument("--bulk", type=float, default=1.0, help="factor on the sizes of all effects; 1: as on real machines")
    make.add_argument("--duration", type=float, default=20.0, help="seconds")
    make.add_argument("--recordings", type=int, default=1)
    make.add_argument("--unweighed", action="store_true", help="do not compute what each effect matters: all are expected, quicker")
    make.add_argument("--jobs", type=int, default=1)
    run = verbs.add_parser("run", help="diagnose what has no answer yet, and hold the rigs against fresh recordings")
    score = verbs.add_parser("score", help="count, and write ANSWERS/marks.json")
    for one in (run, score):
        one.add_argument("folder", type=Path)
        one.add_argument("--out", type=Path, required=True)
    run.add_argument("--tool", default=diagnose_cases.DIAGNOSE, help="recordings, --rig and --out are appended")
    run.add_argument("--compare", default=diagnose_cases.COMPARE, help="recording, --rig, --out and --json are appended")
    run.add_argument("--jobs", type=int, default=1)
    run.add_argument("--timeout", type=float, default=900.0)
    run.add_argument("--only", default="*", help="pattern of names of cases")
    run.add_argument("--unproved", action="store_true", help="do not hold rigs against the fresh recordings")
    score.add_argument("--matters", type=float, default=MATTERS, help="multiples of what can be seen from which a name is expected")
    score.add_argument("--cases", action="store_true", help="a line for each case as well")
    score.add_argument("--json", action="store_true", help="the figures as JSON")
    options = parser.parse_args(argv)
    try:
        if options.verb == "make":
            _make(options)
        elif options.verb == "run":
            diagnose_cases.run(
                options.folder,
                options.out,
                options.tool,
                options.compare,
                options.jobs,
                options.timeout,
                not options.unproved,
                options.only,
            )
        else:
            _score(options)
    except ExoSimError as error:
        parser.exit(2, f"{error}\n")
    return 0


def _make(options: argparse.Namespace) -> None:
    makes, cells = letters(options.make), cells_of(options.cell)
    sets = options.effects.split(",")
    plans = [
        (letter, cell, effects, options.seed + 100 * draw + 7 * i)
        for cell in cells
        for i, effects in enumerate(sets)
        for draw in range(options.draws)
        for letter in makes
    ]

    def one(plan: tuple[str, str, str, int]) -> None:
        from exo_sim.trials.whole_machines.case import make_case, write_case
        from exo_sim.trials.whole_machines.walk.case import make_worn_case, write_worn_case

        letter, cell, effects, seed = plan
        name = "_".join(part for part in (letter, cell, effects.replace("+", "-"), str(seed)) if part)
        if (options.out / name / "truth" / "truth.json").exists():
            return
        keys = tuple(key for key in effects.split("+") if key)
        settings = {"bulk": options.bulk, "duration": options.duration, "recordings": options.recordings, "weigh": not options.unweighed}
        if find(letter).build == "legs":
            write_worn_case(make_worn_case(name, letter, cell, seed, effects=keys, **settings), options.out / name)
        else:
            write_case(make_case(name, letter, cell, seed, effects=keys, **settings), options.out / name)

    diagnose_cases.spread(one, plans, options.jobs, "making", quiet=False)
    print(f"{len(plans)} cases in {options.out}")


def _score(options: argparse.Namespace) -> None:
    from exo_sim.trials.whole_machines import score_tables

    found = diagnose_cases.marks(options.folder, options.out, options.matters)
    if not found:
        raise TrialError(f"{options.out} holds no answer; python -m exo_sim.trials.whole_machines run {options.folder} --out {options.out}")
    diagnose_cases.write_marks(found, options.out / "marks.json")
    if options.json:
        print(json.dumps(score_tables.plain(found), indent=1))
        return
    print(score_tables.tables(found))
    if options.cases:
        print("\n" + "\n".join(_line(mark) for mark in found))


def _line(mark: Mark) -> str:
    missed = [name for name, hit in zip(mark.expected, mark.found) if not hit]
    ratio = mark.errors.get("windowed_rms_after_over_nearest")
    words = [f"{mark.case}: {sum(mark.found)} of {len(mark.expected)} found"]
    words += [f"missed {', '.join(missed)}"] if missed else []
    words += [f"wrong {', '.join((*mark.wrong, *mark.false_sensors))}"] if mark.wrong or mark.false_sensors else []
    words += [f"unknown in {', '.join(mark.unknown)}"] if mark.unknown else []
    words += [f"error {ratio:.2g} of nearest"] if ratio is not None else []
    return "; ".join(words)


if __name__ == "__main__":
    raise SystemExit(main())
