"""Cases that are kept: what once broke a promise, and the shortest case of each kind of outcome, one line of JSON each."""

from __future__ import annotations

import json
from pathlib import Path

from fuzzing.campaign import Campaign

PATH = Path(__file__).with_name("corpus.jsonl")
#: Characters of the longest case of a kind that is kept; those that broke a promise are kept whatever their length.
LONGEST = 400


def lines() -> list[str]:
    """Return the cases."""
    return PATH.read_text().splitlines() if PATH.exists() else []


def keep(campaign: Campaign) -> None:
    """Add what a campaign found, and one case of each kind of outcome that the corpus has not."""
    held = [json.loads(line) for line in lines()]
    seen, kinds = {json.dumps([one["words"], one["edits"]]) for one in held}, {one.get("kind") for one in held}
    for line in campaign.found.values():
        one = json.loads(line)
        if json.dumps([one["words"], one["edits"]]) not in seen:
            held.append({key: value for key, value in one.items() if key != "said"})
    for kind, line in campaign.kinds.items():
        if kind not in kinds and len(line) <= LONGEST:
            held.append({**json.loads(line), "kind": kind})
    PATH.write_text("".join(json.dumps(one) + "\n" for one in sorted(held, key=lambda one: (one["words"], one.get("kind", "")))))
