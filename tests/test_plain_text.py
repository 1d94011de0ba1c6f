"""Results as text: JSON that every reader takes, and tables whose columns stand under each other."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from exo_sim.plain_text import json_text, table


def test_json_has_no_nan_and_takes_numpy_and_paths() -> None:
    data = {"a": np.arange(2), "b": np.float64("nan"), "c": Path("x/y"), 4: (1, float("inf")), "d": {"e": np.bool_(True)}}
    assert json.loads(json_text(data)) == {"a": [0, 1], "b": None, "c": "x/y", "4": [1, None], "d": {"e": True}}


def test_numbers_stand_to_the_right_and_words_to_the_left() -> None:
    assert table([("bore", "5"), ("a", "12.5")], ("what", "mm")) == "what    mm\nbore     5\na     12.5"
    assert table([]) == "" and table([], ("what", "mm")) == "what  mm"
