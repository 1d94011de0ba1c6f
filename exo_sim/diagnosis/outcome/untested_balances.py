"""Balances of which the time that errors are reported of tests nothing: a recording that ends at rest."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from exo_sim.diagnosis.findings import Subsystem
from exo_sim.diagnosis.policy.validation import LEAST_INFLUENCE
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel

_UNTESTED = (
    "{balance} of {name}: in the time that errors are reported of no prediction changes with what was found there; "
    "a recording that ends in motion would test it"
)


def untested_balances(
    results: Sequence[SubsystemResult[SubsystemModel]], compared: Collection[tuple[Subsystem, str]], influence: Mapping[str, float]
) -> list[str]:
    """Return a remark for every balance with findings without any of which predictions of the test time would differ.

    Args:
        results: Of all subsystems.
        compared: Those that have rows in the test time.
        influence: By key, how much predictions of the test time change with a finding [units of the noise].
    """
    found = []
    for one in results:
        changes = [influence[finding.key] for finding in one.findings if finding.key in influence]
        if one.findings and (one.key not in compared or (changes and max(changes) <= LEAST_INFLUENCE)):
            found.append(_UNTESTED.format(balance=one.model.balance, name=one.name))
    return found
