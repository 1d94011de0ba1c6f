"""Data flow one way: records of the diagnosis are frozen, and no function writes into the attributes of what it was handed."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import exo_sim.diagnosis

ROOT = Path(exo_sim.diagnosis.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))


def functions(tree: ast.AST) -> Iterator[ast.FunctionDef]:
    """Yield the functions of a file that are not compiled kernels: those write their results into arrays and records."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and not any("kernel" in ast.unparse(one) for one in node.decorator_list):
            yield node


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_records_are_frozen(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ClassDef):
            for one in node.decorator_list:
                assert "dataclass" not in ast.unparse(one) or "frozen=True" in ast.unparse(one), node.name


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_nobody_writes_into_what_he_was_handed(path: Path) -> None:
    for function in functions(ast.parse(path.read_text())):
        handed = {argument.arg for argument in (*function.args.args, *function.args.kwonlyargs)} - {"self"}
        for node in ast.walk(function):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AugAssign) else []
            for target in targets:
                if isinstance(target, ast.Attribute):
                    whole: ast.expr = target
                    while isinstance(whole, (ast.Attribute, ast.Subscript)):
                        whole = whole.value
                    written = ast.unparse(target)
                    # MuJoCo's constraints are switched off while inverse dynamics run, and on again
                    assert not (isinstance(whole, ast.Name) and whole.id in handed) or written == "model.opt.disableflags", written
