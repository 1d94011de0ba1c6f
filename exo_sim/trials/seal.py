"""Seals: a truth that cannot be read or changed before it is opened, and verdicts that cannot be changed after.

The truth of every case is encrypted (Fernet) together with a nonce, and the SHA-256 of nonce and truth stands in the
manifest. The key is good for one opening: opening burns it, and writes into its place how far the verdicts had come,
so that a seal opened early is found out as soon as verdicts follow. Whoever is to diagnose blind must not hold the key.

Verdicts form a chain: each record carries the hash of the one before it and an Ed25519 signature. The signing key is
thrown away with the last verdict; what was signed cannot be signed again.
"""

from __future__ import annotations

import hashlib
import json
import secrets
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from exo_sim.errors import TrialError
from exo_sim.outputs import replacing

START = "0" * 64


def digest(data: bytes) -> str:
    """Return the SHA-256 of bytes in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return digest(path.read_bytes())


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
    except (InvalidToken, ValueError):
        raise TrialError(f"{name}: the seal does not open: wrong key, or the sealed truth was altered") from None
    if digest(plain) != commitment:
        raise TrialError(f"{name}: the sealed truth is not the one the manifest commits to; it was exchanged")
    return json.loads(plain)["truth"]


def write_key(path: Path, key: str) -> None:
    """Write the key of a trial for its owner's eyes only."""
    with replacing(path) as beside:
        beside.write_text(json.dumps({"schema": "exo-sim/seal-key/1", "key": key}) + "\n")
        beside.chmod(0o600)


def open_with(path: Path, verdict_head: str, verdict_count: int) -> str:
    """Return the key and burn it: its file then says at which verdict the seals were opened.

    Raises:
        TrialError: there is no key, it was burnt at another verdict, or it is not a key.
    """
    try:
        held = json.loads(path.read_text())
    except FileNotFoundError:
        raise TrialError(f"{path}: no such key; give --key FILE as written by trial make") from None
    except (json.JSONDecodeError, UnicodeDecodeError):
        raise TrialError(f"{path}: not a key of a trial") from None
    if not isinstance(held, dict) or "key" not in held:
        raise TrialError(f"{path}: not a key of a trial")
    opened = held.get("opened_at")
    if opened is None:
        held["opened_at"] = {"head": verdict_head, "count": verdict_count}
        with replacing(path) as beside:
            beside.write_text(json.dumps(held) + "\n")
            beside.chmod(0o600)
    elif opened["head"] != verdict_head:
        raise TrialError(
            f"{path}: the seals were opened early, after {opened['count']} verdicts; {verdict_count} are there now, "
            "and no figure can be drawn from them"
        )
    return held["key"]


class Ledger:
    """The chain of verdicts of one trial, one JSON record a line.

    Args:
        path: The ledger file; made with the first verdict.
        signing: Where the signing key lives until the last verdict.
    """

    def __init__(self, path: Path, signing: Path) -> None:
        self.path = path
        self._signing = signing

    def records(self) -> list[dict[str, Any]]:
        """Return all records as they stand, unchecked."""
        if not self.path.exists():
            return []
        try:
            return [json.loads(line) for line in self.path.read_text().splitlines() if line]
        except json.JSONDecodeError:
            raise TrialError(f"{self.path}: a verdict is not JSON; the ledger was altered") from None

    def head(self) -> str:
        """Return the hash of the last record."""
        records = self.records()
        return records[-1]["hash"] if records else START

    def append(self, verdict: Mapping[str, Any]) -> dict[str, Any]:
        """Sign a verdict and add it.

        Raises:
            TrialError: the signing key is gone: the ledger is closed.
        """
        from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

        records = self.records()
        if not self._signing.exists():
            if records:
                raise TrialError(f"{self.path}: closed; its signing key was thrown away with the last verdict")
            self._signing.parent.mkdir(parents=True, exist_ok=True)
            self._signing.write_text(Ed25519PrivateKey.generate().private_bytes_raw().hex())
            self._signing.chmod(0o600)
        key = Ed25519PrivateKey.from_private_bytes(bytes.fromhex(self._signing.read_text()))
        body = {
            **verdict,
            "number": len(records) + 1,
            "previous": records[-1]["hash"] if records else START,
            "signer": key.public_key().public_bytes_raw().hex(),
        }
        plain = canonical(body)
        record = {**body, "hash": digest(plain), "signature": key.sign(plain).hex()}
        with self.path.open("a") as out:
            out.write(json.dumps(record, sort_keys=True) + "\n")
        return record

    def close(self) -> None:
        """Throw the signing key away."""
        self._signing.unlink(missing_ok=True)

    def check(self, expected: Sequence[str]) -> list[dict[str, Any]]:
        """Return the verdicts, one for each expected case, or say what was done to them.

        Raises:
            TrialError: a verdict was altered, removed, added twice, signed by another key, or is still to come.
        """
        from cryptography.exceptions import InvalidSignature
        from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

        previous, signer, seen = START, None, []
        records = self.records()
        for number, record in enumerate(records, 1):
            body = {key: value for key, value in record.items() if key not in ("hash", "signature")}
            where = f"{self.path}, line {number}"
            if digest(canonical(body)) != record.get("hash") or body.get("previous") != previous:
                raise TrialError(f"{where}: this verdict ({body.get('case')}) or one before it was altered")
            signer = signer or body["signer"]
            try:
                if body["signer"] != signer:
                    raise InvalidSignature
                Ed25519PublicKey.from_public_bytes(bytes.fromhex(signer)).verify(
                    bytes.fromhex(record["signature"]), canonical(body)
                )
            except (InvalidSignature, ValueError, KeyError):
                raise TrialError(f"{where}: this verdict ({body.get('case')}) bears no valid signature") from None
            previous = record["hash"]
            seen.append(body["case"])
        double = {case for case in seen if seen.count(case) > 1}
        if double:
            raise TrialError(f"{self.path}: more than one verdict on {min(double)}; one submission a case")
        missing = sorted(set(expected) - set(seen))
        if missing:
            raise TrialError(
                f"{self.path}: {len(missing)} verdicts are still to come, the first on {missing[0]}; trial run first"
            )
        strange = sorted(set(seen) - set(expected))
        if strange:
            raise TrialError(f"{self.path}: a verdict on {strange[0]}, which is no case of this trial")
        return records
