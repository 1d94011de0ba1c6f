"""Writing results: beside first, then renamed into place, so that nothing half-written is ever found under its name."""

from __future__ import annotations

import errno
import hashlib
import os
import re
import socket
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO

from exo_sim.errors import OutputError

#: Bytes of a file's name that its partial file keeps; file systems allow 255 in all.
_LONGEST_STEM = 120


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a path to write to; when the block ends well, the file there takes the place of `path`.

    The folder is made where it is missing. When the block ends in an error or an interrupt, what was at `path` stays as
    it was. What a process that was killed left behind of the same file is taken away.
    The path given has the ending of `path`. A device or pipe is written straight.

    Raises:
        OutputError: the folder or the file cannot be written, or the disk is full.
    """
    with replacing_all(path) as (beside,):
        yield beside


@contextmanager
def replacing_all(*paths: str | Path, growing: Mapping[Path, Path] | None = None) -> Iterator[tuple[Path, ...]]:
    """As `replacing`, for files that belong together: all of them appear, or none.

    Args:
        paths: The files.
        growing: Names in the same folders for those that are of use before they are whole; there they stay after a kill.

    Raises:
        OutputError: as `replacing`.
    """
    targets = [Path(path) for path in paths]
    with ExitStack() as stack:
        besides = tuple(stack.enter_context(_beside(path, (growing or {}).get(path))) for path in targets)
        yield besides
        _take_their_places([(path, beside) for path, beside in zip(targets, besides) if beside != path])


@contextmanager
def _beside(path: Path, named: Path | None) -> Iterator[Path]:
    if path.is_dir():
        raise OutputError(f'cannot write "{path}": it is a folder; name a file')
    if path.exists() and not path.is_file():
        with explained(path, path):
            yield path
        return
    target = path.resolve()  # a link keeps pointing where it points
    beside = target.with_name(named.name if named else _partial(target))
    with explained(path, beside):
        target.parent.mkdir(parents=True, exist_ok=True)
        _sweep(target)
        try:
            yield beside
        finally:
            beside.unlink(missing_ok=True)


def _take_their_places(pairs: list[tuple[Path, Path]]) -> None:
    """Rename each file beside to its target; where one cannot be, put back what stood at those before it."""
    new: list[Path] = []
    former: dict[Path, Path] = {}
    try:
        for path, beside in pairs:
            target, kept = path.resolve(), beside.with_name(f"{beside.name}.former")
            with explained(path, beside):
                if not target.exists():
                    new.append(target)
                elif len(pairs) > 1:
                    with suppress(OSError):  # a file system without links: what stands there is replaced for good
                        os.link(target, kept)
                        former[target] = kept
                beside.replace(target)
    except BaseException:
        for target in new:
            target.unlink(missing_ok=True)
        for target, kept in former.items():
            kept.replace(target)
        raise
    finally:
        for kept in former.values():
            kept.unlink(missing_ok=True)


def check_writable(folder: str | Path) -> None:
    """Find out now, before long work, whether files can be written into a folder, or whether it could be made.

    Raises:
        OutputError: they cannot.
    """
    folder = Path(folder)
    if folder.exists() and not folder.is_dir():
        raise OutputError(f'cannot write into "{folder}": it is a file; name a folder')
    there = next((each for each in (folder, *folder.absolute().parents) if each.exists()), folder)
    probe = there / f".{_mark()}.probe"
    with explained(folder, probe):
        try:
            probe.write_bytes(b"\0")
        finally:
            with suppress(OSError):
                probe.unlink(missing_ok=True)


@contextmanager
def alone_in(folder: Path, doing: str) -> Iterator[None]:
    """Keep other processes from doing the same in a folder for as long as the block lasts, also where it is killed.

    Args:
        folder: It is made where it is missing.
        doing: What is done, one word: "size".

    Raises:
        OutputError: another process is at it, or the folder cannot be written.
    """
    lock = folder / f".{doing}.lock"
    with explained(folder, lock):
        folder.mkdir(parents=True, exist_ok=True)
        file = _locked(lock)
    if file is None:
        raise OutputError(f'another {doing} is at work in "{folder}"; wait for it, or name another folder')
    with file:
        try:
            yield
        finally:
            with suppress(OSError):
                lock.unlink()


def _locked(lock: Path) -> IO[bytes] | None:
    """Return the file that is locked until it is closed, also by the end of its process; None where another holds it."""
    while True:
        file = lock.open("ab")
        try:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except ImportError:  # Windows
            return file
        except OSError as error:
            if error.errno in (errno.EAGAIN, errno.EACCES):
                file.close()
                return None
            return file  # a file system without locks: go on as if alone
        with suppress(FileNotFoundError):
            if lock.stat().st_ino == os.fstat(file.fileno()).st_ino:
                return file
        file.close()  # who held it took it away in between


def _mark() -> str:
    """Return what tells this process from all others that may write into the same folder."""
    return f"{os.getpid()}@{_host()}"


def _host() -> str:
    return re.sub(r"[^A-Za-z0-9-]", "-", socket.gethostname())[:40]


def _partial(target: Path) -> str:
    return f".{_short(target.stem)}.{_mark()}.partial{target.suffix}"


def _short(stem: str) -> str:
    raw = os.fsencode(stem)
    if len(raw) <= _LONGEST_STEM:
        return stem
    return f"{os.fsdecode(raw[: _LONGEST_STEM - 17])}-{hashlib.sha256(raw).hexdigest()[:16]}"


def _sweep(target: Path) -> None:
    """Take away what processes of this machine that are no more left behind of a file."""
    left = re.compile(rf"\.{re.escape(_short(target.stem))}\.(\d+)(?:@{re.escape(_host())})?\.partial{re.escape(target.suffix)}(\.former)?")
    for entry in target.parent.iterdir():
        found = left.fullmatch(entry.name)
        if found and not _is_alive(int(found.group(1))):
            with suppress(OSError):
                entry.unlink()


def _is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        return True
    return True


@contextmanager
def explained(path: Path, beside: Path) -> Iterator[None]:
    """Turn a failure to write `beside` into one that says that `path` cannot be written."""
    try:
        yield
    except OSError as error:
        named = Path(os.fsdecode(error.filename)) if isinstance(error.filename, str | bytes) else None
        if named is not None and named not in (path, beside, *path.resolve().parents):
            raise  # something else that could not be read
        if error.errno == errno.ENOSPC:
            raise OutputError(f'cannot write "{path}": the disk is full; free some space or write elsewhere') from error
        reason = error.strerror or str(error).split("\n", 1)[0] or type(error).__name__
        raise OutputError(f'cannot write "{path}": {reason}; write elsewhere') from error
