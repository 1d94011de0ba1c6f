"""What the shares of a score count, in the words of terminal and page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

#: By figure of a score, what is counted; sizes are in units of the size from which a likelihood-ratio test finds it in this recording.
SHARES = {
    "answered": "cases that got an answer",
    "located_right": "the first place that is reported is one where something hidden acts",
    "top_1": "the likeliest name that is given is one of the hidden",
    "class_right": "every hidden effect is named, or one that this recording cannot tell from it",
    "exact_set": "exactly the hidden effects are named, no more and no less",
    "class_exact_set": "as before, effects that this recording cannot tell apart counted as one",
    "exact_set_from_four_limits": "exactly the hidden effects are named, where each is four times its detection limit or more",
    "precision": "names given that are right",
    "recall": "hidden effects that are named",
    "single_at_ten_limits": "one hidden effect, at ten times its detection limit: exactly it is named",
    "false_alarms": "something is named where nothing is hidden (false alarms)",
    "confidently_wrong": "a wrong name is given with confidence",
    "outside_called_unknown": 'hidden physics that has no name in the tool: called "unknown"',
    "outside_confidently_misnamed": "hidden physics that has no name in the tool: given a wrong name with confidence",
    "held_out_error_near_oracle": "error on held-out time at most 1.1 times that of the same tool with the truth in its rig (oracle)",
}
#: The same of one cell, where nothing is hidden in one also how often that is seen.
OF_CELL = {**SHARES, "right": "nothing is named, and nothing is hidden"}


def shares(figures: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield what is counted, and the share with its bounds, of every figure of which there are cases."""
    for key, words in SHARES.items():
        if figures[key]["of"]:
            yield words, figures[key]
    if figures["parameters"]["coverage"]["of"]:
        yield "95 % intervals of parameters that hold the true value", figures["parameters"]["coverage"]
