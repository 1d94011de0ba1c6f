"""Verdicts that cannot be changed after.

They form a chain: each record carries the hash of the one before it and an Ed25519 signature. The signing key is thrown away with
the last verdict; what was signed cannot be signed again. A record that a full disk or a kill tore off is no verdict: the next one
takes its place.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from exo_sim.errors import TrialError
from exo_sim.inputs import json_value
from exo_sim.outputs import explained, replacing
from exo_sim.trials.seal import canonical, digest, stored

START = "0" * 64
_NUMBERS = ("wall_s", "cpu_s", "peak_bytes")
_TEXTS = ("case", "previous", "signer", "hash", "signature")


class VerdictChain:
    """The chain of verdicts of one trial, one JSON record a line.

    Args:
        path: The ledger file; made with the first verdict.
        signing: Where the signing key lives until the last verdict.
    """

    def __init__(self, path: Path, signing: Path) -> None:
        self.path = path
        self._signing = signing

    def records(self) -> list[dict[str, Any]]:
        """Return all records as they stand, unchecked.

        Raises:
            TrialError: a line is no verdict.
        """
        return self._standing()[0]

    def _standing(self) -> tuple[list[dict[str, Any]], int]:
        """Return the records and how many bytes they take; a torn line at the end is left out."""
        if not self.path.exists():
            return [], 0
        raw = stored(self.path)
        records, good = [], 0
        for number, line in enumerate(raw.splitlines(keepends=True), 1):
            try:
                record = json_value(line)
                whole = isinstance(record, dict) and all(isinstance(record.get(key), str) for key in _TEXTS)
                canonical(record)
            except (TypeError, ValueError):
                whole = False
            if whole and line.endswith(b"\n"):
                records.append(record)
            elif line.strip():
                if good + len(line) == len(raw) and not line.endswith(b"\n"):
                    break
                raise TrialError(f"{self.path}, line {number}: not a verdict; the ledger was altered")
            good += len(line)
        return records, good

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

        records, good = self._standing()
        key = Ed25519PrivateKey.from_private_bytes(self._signing_key(bool(records)))
        body = {
            **verdict,
            "number": len(records) + 1,
            "previous": records[-1]["hash"] if records else START,
            "signer": key.public_key().public_bytes_raw().hex(),
        }
        plain = canonical(body)
        record = {**body, "hash": digest(plain), "signature": key.sign(plain).hex()}
        with explained(self.path, self.path), self.path.open("ab") as out:
            out.truncate(good)
            try:
                out.write(json.dumps(record, sort_keys=True).encode() + b"\n")
                out.flush()
                os.fsync(out.fileno())
            except OSError:
                out.truncate(good)
                raise
        return record

    def _signing_key(self, begun: bool) -> bytes:
        """Return the signing key, made with the first verdict."""
        from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

        if not self._signing.exists():
            if begun:
                raise TrialError(f"{self.path}: closed; its signing key was thrown away with the last verdict")
            with replacing(self._signing) as beside:
                beside.touch(mode=0o600)
                beside.write_text(Ed25519PrivateKey.generate().private_bytes_raw().hex())
        try:
            key = bytes.fromhex(stored(self._signing).decode("ascii"))
        except ValueError:
            key = b""
        if len(key) != 32:
            raise TrialError(f"{self._signing}: not a signing key; the trial cannot go on without it")
        return key

    def close(self) -> None:
        """Throw the signing key away."""
        self._signing.unlink(missing_ok=True)

    def checked(self) -> list[dict[str, Any]]:
        """Return all records, each in its place in the chain and signed by the one key.

        Raises:
            TrialError: a verdict was altered, removed, or signed by another key.
        """
        from cryptography.exceptions import InvalidSignature
        from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

        previous, signer = START, None
        records = self.records()
        for number, record in enumerate(records, 1):
            body = {key: value for key, value in record.items() if key not in ("hash", "signature")}
            where = f"{self.path}, line {number}"
            if digest(canonical(body)) != record["hash"] or body["previous"] != previous:
                raise TrialError(f"{where}: this verdict ({body['case']}) or one before it was altered")
            signer = signer or body["signer"]
            try:
                if body["signer"] != signer:
                    raise InvalidSignature
                Ed25519PublicKey.from_public_bytes(bytes.fromhex(signer)).verify(
                    bytes.fromhex(record["signature"]), canonical(body)
                )
            except (InvalidSignature, ValueError):
                raise TrialError(f"{where}: this verdict ({body['case']}) bears no valid signature") from None
            previous = record["hash"]
        return records

    def check(self, expected: Sequence[str]) -> list[dict[str, Any]]:
        """Return the verdicts, one for each expected case, or say what was done to them.

        Raises:
            TrialError: as `checked`, or a verdict was added twice, or is still to come.
        """
        records = self.checked()
        seen = [record["case"] for record in records]
        double = {case for case in seen if seen.count(case) > 1}
        if double:
            raise TrialError(f"{self.path}: more than one verdict on {min(double)}; one submission a case")
        missing = sorted(set(expected) - set(seen))
        if missing and records and not self._signing.exists():
            raise TrialError(
                f"{self.path}: closed, and it lost {len(missing)} verdicts since, the first on {missing[0]}: bring back a copy of it"
            )
        if missing:
            raise TrialError(
                f"{self.path}: {len(missing)} verdicts are still to come, the first on {missing[0]}; trial run first"
            )
        strange = sorted(set(seen) - set(expected))
        if strange:
            raise TrialError(f"{self.path}: a verdict on {strange[0]}, which is no case of this trial")
        for number, record in enumerate(records, 1):
            numbers = [record.get(key) for key in _NUMBERS]
            named = isinstance(record.get("tool"), str) and isinstance(record.get("diagnosis"), str | None)
            if not named or not all(isinstance(each, int | float) for each in numbers):
                raise TrialError(f"{self.path}, line {number}: this verdict ({record['case']}) says not all that a verdict says")
        return records
