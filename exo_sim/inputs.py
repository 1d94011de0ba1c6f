"""Reading what people hand in, as text, TOML and JSON: whatever it is, one sentence says what is wrong with it."""

from __future__ import annotations

import codecs
import json
import re
import stat
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from exo_sim.errors import misspelt

#: Bytes of a text beyond which it is refused.
MOST_TEXT = 20_000_000
#: What the reader of TOML says where a text goes on beyond its line.
_OPEN_QUOTE = re.compile(r"Illegal character '\\n' \(at line (\d+)")
#: How it names a table.
_KEYS, _KEY = re.compile(r"\((?:'[^']*'(?:, |,)?)+\)"), re.compile("'([^']*)'")
#: TOML's own bound: whole numbers have 64 bits.
_MOST_NUMBER = 2**63


@contextmanager
def refusing(refuse: Callable[[str], Exception], missing: str = "there is no such file") -> Iterator[None]:
    """Turn whatever is wrong with a file that is read inside into an error of one's own.

    Args:
        refuse: Makes it of a few words that say what is wrong.
        missing: Those words where there is no such file; what it may be misspelt for is added.

    Raises:
        Exception: what `refuse` made, of a `FileNotFoundError`, `OSError` or `ValueError` inside.
    """
    try:
        yield
    except FileNotFoundError as error:
        raise refuse(missing + (misspelt(Path(error.filename)) if error.filename else "")) from None
    except OSError as error:
        raise refuse(f"cannot be read: {error.strerror or error}") from None
    except ValueError as error:
        raise refuse(str(error)) from None


def check_regular(path: Path) -> None:
    """Refuse what is no regular file: a device or pipe may never end, and cannot be read twice.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it is a folder, a device or a pipe; the message says which.
    """
    kind = path.stat().st_mode
    if not stat.S_ISREG(kind):
        if stat.S_ISDIR(kind):
            raise ValueError("cannot be read: it is a folder, not a file; name a file in it")
        what = "a pipe" if stat.S_ISFIFO(kind) else "a device"
        raise ValueError(f"cannot be read: it is {what}, not a file; save it to a file and name that")


def bytes_of(path: Path) -> bytes:
    """Return what a file holds.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it is no regular file; the message says what it is.
        OSError: it cannot be read.
    """
    check_regular(path)
    return path.read_bytes()


def text_of(path: Path) -> str:
    """Return what a text file holds, without the mark that some editors put before it.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it is no regular file, too large, or not UTF-8; the message says which.
        OSError: it cannot be read.
    """
    check_regular(path)
    size = path.stat().st_size
    if size > MOST_TEXT:
        raise ValueError(f"has {size / 1e6:.0f} MB, more than a text of its kind has ({MOST_TEXT / 1e6:.0f} MB)")
    raw = path.read_bytes()
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise ValueError("is UTF-16 text; save it as UTF-8")
    try:
        return raw.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise ValueError(f"cannot be read as text: it is not UTF-8, byte {error.start} is {error.object[error.start]:#04x}") from None


def toml(text: str) -> dict[str, Any]:
    """Return what a TOML text holds.

    Raises:
        ValueError: it is not TOML, is nested too deeply, or has a number that is too long; the message says which.
    """
    try:
        values = tomllib.loads(text)
        _check_numbers(values, "")
        return values
    except RecursionError:
        raise ValueError("is nested too deeply") from None
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"is not TOML: {_said(str(error))}") from None
    except _TooLong:
        raise
    except ValueError:  # Python's bound on digits
        raise ValueError("holds a number of too many digits") from None


def _said(words: str) -> str:
    """Return what the reader of TOML says, of a quote that nothing closes in words that name it."""
    if found := _OPEN_QUOTE.search(words):
        return f"a quote is not closed in line {found[1]}"
    if words.startswith("Expected \"'\""):
        return "a single quote (') is not closed"
    words = _KEYS.sub(lambda found: "[" + ".".join(_KEY.findall(found[0])) + "]", words)
    return f"{words[0].lower()}{words[1:]}"


class _TooLong(ValueError):
    """A whole number beyond 64 bits."""


def _check_numbers(value: Any, key: str) -> None:
    if isinstance(value, dict):
        for name, inside in value.items():
            _check_numbers(inside, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for inside in value:
            _check_numbers(inside, key)
    elif isinstance(value, int) and not -_MOST_NUMBER <= value < _MOST_NUMBER:
        raise _TooLong(f"{key} is a number of too many digits: {len(str(abs(value)))}")


def json_value(text: str | bytes) -> Any:
    """Return what JSON says.

    Raises:
        ValueError: it is no JSON, not UTF-8, nested too deeply, or has a number of thousands of digits.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def is_number(text: str) -> bool:
    """Return whether Python reads a text as a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True
