"""What the check may take back, and what the proof may complain of."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from exo_sim.diagnosis import checking
from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.examining import Doubts, Examined
from exo_sim.diagnosis.judging import Judged
from exo_sim.diagnosis.motion_problem import MotionProblem
from exo_sim.diagnosis.proof import Missed, Proof
from exo_sim.diagnosis.result import Finding, SignalFit
from exo_sim.diagnosis.split import Split

LEAK, SPRING = ("piston_leakage", "piston"), ("return_spring", "piston")


def judged(*names: tuple[str, str], nameless: bool = False, cut: str = "gas") -> Judged:
    findings = [Finding(name, where, "missing_physics", "", {}, 12.0, 0.0) for name, where in names]
    return Judged(cut, "piston", None, None, None, (), None, nameless, findings, [], [])  # type: ignore[arg-type]


def proof(drops: dict[tuple[str, str], float], felt: float = 1.0, **more: Any) -> Proof:
    keys = {f"{name}@{where}": drop for (name, where), drop in drops.items()}
    return Proof({"piston.pressure_1": SignalFit("Pa", 2.0, 1.0, 1.0)}, keys, felt=dict.fromkeys(keys, felt), **more)


def examined(one: Judged, check: Proof | None, doubted: Doubts | None = None, last: Proof | None = None) -> Examined:
    return Examined(None, Split({}), [one], [], last or proof({}), check, doubted or {})  # type: ignore[arg-type]


def rounds(monkeypatch: pytest.MonkeyPatch, answers: list[tuple[tuple[str, str], ...]], check: Proof) -> tuple[Examined, list[Doubts]]:
    """Return what is believed in the end when the rounds answer so, and what each round was told to doubt."""
    asked: list[Doubts] = []

    def examine(case: Any, parts: Split, doubted: Doubts, pool: Any, say: Any) -> Examined:
        asked.append(dict(doubted))
        return examined(judged(*answers[min(len(asked), len(answers)) - 1]), check, doubted)

    class Copied:
        def copy(self) -> Copied:
            return self

    monkeypatch.setattr(checking, "examine", examine)
    case: Case = Copied()  # type: ignore[assignment]
    return checking._checked(case, Split({}), None, print), asked  # type: ignore[arg-type]


def test_a_name_that_the_check_bears_out_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    end, asked = rounds(monkeypatch, [(LEAK,)], proof({LEAK: 0.6}))
    assert [finding.name for finding in end.judged[0].findings] == ["piston_leakage"] and asked == [{}]


def test_a_name_that_it_does_not_bear_out_is_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    end, asked = rounds(monkeypatch, [(LEAK, SPRING), (LEAK,)], proof({LEAK: 0.6, SPRING: 0.01}))
    assert [set(doubts) for doubts in asked] == [set(), {SPRING}]
    assert [finding.name for finding in end.judged[0].findings] == ["piston_leakage"]
    assert "no more than 1 %" in end.doubted[SPRING]


def test_in_the_last_round_doubted_names_are_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    names = [((f"effect_{i}", "piston"),) for i in range(checking.MOST_DOUBTS)]
    end, asked = rounds(monkeypatch, names, proof({name: -0.3 for (name,) in names}))
    assert len(asked) == checking.MOST_DOUBTS and end.judged[0].findings == []
    assert len(end.doubted) == checking.MOST_DOUBTS


@pytest.mark.parametrize("check", [None, proof({}), proof({SPRING: 0.0}, felt=0.1)], ids=["no check", "not compared", "not felt"])
def test_what_was_not_tested_is_not_doubted(monkeypatch: pytest.MonkeyPatch, check: Proof | None) -> None:
    end, asked = rounds(monkeypatch, [(SPRING,)], check)  # type: ignore[arg-type]
    assert [finding.name for finding in end.judged[0].findings] == ["return_spring"] and len(asked) == 1


def test_a_check_in_which_nothing_could_be_compared_never_wins() -> None:
    assert examined(judged(), Proof()).surprise == math.inf
    assert examined(judged(), None).surprise == 0.0


@pytest.mark.parametrize(
    ("ratio", "sick", "nameless", "count"),
    [(2.0, True, False, 0), (6.0, False, False, 0), (6.0, True, False, 1), (12.0, False, False, 1), (12.0, True, True, 0)],
)
def test_what_only_the_proof_shows_is_said(ratio: float, sick: bool, nameless: bool, count: int) -> None:
    missed = proof({}, missed={("gas", "piston"): Missed(ratio, 1.0, ratio / (2.0 if sick else 0.5), 40.0)})
    found = checking.unmet(examined(judged(nameless=nameless), None, last=missed))
    assert len(found) == count
    assert all(finding.kind == "unknown" and f"{ratio:.0f} times" in finding.says and finding.log10_odds == 40.0 for finding in found)


@pytest.mark.parametrize(("check", "last", "count"), [(True, True, 1), (False, True, 0), (True, False, 0)])
def test_a_fit_that_looks_healthy_does_not_hold_where_check_and_proof_are_sick(check: bool, last: bool, count: int) -> None:
    def missed(sick: bool, excess: float = 1.3) -> Proof:
        return proof({}, missed={("gas", "piston"): Missed(5.0 * (excess if sick else 0.9), 4.5, 5.0, 13.0)})

    found = checking.unmet(examined(judged(), missed(check), last=missed(last)))
    assert [finding.kind for finding in found] == ["unknown"] * count
    assert all("by more than any healthy machine" in finding.says for finding in found)
    assert checking.unmet(examined(judged(), None, last=missed(True))) == []
    assert checking.unmet(examined(judged(), missed(True), last=missed(True, 1.05))) == []


def test_what_an_unmeasured_chamber_may_do_is_left_open() -> None:
    one = judged(cut="motion")
    one.problem = MotionProblem.__new__(MotionProblem)
    one.problem.runs = [SimpleNamespace(filled_in=True)]  # type: ignore[list-item]
    said = examined(one, None, last=proof({}, missed={("motion", "piston"): Missed(12.0, 1.0, 6.0, 40.0)}))
    case = replace(said, case=SimpleNamespace(open=[]))  # type: ignore[arg-type]
    assert checking.unmet(case) == []
    assert one.unclosed and len(case.case.open) == 1
