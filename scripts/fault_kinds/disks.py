"""Disks that are full or read-only, as small file systems of their own: one line and status 2, nothing half-written, inputs as they were.

Run as a program within a new user and mount namespace, where it may mount; `scripts/faults` does so.
"""

from __future__ import annotations

import ctypes
import json
import os
import random
import subprocess
import sys
from pathlib import Path

from fault_kinds.child import run
from fault_kinds.commands import COMMANDS, Command, half_written, lay_out
from fault_kinds.outcome import Outcome

_NAMESPACE = ("unshare", "--user", "--map-root-user", "--mount", "--propagation", "private")
_READ_ONLY, _REMOUNT = 1, 32


def fill(folder: Path, bases: Path, sizes: int, seed: int, names: list[str]) -> Outcome:
    """Run every command on disks of some sizes from too small to large enough, and on one that is read-only."""
    outcome = Outcome("disks")
    try:
        subprocess.run([*_NAMESPACE, "mount", "-t", "tmpfs", "tmpfs", str(folder)], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        outcome.left_out.append("this machine lets nobody mount a file system of its own (unshare --user --mount)")
        return outcome
    asked = json.dumps([str(folder), str(bases), sizes, seed, names])
    came = subprocess.run([*_NAMESPACE, sys.executable, "-m", "fault_kinds.disks", asked], capture_output=True, text=True)
    if came.returncode:
        outcome.broken.append(f"the faults themselves failed: {came.stderr[-800:]}")
        return outcome
    counts, outcome.broken, outcome.figures = json.loads(came.stdout.splitlines()[-1])
    outcome.counts.update(counts)
    return outcome


def _within(folder: Path, bases: Path, sizes: int, seed: int, names: list[str]) -> Outcome:
    outcome, draw = Outcome("disks"), random.Random(seed)
    for command in COMMANDS:
        if command.name not in names:
            continue
        needed = _undisturbed(command, folder, bases, outcome)
        if needed is None:
            continue
        held, most = needed
        for _ in range(sizes):
            _full(command, folder, bases, held + round(draw.uniform(0.0, 1.1) * (most - held)), outcome)
        _read_only(command, folder, bases, outcome)
    return outcome


def _undisturbed(command: Command, folder: Path, bases: Path, outcome: Outcome) -> tuple[int, int] | None:
    """Return how many bytes the inputs take, and these and the outputs together."""
    place = folder / "disk"
    _mounted(place, 1 << 30)
    try:
        lay_out(command, bases, place)
        held = _bytes(place)
        ended = run(command.words, place, folder / "said")
        if ended.status not in command.statuses:
            outcome.broken.append(f"{command.name}: ends with {ended.status} on a disk of its own: {ended.err[-300:]}")
            return None
        return held, _bytes(place)
    finally:
        _unmounted(place)


def _full(command: Command, folder: Path, bases: Path, size: int, outcome: Outcome) -> None:
    place = folder / "disk"
    _mounted(place, 2 * size + (1 << 20))
    try:
        lay_out(command, bases, place)
        inputs = _contents(place)
        free = os.statvfs(place)
        ballast = free.f_bavail * free.f_frsize - max(0, size - sum(map(len, inputs.values())))
        with (place / "ballast").open("wb") as file:
            file.write(b"\0" * max(0, ballast))
        ended = run(command.words, place, folder / "said")
        outcome.count(f"{command.name} {'full' if ended.status == 2 else 'fits'}")
        outcome.broken += half_written(command, place)
        outcome.broken += _odd(command, f"on a full disk of {size} bytes", ended.status, ended.err)
        outcome.broken += _changed(command, place, inputs)
    finally:
        _unmounted(place)


def _read_only(command: Command, folder: Path, bases: Path, outcome: Outcome) -> None:
    place = folder / "disk"
    _mounted(place, 1 << 30)
    try:
        lay_out(command, bases, place)
        _mount("tmpfs", place, _REMOUNT | _READ_ONLY, "")
        ended = run(command.words, place, folder / "said")
        outcome.count(f"{command.name} read-only")
        outcome.figures[f"{command.name} finds out that its folder is read-only after"] = f"{ended.seconds:.1f} s"
        if ended.status != 2:
            outcome.broken.append(f"{command.name}: ends with {ended.status} in a read-only folder: {ended.err[-300:]}")
        outcome.broken += _odd(command, "in a read-only folder", ended.status, ended.err)
    finally:
        _unmounted(place)


def _odd(command: Command, where: str, status: int, err: str) -> list[str]:
    lines = [line for line in err.splitlines() if line]
    if status not in (2, *command.statuses) or "Traceback" in err or "Exception ignored" in err:
        return [f"{command.name} {where}: ended with {status}: {err[-500:]}"]
    if status == 2 and (not lines or not lines[-1].startswith("exo-sim: ")):
        return [f"{command.name} {where}: no line that says why: {err[-300:]}"]
    return []


def _changed(command: Command, place: Path, inputs: dict[str, bytes]) -> list[str]:
    now = _contents(place)
    return [
        f"{command.name}: changed its input {name}" for name, held in inputs.items()
        if now.get(name) != held and name not in command.outputs
    ]  # fmt: skip


def _contents(place: Path) -> dict[str, bytes]:
    return {str(path.relative_to(place)): path.read_bytes() for path in place.rglob("*") if path.is_file() and path.name != "ballast"}


def _bytes(place: Path) -> int:
    return sum(path.stat().st_size for path in place.rglob("*") if path.is_file())


def _mount(kind: str, place: Path, flags: int, options: str) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mount(b"tmpfs", os.fsencode(place), kind.encode(), ctypes.c_ulong(flags), options.encode()):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()), str(place))


def _mounted(place: Path, size: int) -> None:
    place.mkdir(exist_ok=True)
    _mount("tmpfs", place, 0, f"size={size}")


def _unmounted(place: Path) -> None:
    ctypes.CDLL(None).umount2(os.fsencode(place), 2)  # MNT_DETACH: what is still at work does not hold it


if __name__ == "__main__":
    came = _within(*(Path(one) if i < 2 else one for i, one in enumerate(json.loads(sys.argv[1]))))  # type: ignore[arg-type]
    print(json.dumps([came.counts, came.broken, came.figures]))
