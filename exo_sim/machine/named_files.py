"""The files that an MJCF names: MuJoCo opens them itself, so that a device or pipe among them is found before it does."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import unescape
from pathlib import Path, PureWindowsPath

from exo_sim.inputs import MOST_TEXT, check_regular

_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
#: `file`, `fileright` ... of meshes, textures, height fields and included models, and the folders that they lie in.
_ATTRIBUTE = re.compile(r"""\b(file\w*|meshdir|texturedir|assetdir)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_INCLUDED = (".xml", ".mjcf", ".urdf", "")


def check_named(model: Path) -> None:
    """Refuse a model that is, or names, what is no regular file; what is not there MuJoCo itself says.

    Raises:
        FileNotFoundError: there is no such model.
        ValueError: a folder, a device or a pipe stands in a file's place, or a model is too large; the message says which.
        OSError: it cannot be read.
    """
    check_regular(model)
    waiting, seen, folders = [model], {model.resolve()}, [""]
    named: list[tuple[Path, str]] = []
    while waiting:
        path = waiting.pop()
        for attribute, value in _attributes(path):
            if attribute.endswith("dir"):
                folders.append(value)
                continue
            named.append((path, value))
            for there in _places(model, path, value, [""]):
                if there.suffix.lower() in _INCLUDED and there.resolve() not in seen and there.exists():
                    _check(there, model, value)
                    seen.add(there.resolve())
                    waiting.append(there)
    for path, value in named:
        for there in _places(model, path, value, folders):
            _check(there, model, value)


def _attributes(path: Path) -> Iterator[tuple[str, str]]:
    size = path.stat().st_size
    if size > MOST_TEXT:
        raise ValueError(f'"{path.name}" has {size / 1e6:.0f} MB, more than a model has ({MOST_TEXT / 1e6:.0f} MB)')
    text = _COMMENT.sub("", path.read_text(encoding="utf-8", errors="surrogateescape"))
    for found in _ATTRIBUTE.finditer(text):
        value = unescape(found[2] if found[2] is not None else found[3])
        if value and "\0" not in value:
            yield found[1], value


def _places(model: Path, path: Path, value: str, folders: list[str]) -> set[Path]:
    """Return where MuJoCo may look for a file: beside the model or the one that includes it, in its folders, with and without its own."""
    names = {value, PureWindowsPath(value).name}
    return {base / folder / name for base in (model.parent, path.parent) for folder in folders for name in names}


def _check(there: Path, model: Path, value: str) -> None:
    """Refuse what is there and no file."""
    try:
        if there.is_dir():  # MuJoCo says so itself
            return
        check_regular(there)
    except FileNotFoundError:
        return
    except ValueError as error:
        raise ValueError(f'file="{value}" {error}') from None
    except OSError:  # too long, a loop of links: MuJoCo says what it cannot open
        return
