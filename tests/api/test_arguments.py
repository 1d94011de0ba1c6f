"""What functions of the API take: a payload that nobody says is the rig's own."""

from __future__ import annotations

from dataclasses import replace

import pytest

import exo_sim as exo
from exo_sim.api.arguments import USUAL_PAYLOAD, payload_of
from exo_sim.errors import ScenarioError


def test_the_payload_is_what_is_asked_for_else_the_rigs_else_the_usual_one() -> None:
    plain = exo.Rig.included("exo")
    diagnosed = replace(plain, body_masses={"payload": 40.0, "torso": 11.0})
    assert (payload_of(plain, None), payload_of(diagnosed, None), payload_of(diagnosed, "20 kg")) == (USUAL_PAYLOAD, 40.0, 20.0)
    with pytest.raises(ScenarioError, match="payload = -1"):
        payload_of(plain, -1.0)
