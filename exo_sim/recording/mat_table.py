"""MATLAB's `.mat`: versions 4 to 7 by SciPy, 7.3 (which is HDF5) by h5py. Structs are walked through, matrices taken column by column."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError
from exo_sim.recording import columns
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import MOST_BYTES, RawTable, select

_HDF5 = b"\x89HDF\r\n\x1a\n"
#: A matrix with more columns than that is no table of signals; structs deeper than that are not walked.
_MOST_COLUMNS, _DEEPEST = 200, 8


def read_mat(path: Path, column_map: ColumnMap | None = None) -> RawTable:
    """Read a `.mat` file.

    Signals are called `variable`, `struct.field`, and `matrix(:,3)` for the third column of a matrix; a column map says which is which.
    Without a map, a matrix `data` with a cell `headings` of names like "piston.pressure_1 [Pa]" is read.

    Raises:
        RecordingError: not a `.mat` file, nothing in it that is numbers, columns of unequal length, or what `select` refuses.
    """
    held = _hdf5(path) if _is_hdf5(path) else _classic(path)
    found = dict(_vectors(held))
    headings, names = list(found), held.get("headings")
    if column_map is None and isinstance(names, list) and isinstance(held.get("data"), np.ndarray):
        given = [values for name, values in found.items() if name.startswith("data(:,")]
        if len(given) != len(names):
            raise RecordingError(f'"{path}": "headings" names {len(names)} columns and "data" has {len(given)}; give each column a name')
        headings, found = names, dict(zip(names, given))
    if not found:
        raise RecordingError(f'"{path}": no variable in it is a column of numbers; tables and timetables must be saved as structs')
    selection = select(str(path), headings, column_map)
    rows = len(found[selection.columns[0].source])
    for column in selection.columns:
        if len(found[column.source]) != rows:
            raise RecordingError(f'"{path}": "{column.source}" has {len(found[column.source])} samples, the time {rows}; give one a row')
    selection.refuse_if_too_long(str(path), rows)
    values = {column.key: column.to_si(np.array(found[column.source], dtype=float)) for column in selection.columns}
    units = {column.key: column.unit for column in selection.columns}
    return RawTable(values.pop(columns.TIME), values, units, selection.findings)


def _is_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        head = file.read(520)
    return _HDF5 in (head[:8], head[512:520])


def _classic(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat, whosmat

    try:
        size = sum(8.0 * float(np.prod([float(n) for n in shape])) for _, shape, _ in whosmat(path))
        if size > MOST_BYTES:
            raise RecordingError(f'"{path}": its variables would take {size / 1e9:.3g} GB; cut it into pieces')
        held = loadmat(path, simplify_cells=True)
    except (RecordingError, MemoryError):
        raise
    except Exception as error:  # of many kinds, on broken files
        why = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
        raise RecordingError(f'"{path}": not a whole .mat file ({why}): copied in part? Copy it again') from None
    names = held.get("headings")
    if isinstance(names, np.ndarray) and names.dtype.kind in "OU":
        held["headings"] = [str(name).strip() for name in names.ravel()]
    return {name: value for name, value in held.items() if not name.startswith("__")}


def _hdf5(path: Path) -> dict[str, Any]:
    try:
        import h5py
    except ImportError:
        raise RecordingError(
            f'"{path}": version 7.3 needs h5py: pip install \'exo-sim-pneumatic[files]\', or save it with -v7'
        ) from None

    seen = set()

    def taken(group: Any, depth: int) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for name in group:
            if name.startswith("#") or depth > _DEEPEST or not isinstance(group.get(name, getlink=True), h5py.HardLink):
                continue  # MATLAB writes no links, which may lead round in circles, or to other files
            one = group[name]
            if one.id in seen:
                continue
            seen.add(one.id)
            if isinstance(one, h5py.Group):
                found[name] = taken(one, depth + 1)
            elif isinstance(one, h5py.Dataset) and (one.external or one.is_virtual):
                continue  # what it holds stands in other files
            elif isinstance(one, h5py.Dataset) and one.dtype.kind in "fiub" and one.attrs.get("MATLAB_class") != b"char":
                if 8.0 * one.size > MOST_BYTES:
                    raise RecordingError(f'"{path}": "{name}" would take {8e-9 * one.size:.3g} GB; cut it into pieces')
                found[name] = np.asarray(one).T  # MATLAB counts columns first
            elif isinstance(one, h5py.Dataset) and name == "headings" and one.dtype == h5py.ref_dtype:
                found[name] = ["".join(map(chr, np.asarray(group.file[each]).ravel())).strip() for each in np.asarray(one).ravel()]
        return found

    try:
        with h5py.File(path, "r") as file:
            return taken(file, 0)
    except (RecordingError, MemoryError):
        raise
    except Exception as error:  # of many kinds, on broken files
        why = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
        raise RecordingError(f'"{path}": not a whole .mat file of version 7.3 ({why}): copied in part? Copy it again') from None


def _vectors(held: Mapping[str, Any], above: str = "", depth: int = 0) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield name and values, shape (n,), of everything that is a column of numbers."""
    for name, value in held.items():
        path = f"{above}{name}"
        if isinstance(value, Mapping) and depth < _DEEPEST:
            yield from _vectors(value, f"{path}.", depth + 1)
            continue
        if not isinstance(value, np.ndarray) or value.dtype.kind not in "fiub":
            continue
        array = value.squeeze()
        if array.ndim == 1 and array.size > 1:
            yield path, array
        elif array.ndim == 2 and array.shape[1] <= _MOST_COLUMNS:
            for i in range(array.shape[1]):
                yield f"{path}(:,{i + 1})", array[:, i]
