"""Make and run: cases as users would have them, diagnosed blind by any command that keeps the public contract."""

from __future__ import annotations

import json
import re
import shlex
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.errors import TrialError
from exo_sim.outputs import alone_in, replacing
from exo_sim.progress import each
from exo_sim.trials.case_mix import Plan
from exo_sim.trials.json_file import read_json
from exo_sim.trials.seal import digest_of, new_key, seal, write_key
from exo_sim.trials.tool import bring_back, command, lay_out, run_tool
from exo_sim.trials.verdict_chain import VerdictChain

if TYPE_CHECKING:
    from exo_sim.trials.cases import Case

MANIFEST = "manifest.json"
#: Makes and seals the case of a plan, given the trial's folder, the key, seconds and the format; returns its entry of the manifest.
Maker = Callable[[Any, Path, str, float, str], tuple[str, dict[str, Any]]]
#: What runs when no other tool is named; the recordings, `--rig` and `--out` follow.
OWN_TOOL = f"{shlex.quote(sys.executable)} -m exo_sim diagnose --quiet"


def make(
    folder: Path,
    plans: Sequence[Any],
    key_file: Path,
    duration: float = 24.0,
    jobs: int = 1,
    fmt: str = "parquet",
    quiet: bool = False,
    truth: str = "own",
    one: Maker | None = None,
) -> dict[str, Any]:
    """Write and seal a trial.

    Args:
        folder: Where; must not hold a trial yet.
        plans: Its cases, at least one; the same plans give the same cases (not the same nonces and keys).
        key_file: Where the key goes that opens the seals.
        duration: Length of a recording [s].
        jobs: Processes.
        fmt: "parquet" or "csv".
        quiet: No progress.
        truth: Of whose making: which figures are drawn when the seals are opened.
        one: Makes and seals the case of one plan; `make_one` when absent.

    Raises:
        TrialError: the folder holds a trial, or the key's file exists.
    """
    if (folder / MANIFEST).exists():
        raise TrialError(f"{folder} holds a trial already; name another folder")
    if key_file.exists():
        raise TrialError(f"{key_file} exists; a key is never written over, name another file with --key")
    key = new_key()
    maker = one or make_one
    cases = _spread(lambda plan: maker(plan, folder, key, duration, fmt), plans, jobs, "making", quiet)
    manifest = {"schema": "exo-sim/trial/1", "truth": truth, "count": len(plans), "duration": duration, "cases": dict(cases)}
    write_key(key_file, key, manifest)
    with replacing(folder / MANIFEST) as beside:
        beside.write_text(json.dumps(manifest, indent=1) + "\n")
    return manifest


def make_one(plan: Plan, folder: Path, key: str, duration: float, fmt: str = "parquet") -> tuple[str, dict[str, Any]]:
    """Write one case and its sealed truth; return its entry of the manifest."""
    from exo_sim.trials.cases import make_case, truth_of, write_case
    from exo_sim.trials.detection_limit import concealed, distance, limit, sized

    size = [sized([one], times)[0] for one, times in zip(plan.effects, plan.times)]

    if plan.cell == "leg":
        return _make_leg(plan, folder, key, size, duration, fmt)

    def draw(effects: Sequence[str], sizes: Sequence[float], seed: int) -> Case:
        return make_case(plan.name, effects, seed, sizes, replace(plan.conditions, duration=duration), keep_states=True)

    case, seed = None, plan.seed
    while case is None:
        try:
            case = draw(plan.effects, size, seed)
        except TrialError:
            seed += 1
    if len(plan.effects) == 1:
        alone = {plan.effects[0]: distance(case)}
    else:
        alone = {one: distance(draw([one], [s], seed)) for one, s in zip(plan.effects, size)}
    if plan.conceal:
        case = concealed(case)
    where = folder / "cases" / plan.name
    paths = write_case(case, where, fmt)
    truth = truth_of(case)
    for entry, one, s in zip(truth["hidden"], plan.effects, size):
        entry |= {"times_limit": s / limit(one), "distance": alone[one]}
    truth["actual"] = {
        "flow_capacity": case.machine["valve_area"] / case.believed.valve_area,
        "dead_volume": (case.machine["dead_1"] + case.machine["dead_2"])
        / (case.believed.dead_1 + case.believed.dead_2),
        "payload_mass": case.machine["load_mass"] / case.believed.mass,
        "flow_capacity_value": case.machine["valve_area"],
        "payload_mass_value": case.machine["load_mass"],
    }
    return seal_case(plan.name, plan.cell, folder, [where / "rig.toml", where / "bench.xml", *paths], truth, key)


def _make_leg(
    plan: Plan, folder: Path, key: str, size: Sequence[float], duration: float, fmt: str
) -> tuple[str, dict[str, Any]]:
    from exo_sim.trials.cases import truth_of, write_case
    from exo_sim.trials.conditions import LegConditions
    from exo_sim.trials.detection_limit import limit
    from exo_sim.trials.leg_cases import actual, make_leg_case
    from exo_sim.trials.leg_detection_limit import distance

    case = make_leg_case(plan.name, plan.effects, plan.seed, size, LegConditions(duration=duration))
    where = folder / "cases" / plan.name
    paths = write_case(case, where, fmt)
    truth = truth_of(case)
    truth["actual"] = actual(case)
    for entry, one, s in zip(truth["hidden"], plan.effects, size):
        entry |= {"times_limit": s / limit(one), "distance": distance(case)}
    return seal_case(plan.name, plan.cell, folder, [where / "rig.toml", where / "leg.xml", *paths], truth, key)


def seal_case(
    name: str, cell: str, folder: Path, written: Sequence[Path], truth: dict[str, Any], key: str
) -> tuple[str, dict[str, Any]]:
    """Seal the truth of a case whose files are written; return its entry of the manifest."""
    truth["cell"] = cell
    stored, commitment = seal(truth, key)
    sealed = folder / "sealed" / f"{name}.sealed"
    with replacing(sealed) as beside:
        beside.write_bytes(stored)
    files = {path.name: digest_of(path) for path in written}
    return name, {"files": files, "commitment": commitment, "sealed": digest_of(sealed)}


def read_manifest(folder: Path) -> dict[str, Any]:
    """Return the manifest of a trial.

    Raises:
        TrialError: there is none, or it is not as `make` wrote it.
    """
    path = folder / MANIFEST
    try:
        manifest = read_json(path)
    except (FileNotFoundError, NotADirectoryError):
        raise TrialError(f"{folder} holds no trial ({MANIFEST} is missing); make one with trial make") from None
    except ValueError:
        raise TrialError(f"{path}: not JSON; the manifest was altered") from None
    cases = manifest.get("cases") if isinstance(manifest, dict) else None
    if not isinstance(cases, dict):
        raise TrialError(f"{path}: not the manifest of a trial")
    if not cases:
        raise TrialError(f"{path}: it names no case; the manifest was altered")
    for name, entry in cases.items():
        if not (_is_plain(name) and isinstance(entry, dict) and _is_entry(entry)):
            raise TrialError(f'{path}: the entry of case "{name}" is not as it was made; the manifest was altered')
    return manifest


def _is_entry(entry: dict[str, Any]) -> bool:
    files = entry.get("files")
    return (
        isinstance(files, dict)
        and "rig.toml" in files
        and all(_is_plain(file) and isinstance(expected, str) for file, expected in files.items())
        and all(isinstance(entry.get(key), str) for key in ("commitment", "sealed"))
    )


def _is_plain(name: str) -> bool:
    """Return whether a name is that of a file in its folder and nothing else: no path, not hidden."""
    return re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}", name) is not None


def check_inputs(folder: Path, manifest: dict[str, Any]) -> None:
    """Check that every file is the one that `make` wrote.

    Raises:
        TrialError: one is missing or altered.
    """
    for name, entry in manifest["cases"].items():
        for file, expected in entry["files"].items():
            _same(folder / "cases" / name / file, expected)
        _same(folder / "sealed" / f"{name}.sealed", entry["sealed"])


def _same(path: Path, expected: str) -> None:
    if not path.is_file():
        raise TrialError(f"{path} is missing; the trial is not complete")
    if digest_of(path) != expected:
        raise TrialError(f"{path} was altered after the trial was made")


def ledger_of(folder: Path) -> VerdictChain:
    """Return the chain of verdicts of a trial."""
    return VerdictChain(folder / "verdicts.jsonl", folder / "run" / "signing.key")


def run(folder: Path, tool: str = OWN_TOOL, jobs: int = 1, scheduler: str | None = None, timeout: float = 600.0,
        quiet: bool = False) -> dict[str, Any]:  # fmt: skip
    """Diagnose every case that has no verdict yet, and sign the verdicts in the order of the cases.

    Args:
        folder: The trial.
        tool: Command line; recordings, `--rig` and `--out` are appended.
        jobs: Cases at a time.
        scheduler: Address of a Dask scheduler; then `jobs` does not count.
        timeout: Seconds a case may take.
        quiet: No progress.

    Raises:
        TrialError: an input was altered, the ledger is closed or broken.
        OutputError: another process diagnoses this trial, or its folder cannot be written.
    """
    manifest = read_manifest(folder)
    check_inputs(folder, manifest)
    with alone_in(folder, "trial"):
        return _run(folder, manifest, tool, jobs, scheduler, timeout, quiet)


def _run(
    folder: Path, manifest: dict[str, Any], tool: str, jobs: int, scheduler: str | None, timeout: float, quiet: bool
) -> dict[str, Any]:
    ledger = ledger_of(folder)
    names = sorted(manifest["cases"])
    done = {record["case"] for record in ledger.checked()}
    todo = [name for name in names if name not in done]

    def work(name: str) -> tuple[str, dict[str, Any]]:
        return name, diagnose_one(folder, name, manifest["cases"][name], tool, timeout)

    for name, outcome in _stream(work, todo, jobs, scheduler, quiet):
        ledger.append({"case": name, "tool": tool, **outcome})
    if not set(names) - {record["case"] for record in ledger.records()}:
        ledger.close()
    return {"verdicts": len(names), "new": len(todo), "head": ledger.head()}


def diagnose_one(folder: Path, name: str, entry: dict[str, Any], tool: str, timeout: float) -> dict[str, Any]:
    """Run the tool on one case in a folder of its own; return what goes into the ledger.

    The tool sees copies of rig, model and recordings and nothing of the trial around them.
    """
    import tempfile

    out = folder / "run" / name
    with tempfile.TemporaryDirectory(prefix="case_", ignore_cleanup_errors=True) as bare:
        ran = run_tool(command(tool, lay_out(folder / "cases" / name, entry["files"], Path(bare))), Path(bare), timeout)
        answered = bring_back(Path(bare) / "out", out, folder / "cases" / name)
    improved = out / "improved.toml"
    return {
        "status": ran.status,
        "words": "" if answered else ran.words,
        "diagnosis": digest_of(out / "diagnosis.json") if answered else None,
        "improved": digest_of(improved) if answered and improved.exists() else None,
        "wall_s": ran.wall_s,
        "cpu_s": ran.cpu_s,
        "peak_bytes": ran.peak_bytes,
    }


def _spread(work: Callable[[Any], Any], items: Sequence[Any], jobs: int, words: str, quiet: bool) -> list[Any]:
    if jobs == 1:
        return [work(item) for item in each(items, words, total=len(items), unit="case", quiet=quiet, at_once=True)]
    from joblib import Parallel, delayed

    results = Parallel(n_jobs=jobs, return_as="generator")(delayed(work)(item) for item in items)
    return list(each(results, words, total=len(items), unit="case", quiet=quiet, at_once=True))


def _stream(work: Callable[[Any], Any], items: Sequence[Any], jobs: int, scheduler: str | None, quiet: bool) -> Any:
    """Yield results in the order of the items, as they come."""
    if scheduler is not None:
        from distributed import Client

        with Client(scheduler) as client:
            futures = client.map(work, items, pure=False)
            results = (future.result() for future in futures)
            yield from each(results, "diagnosing", total=len(items), unit="case", quiet=quiet, at_once=True)
        return
    if jobs == 1:
        yield from each(map(work, items), "diagnosing", total=len(items), unit="case", quiet=quiet, at_once=True)
        return
    from joblib import Parallel, delayed

    # the work is a process of its own already, so threads are enough
    results = Parallel(n_jobs=jobs, return_as="generator", prefer="threads")(delayed(work)(item) for item in items)
    yield from each(results, "diagnosing", total=len(items), unit="case", quiet=quiet, at_once=True)
