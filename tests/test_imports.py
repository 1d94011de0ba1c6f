"""No import goes round in a circle: what `lint-imports` checks between files, and what it does not see beside that.

Whoever imports a file has its packages' `__init__` run first, and `exo_sim/__init__` hands on the whole of `exo_sim.api`, each part when it
is first used: its stub lists them. What stands under `TYPE_CHECKING` is never imported.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.sparse.csgraph import connected_components


def modules(package: Path) -> dict[str, list[Path]]:
    """Return the files of every module by its name: one, and the stub of a package that hands on what others hold."""
    found: dict[str, list[Path]] = {}
    for path in sorted([*package.rglob("*.py"), *package.rglob("*.pyi")]):
        parts = path.relative_to(package.parent).with_suffix("").parts
        found.setdefault(".".join(parts[:-1] if parts[-1] == "__init__" else parts), []).append(path)
    return found


def imported(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield module and name of everything that is imported, inside functions too; a name is "" where a module is."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.module or "", alias.name) for alias in node.names)
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module") and isinstance(node.args[0], ast.Constant):
            yield str(node.args[0].value), ""
        if not isinstance(node, ast.Import | ast.ImportFrom):
            yield from imported(node)


def needs(package: Path) -> dict[str, set[str]]:
    """Return which module needs which: those that it imports, and the packages of these that it is not in itself."""
    known: dict[str, list[Path]] = modules(package)
    found: dict[str, set[str]] = {}
    for name, paths in known.items():
        found[name] = set()
        for module, attribute in (each for path in paths for each in imported(ast.parse(path.read_text()))):
            needed = f"{module}.{attribute}" if f"{module}.{attribute}" in known else module
            parts = needed.split(".")
            around = {".".join(parts[:k]) for k in range(1, len(parts))}
            found[name] |= {needed, *(each for each in around if not f"{name}.".startswith(f"{each}."))} & set(known) - {name}
    return found


def circles(package: Path) -> list[list[str]]:
    """Return the groups of modules of which each needs all others, by way of some."""
    found = needs(package)
    names = sorted(found)
    count, group = connected_components(np.array([[other in found[name] for other in names] for name in names]), connection="strong")
    each = [[name for name, own in zip(names, group, strict=True) if own == k] for k in range(count)]
    return sorted(one for one in each if len(one) > 1)


def test_no_import_goes_round_in_a_circle(repository: Path) -> None:
    assert circles(repository / "exo_sim") == []


def test_circles_that_pass_a_package_s_own_file_are_seen(tmp_path: Path) -> None:
    """One that goes through a package's `__init__`, one through its stub, one inside functions, one by a module's name as text."""
    texts = {
        "house/__init__.py": "", "house/__init__.pyi": "from house.front import door", "house/front.py": "from house.room import floor",
        "house/room.py": "from house import version",
        "house/cellar/__init__.py": "from house.cellar.stairs import step", "house/cellar/stairs.py": "from house.attic import roof",
        "house/attic.py": "from house.cellar import lamp", "house/cellar/lamp.py": "",
        "house/one.py": "def f():\n    from house.two import g", "house/two.py": "import importlib\nimportlib.import_module('house.one')",
        "house/types.py": "if TYPE_CHECKING:\n    from house.kinds import K", "house/kinds.py": "from house.types import T",
    }  # fmt: skip
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert circles(tmp_path / "house") == [
        ["house", "house.front", "house.room"], ["house.attic", "house.cellar", "house.cellar.stairs"], ["house.one", "house.two"],
    ]  # fmt: skip
