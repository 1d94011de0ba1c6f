"""Machine code is kept between starts, and a disk that cannot hold it stops nobody."""

import ast
import errno
import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numba.core.caching import FunctionCache

from exo_sim.physics import compiled

TEXT = """
from exo_sim.physics.compiled import kernel

@kernel
def twice(x):
    return 2.0 * x
"""


def fresh(folder: Path, name: str) -> ModuleType:
    path = folder / f"{name}.py"
    if not path.exists():
        path.write_text(TEXT)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_second_start_finds_the_machine_code(tmp_path: Path) -> None:
    for hits in (0, 1):
        twice = fresh(tmp_path, "kept").twice
        assert twice(1.5) == 3.0
        assert sum(twice.stats.cache_hits.values()) == hits


def test_what_was_kept_is_called_by_what_is_compiled_after_it(tmp_path: Path) -> None:
    """Machine code is taken from the cache without all that numba compiles with; what comes next must not miss it."""
    (tmp_path / "called.py").write_text(TEXT)
    (tmp_path / "calling.py").write_text("""
import sys
import numba, numpy as np
from called import twice

assert twice(1.5) == 3.0
kept = sum(twice.stats.cache_hits.values()) == 1
assert kept == (sys.argv[1] == "again") == ("numba.np.arraymath" not in sys.modules)

@numba.njit
def of_all(x):
    out = np.empty_like(x)
    for i in range(x.size):
        out[i] = twice(x[i])
    return np.sum(out)

assert of_all(np.ones(3)) == 6.0
""")
    for turn in ("first", "again"):
        done = subprocess.run([sys.executable, tmp_path / "calling.py", turn], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


def test_no_number_that_is_compiled_in_comes_from_a_file_that_the_cache_does_not_watch() -> None:
    """A constant that a kernel's file imports is in its machine code: an edit of it must not meet the old code."""
    watched = set(compiled._sources())
    package = compiled._PACKAGE
    for path in [path for path in watched if "@kernel" in path.read_text() or "@inlined_kernel" in path.read_text()]:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("exo_sim."):
                imported = package.parent / (node.module or "").replace(".", "/")
                numbers = [name.name for name in node.names if name.name.isupper()]
                assert not numbers or imported.with_suffix(".py") in watched or imported / "__init__.py" in watched, (path, numbers)
    assert {"runge_kutta_chebyshev.py", "plant_records.py", "state.py"} <= {path.name for path in watched}


def test_a_full_disk_costs_only_the_keeping(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: FunctionCache, sig: object, data: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(FunctionCache, "save_overload", full)
    for _ in range(2):
        twice = fresh(tmp_path, "lost").twice
        assert twice(1.5) == 3.0
        assert not twice.stats.cache_hits


PAIR = np.dtype([("one", float), ("two", float)])
_own = compiled.own_array(2, 3)


@compiled.kernel
def changed(pairs):  # type: ignore[no-untyped-def]
    own, table = compiled.own_copy(pairs[0]), _own()
    own.one += 1.0
    table[:] = own.one
    table[1, 2] = own.two
    return own.one + pairs[0].one, table.sum(), table.shape


def test_what_a_kernel_has_of_its_own_is_nobody_elses() -> None:
    pairs = np.array([(2.0, 7.0)], PAIR)
    assert changed(pairs) == (5.0, 5 * 3.0 + 7.0, (2, 3))
    assert pairs[0]["one"] == 2.0
