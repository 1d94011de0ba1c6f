"""A function of an effect from outside is tried where the effect is off, before machine code is made of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from exo_sim.errors import ModelError
from exo_sim.physics import external_effects_off, terms
from exo_sim.physics.declaration import Effect
from exo_sim.physics.external_effects import Source
from exo_sim.physics.external_effects_off import check_external_effects

DECLARED = """
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics import terms

EFFECT = Effect(
    name="mine", places=("cylinder",), family="{family}", question="Is it there?", says="It is there.",
    parameters=(Parameter("size", "kg/(s Pa)", 0.0, 1.0, (0.1, 0.2), "of mine", required=True),),
    cut="gas", reveals=("pressure_1",), mistaken_for=(), experiment="look", valid="always.", signature="one sees it",
    convention="as it is.", identification=Identification(forms=(("size",),)),
)

@terms.{term}.of(EFFECT)
def added({arguments}):
    return {returned}
"""
OUTWARD = {"family": "leak", "term": "OUTWARD_FLOW", "arguments": "p, here, there, world"}


def checked(folder: Path, patch: pytest.MonkeyPatch, **declared: str) -> None:
    (folder / "mine.py").write_text(DECLARED.format(**declared))
    source = Source(str(folder / "mine.py"), folder / "mine.py")
    for term in terms.TERMS:
        patch.setattr(term, "_functions", dict(term._functions))
    patch.setattr(external_effects_off, "sources", lambda: [source])
    assert isinstance(source.effect(), Effect)
    check_external_effects()


@pytest.mark.parametrize(
    ("returned", "says"),
    [
        ("p.size * here.pp", r"mine\.py, line 14: AttributeError: .* has no attribute .pp., in added of mine$"),
        ("p.sise * here.p", r"mine\.py, line 14: AttributeError: .*sise"),
        ("p.size * world.suply_pressure", r"mine\.py, line 14: AttributeError: .*suply_pressure"),
        ("'x'", r"mine\.py: ValueError: .*, in added of mine$"),
        ("1e-3", r"added of mine returns 0\.001 where all its parameters are zero: it must return 0$"),
        ("here.p / p.size - here.p / p.size", r"added of mine returns no number where all its parameters are zero"),
    ],
)
def test_a_slip_is_one_line_that_names_file_and_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, returned: str, says: str) -> None:
    with pytest.raises(ModelError) as caught:
        checked(tmp_path, monkeypatch, **OUTWARD, returned=returned)
    assert re.search(says, str(caught.value)) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("term", "family", "arguments", "returned"),
    [
        ("OUTWARD_FLOW", "leak", "p, here, there, world", "p.size * (here.p - there.p + world.supply_pressure - world.atmosphere)"),
        ("ACROSS_FLOW", "leak", "p, one, two, world", "p.size * (one.p - two.p) / world.r"),
        ("HEAT_FLOW", "wall", "p, here, world", "p.size * (here.wall - here.t) * world.ambient"),
        ("DRY_FRICTION", "friction", "p, motion", "p.size * motion.gauge_1"),
        ("DRY_EXCESS", "friction", "p, level, motion", "p.size * level * motion.bristle"),
        ("DAMPING", "friction", "p, motion", "p.size * abs(motion.v)"),
        ("SPRING_FORCE", "spring", "p, motion", "p.size * motion.x"),
    ],
)
def test_functions_of_every_place_are_called_as_the_simulation_calls_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, term: str, family: str, arguments: str, returned: str
) -> None:
    checked(tmp_path, monkeypatch, family=family, term=term, arguments=arguments, returned=returned)
    with pytest.raises(ModelError, match=r"takes|missing"):
        checked(tmp_path, monkeypatch, family=family, term=term, arguments="p", returned="0.0")
