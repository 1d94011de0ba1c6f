"""Seals: a truth that cannot be read or changed before it is opened, and verdicts that cannot be changed after.

The truth of every case is encrypted (Fernet) together with a nonce, and the SHA-256 of nonce and truth stands in the
manifest. The key is good for one opening: opening burns it, and writes into its place how far the verdicts had come,
so that a seal opened early is found out as soon as verdicts follow. Whoever is to diagnose blind must not hold the key.
"""

from __future__ import annotations

import hashlib
import json
import secrets
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from exo_sim.errors import TrialError
from exo_sim.inputs import bytes_of
from exo_sim.outputs import replacing
from exo_sim.trials.json_file import read_json


def digest(data: bytes) -> str:
    """Return the SHA-256 of bytes in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def stored(path: Path) -> bytes:
    """Return what a file of a trial holds.

    Raises:
        TrialError: a pipe, a device or a folder stands in its place, which would never end.
    """
    try:
        return bytes_of(path)
    except ValueError as error:
        raise TrialError(f"{path}: {error}") from None


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file of a trial.

    Raises:
        TrialError: as `stored`.
    """
    return digest(stored(path))


def canonical(record: Mapping[str, Any]) -> bytes:
    """Return the one way to write a record that is hashed or signed."""
    return json.dumps(record, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def new_key() -> str:
    """Return a key for `seal`."""
    from cryptography.fernet import Fernet

    return Fernet.generate_key().decode()


def seal(truth: Mapping[str, Any], key: str) -> tuple[bytes, str]:
    """Return (what to store, commitment to publish) for a truth."""
    from cryptography.fernet import Fernet

    plain = canonical({"nonce": secrets.token_hex(32), "truth": truth})
    return Fernet(key.encode()).encrypt(plain), digest(plain)


def unseal(stored: bytes, commitment: str, key: str, name: str) -> dict[str, Any]:
    """Return the truth.

    Raises:
        TrialError: the key is another one, or the truth is not the one that was committed to.
    """
    from cryptography.fernet import Fernet, InvalidToken

    try:
        plain = Fernet(key.encode()).decrypt(stored)
    except (InvalidToken, ValueError, TypeError):
        raise TrialError(f"{name}: the seal does not open: wrong key, or the sealed truth was altered") from None
    if digest(plain) != commitment:
        raise TrialError(f"{name}: the sealed truth is not the one the manifest commits to; it was exchanged")
    return json.loads(plain)["truth"]


def belongs_to(manifest: Mapping[str, Any]) -> str:
    """Return what a key holds of the manifest whose seals it opens."""
    return digest(canonical(manifest))


def write_key(path: Path, key: str, manifest: Mapping[str, Any]) -> None:
    """Write the key of a trial for its owner's eyes only."""
    _write(path, {"schema": "exo-sim/seal-key/1", "key": key, "manifest": belongs_to(manifest)})


def open_with(
    path: Path, manifest: Mapping[str, Any], verdict_head: str, verdict_count: int, try_on: Callable[[str], None]
) -> None:
    """Try a key on the seals and burn it: its file then says at which verdict they were opened.

    A key that is none, is another trial's or does not open every seal stays as it is.

    Args:
        path: Of the key.
        manifest: Of the trial.
        verdict_head, verdict_count: The last verdict's hash, and how many there are.
        try_on: Opens every seal in memory with the key it is given.

    Raises:
        TrialError: there is no key, it was burnt at another verdict, it is not a key, or what `try_on` raises.
    """
    held = _read(path)
    if held.get("manifest", belongs_to(manifest)) != belongs_to(manifest):
        raise TrialError(f"{path}: the key of another trial; give --key FILE as written with this one")
    opened = held.get("opened_at")
    if opened is not None and opened["head"] != verdict_head:
        raise TrialError(
            f"{path}: the seals were opened early, after {opened['count']} verdicts; {verdict_count} are there now, "
            "and no figure can be drawn from them"
        )
    try_on(held["key"])
    if opened is None:
        _write(path, held | {"opened_at": {"head": verdict_head, "count": verdict_count}})


def _write(path: Path, held: Mapping[str, Any]) -> None:
    with replacing(path) as beside:
        beside.touch(mode=0o600)
        beside.write_text(json.dumps(held) + "\n")


def _read(path: Path) -> dict[str, Any]:
    try:
        held = read_json(path)
    except FileNotFoundError:
        raise TrialError(f"{path}: no such key; give --key FILE as written by trial make") from None
    except ValueError:
        raise TrialError(f"{path}: not a key of a trial") from None
    opened = held.get("opened_at") if isinstance(held, dict) else None
    good = isinstance(held, dict) and isinstance(held.get("key"), str) and isinstance(held.get("manifest", ""), str)
    if not good or not (opened is None or (isinstance(opened, dict) and {"head", "count"} <= set(opened))):
        raise TrialError(f"{path}: not a key of a trial")
    return held
