"""No function takes more arguments than one keeps in mind; what belongs together is a record (CONTRIBUTING, Manners)."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

MOST = 10
#: A kernel's arrays go flat: numba hands over a record of many arrays more slowly.
MOST_OF_A_KERNEL = 27
COMPILED = {"kernel", "inlined_kernel", "within", "njit"}
#: A verb has an argument for each option of the command, and so has its function in the API, where they go by name.
VERB, API = "verb", "exo_sim/api"

Function = ast.FunctionDef | ast.AsyncFunctionDef


def functions(path: Path) -> list[Function]:
    return [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, Function)]


def decorators(function: Function) -> set[str]:
    calls = (one.func if isinstance(one, ast.Call) else one for one in function.decorator_list)
    return {ast.unparse(one).split(".")[-1] for one in calls}


def most(function: Function) -> int | None:
    """Return how many arguments a function may take; None where there is no limit."""
    if VERB in decorators(function):
        return None
    return MOST_OF_A_KERNEL if decorators(function) & COMPILED else MOST


def arguments(function: Function, by_name_free: bool = False) -> int:
    """Return how many arguments a function takes beside `self`; those that only go by name may be left out."""
    given = function.args.posonlyargs + function.args.args + ([] if by_name_free else function.args.kwonlyargs)
    return len(given) - (bool(given) and given[0].arg in ("self", "cls"))


def sources(repository: Path) -> list[Path]:
    scripts = [path for path in (repository / "scripts").iterdir() if path.is_file()]
    python = [path for path in scripts if path.read_bytes().startswith(b"#!/usr/bin/env python")]
    return python + [path for room in ("exo_sim", "scripts", "tests") for path in (repository / room).rglob("*.py")]


def test_no_function_takes_too_many(repository: Path) -> None:
    found = []
    for path in sources(repository):
        for function in functions(path):
            limit, count = most(function), arguments(function, by_name_free=path.is_relative_to(repository / API))
            if limit is not None and count > limit:
                found.append(f"{path.relative_to(repository)}: {function.name} takes {count} arguments, {limit} at most")
    assert found == [], "put what belongs together into a record"


@pytest.mark.parametrize(
    ("text", "count", "limit"),
    [
        ("def f(self, a, b=1, *rest, c, **more): ...", 3, MOST),
        ("@kernel\ndef f(a, /, b): ...", 2, MOST_OF_A_KERNEL),
        ("@numba.njit(nogil=True)\ndef f(a): ...", 1, MOST_OF_A_KERNEL),
        ("@verb('exo-sim run')\ndef f(a): ...", 1, None),
    ],
)
def test_what_is_counted_and_what_is_exempt(tmp_path: Path, text: str, count: int, limit: int | None) -> None:
    path = tmp_path / "one.py"
    path.write_text(text)
    (function,) = functions(path)
    assert (arguments(function), most(function)) == (count, limit)
