"""What a C3D file holds, read in a process of its own: ezc3d ends or stops the process that hands it some broken files.

Run as a program, it writes the content of the file named on its command line to stdout, as NumPy arrays with a line of JSON beside them.
"""

from __future__ import annotations

import io
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Processor seconds that reading may take, and memory [bytes]; for each byte of the file so much more.
_SECONDS, _SECONDS_PER_BYTE = 30, 1e-6
_MEMORY, _MEMORY_PER_BYTE = 2_000_000_000, 100
_EVENTS = ("CONTEXTS", "LABELS", "TIMES")


@dataclass(frozen=True)
class Content:
    """What is used of a C3D file.

    Attributes:
        rate: Of the points [Hz].
        first_frame: Number of the first frame.
        labels: Of the points.
        points: Components, points, frames, as they are written, shape (3, len(labels), n).
        angle_unit: As the file says, "deg" where it does not.
        events: Context and label of each event.
        event_times: Minutes and seconds of each event, shape (2, m).
        forces: Of each force plate, x, y and z, shape (3, k): in the laboratory's axes, or where ezc3d refuses the plates, in the plate's.
        refused: Why there is no force of plates that the file names, or "".
    """

    rate: float
    first_frame: int
    labels: tuple[str, ...]
    points: NDArray[np.float64]
    angle_unit: str
    events: tuple[tuple[str, str], ...]
    event_times: NDArray[np.float64]
    forces: tuple[NDArray[np.float64], ...]
    refused: str = ""


def read_content(path: Path) -> Content:
    """Read a C3D file.

    Raises:
        ValueError: it cannot be read; the message says why.
    """
    # -P: what lies beside this file is not what ezc3d imports
    done = subprocess.run([sys.executable, "-P", __file__, str(path)], stdin=subprocess.DEVNULL, capture_output=True, check=False)
    if done.returncode:
        said = done.stderr.decode(errors="replace").strip().rsplit("\n", 1)[-1] if done.returncode == 1 else ""
        raise ValueError(said or "it is broken")
    with np.load(io.BytesIO(done.stdout)) as held:
        words = json.loads(str(held["words"]))
        forces = tuple(held[f"force_{i}"] for i in range(words["plates"]))
        return Content(
            words["rate"], words["first_frame"], tuple(words["labels"]), held["points"], words["angle_unit"],
            tuple((side, label) for side, label in words["events"]), held["event_times"], forces, words["refused"],
        )  # fmt: skip


def _taken(path: str) -> dict[str, Any]:
    """Return what `Content` holds, as arrays and words."""
    import ezc3d

    plain = ezc3d.c3d(path)
    used = plain["parameters"].get("FORCE_PLATFORM", {}).get("USED", {"value": [0]})["value"]
    content, by_hand, refused = plain, None, ""
    if len(used) and used[0] > 0:
        try:
            content = ezc3d.c3d(path, extract_forceplat_data=True)
        except Exception as error:  # it refuses what it wrote itself: whole numbers as fractions
            try:
                by_hand = _forces(plain, int(used[0]))
            except (KeyError, IndexError, TypeError, ValueError):
                refused = next(iter(str(error).splitlines()), type(error).__name__)
    point, event = content["parameters"]["POINT"], content["parameters"].get("EVENT", {})
    labels, points = [str(label) for label in point["LABELS"]["value"]], np.asarray(content["data"]["points"], dtype=float)[:3]
    rate = float(point["RATE"]["value"][0])
    if not 0.0 < rate < 1e6:
        raise ValueError(f"it says {rate:g} frames a second")
    if points.shape[1] < len(labels):
        raise ValueError(f"it names {len(labels)} points and holds {points.shape[1]}")
    units = point.get("ANGLE_UNITS", {"value": []})["value"]
    times = np.zeros((2, 0))
    events: list[tuple[str, str]] = []
    if all(key in event for key in _EVENTS):
        given = np.asarray(event["TIMES"]["value"], dtype=float)
        events = [(str(side), str(label)) for side, label in zip(event["CONTEXTS"]["value"], event["LABELS"]["value"])]
        if given.ndim == 2 and len(given) == 2:
            times = given[:, : len(events)]
        events = events[: times.shape[1]]
    plates = [np.asarray(plate["force"], dtype=float) for plate in content["data"].get("platform", [])] if by_hand is None else by_hand
    words = {
        "rate": rate, "first_frame": int(content["header"]["points"]["first_frame"]), "labels": labels,
        "angle_unit": str(units[0]) if len(units) else "deg", "events": events, "plates": len(plates), "refused": refused,
    }  # fmt: skip
    arrays = {f"force_{i}": force for i, force in enumerate(plates)}
    return {"words": np.array(json.dumps(words)), "points": points, "event_times": times, **arrays}


def _forces(plain: Any, plates: int) -> list[NDArray[np.float64]]:
    """Return the force of each plate from its channels, by the C3D format's types of plates, shape (3, k).

    Raises:
        KeyError, IndexError, TypeError, ValueError: a parameter is missing or cannot be, or a plate is of another type.
    """
    group = plain["parameters"]["FORCE_PLATFORM"]
    analogs = np.asarray(plain["data"]["analogs"], dtype=float)[0]
    channels = np.asarray(group["CHANNEL"]["value"], dtype=float).reshape(-1, plates, order="F")
    found = []
    for i in range(plates):
        kind, rows = int(group["TYPE"]["value"][i]), channels[:, i].astype(int) - 1
        if rows[:6].min() < 0:
            raise ValueError("a plate names no channel")
        measured = analogs[rows[rows >= 0]]
        if kind in (1, 2):
            found.append(measured[:3])
        elif kind == 3:  # four sensors of three axes: x12, x34, y14, y23, z1 to z4
            found.append(np.stack([measured[0:2].sum(axis=0), measured[2:4].sum(axis=0), measured[4:8].sum(axis=0)]))
        elif kind == 4:
            matrix = np.asarray(group["CAL_MATRIX"]["value"], dtype=float).reshape(6, 6, plates, order="F")[:, :, i]
            found.append((matrix @ measured[:6])[:3])
        else:
            raise ValueError(f"a plate of type {kind}")
    return found


def _bounded(size: int) -> None:
    """Bound what this process may take; where the system has no such bounds it goes without."""
    try:
        import resource
    except ImportError:  # Windows
        return
    seconds = round(_SECONDS + _SECONDS_PER_BYTE * size)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    if sys.platform == "linux":
        memory = round(_MEMORY + _MEMORY_PER_BYTE * size)
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))


if __name__ == "__main__":
    try:
        _bounded(Path(sys.argv[1]).stat().st_size)
        taken = _taken(sys.argv[1])
    except BaseException as error:
        said = next(iter(str(error).splitlines()), "")
        sys.exit(f"{type(error).__name__}: {said}" if isinstance(error, KeyError) or not said else said)
    out = io.BytesIO()
    np.savez(out, **taken)
    sys.stdout.buffer.write(out.getvalue())
