"""The improved rig reads as a diff against the owner's file."""

from __future__ import annotations

import difflib
from pathlib import Path

import pytest

from exo_sim.errors import RigError
from exo_sim.physics.declaration import Effect, declared
from exo_sim.rig import Correction, EffectEntry, EffectSetting, JointFactors, improved, parse, read

EXTRA = """
[effects.coulomb_friction.piston]   # measured in May
force = "10 N"                      # by hand

[effects.viscous_friction]
piston = {coefficient = "40 N s/m"} # from the data sheet
"""


@pytest.fixture
def bench(repository: Path) -> Path:
    return repository / "assets" / "bench.toml"


def changed(before: str, after: str) -> tuple[list[str], list[str]]:
    """Return the lines removed and added."""
    lines = list(difflib.ndiff(before.splitlines(), after.splitlines()))
    return [line[2:] for line in lines if line[0] == "-"], [line[2:] for line in lines if line[0] == "+"]


def test_nothing_found_changes_nothing(bench: Path) -> None:
    rig = read(bench)
    assert improved(rig, [], [], bench.parent) == rig.text


def test_a_corrected_number_stands_where_it_stood_in_its_own_unit(bench: Path) -> None:
    rig = read(bench)
    area = Correction(("cylinders", "piston", "valve", "area"), 4.62e-6, "m^2", (4.58e-6, 4.66e-6))
    mass = Correction(("bodies", "load", "mass"), 10.53, "kg", (10.49, 10.57), believed=10.0)
    text = improved(rig, [], [area, mass], bench.parent)
    removed, added = changed(rig.text, text)
    assert removed == ['area = "5 mm^2"']
    assert added == [
        'area = "4.62 mm^2"  # was "5 mm^2"; 95 %: 4.58 to 4.66 mm^2',
        "",
        "[bodies.load]",
        'mass = "10.53 kg"  # was "10 kg"; 95 %: 10.49 to 10.57 kg',
    ]
    again = parse(text, bench)
    assert again.cylinders["piston"].valve_area == pytest.approx(4.62e-6)
    assert again.body_masses == {"load": 10.53}


def test_a_number_that_is_no_finding_says_so(bench: Path) -> None:
    area = Correction(("cylinders", "piston", "valve", "area"), 4.97e-6, "m^2", note="refitted")
    _, added = changed(read(bench).text, improved(read(bench), [], [area], bench.parent))
    assert added == ['area = "4.97 mm^2"  # was "5 mm^2"; refitted']


def test_a_damping_believed_too_large_is_written_as_a_factor(bench: Path) -> None:
    damping = Correction(("joints", "slide", "damping_factor"), 0.713, "1", (0.707, 0.72), believed=1.0)
    text = improved(read(bench), [], [damping], bench.parent)
    assert text.endswith("[joints.slide]\ndamping_factor = 0.713  # was 1.0; 95 %: 0.707 to 0.72\n")
    again = parse(text, bench)
    assert again.joint_factors == {"slide": JointFactors(damping=0.713)}
    twice = improved(again, [], [Correction(damping.key, 0.5, "1")], bench.parent)
    inertia = Correction(("joints", "slide", "inertia_factor"), 1.01, "1")
    assert parse(twice, bench).joint_factors == {"slide": JointFactors(damping=0.5)}
    assert parse(improved(again, [], [inertia], bench.parent), bench).joint_factors == {"slide": JointFactors(0.713, 1.01)}
    assert parse(improved(read(bench), [], [inertia], bench.parent), bench).joint_factors == {"slide": JointFactors(inertia=1.01)}


def test_a_new_effect_is_a_new_table_at_the_end(bench: Path) -> None:
    rig = read(bench)
    leak = EffectEntry(
        EffectSetting("piston_leakage", "piston", {"area": 3.0e-8}), {"area": (2.9e-8, 3.1e-8)}, "Gas leaks past the piston."
    )
    text = improved(rig, [leak], [], bench.parent)
    assert text == rig.text + (
        "\n# Gas leaks past the piston.\n[effects.piston_leakage.piston]\n"
        'area = "0.03 mm^2"  # 95 %: 0.029 to 0.031 mm^2\n'
    )


def test_an_effect_that_is_there_is_set_anew_in_place(bench: Path) -> None:
    rig = parse(bench.read_text() + EXTRA, bench)
    found = [
        EffectEntry(EffectSetting("coulomb_friction", "piston", {"force": 12.5}), {"force": (12.1, 12.9)}),
        EffectEntry(EffectSetting("viscous_friction", "piston", {"coefficient": 44.0}), {"coefficient": (42.0, 46.0)}),
    ]
    text = improved(rig, found, [], bench.parent)
    _, added = changed(rig.text, text)
    assert len(added) == 2
    assert 'force = "12.5 N"' in added[0] and 'was "10 N"; 95 %: 12.1 to 12.9 N' in added[0] and "by hand" in added[0]
    assert 'piston = {coefficient = "44 N s/m"}' in added[1] and 'coefficient was "40 N s/m"' in added[1]
    assert parse(text, bench).effect("viscous_friction", "piston").parameters == {"coefficient": 44.0}  # type: ignore[union-attr]


@pytest.mark.parametrize("key", ["force", "torque"])
def test_friction_of_what_turns_keeps_the_key_that_the_owner_took(bench: Path, key: str) -> None:
    rig = parse(f'{bench.read_text()}\n[effects.coulomb_friction.elbow]\n{key} = "1.6 N m"\n', bench)
    found = EffectEntry(EffectSetting("coulomb_friction", "elbow", {"force": 1.5}, turning=True), {"force": (1.4, 1.6)})
    refitted = Correction(("effects", "coulomb_friction", "elbow", "force"), 1.5, "N*m")
    for text in (improved(rig, [found], [], bench.parent), improved(rig, [], [refitted], bench.parent)):
        removed, added = changed(rig.text, text)
        assert removed == [f'{key} = "1.6 N m"']
        assert len(added) == 1 and added[0].startswith(f'{key} = "1.5 N m"')
        assert parse(text, bench).effect("coulomb_friction", "elbow").parameters == {"force": 1.5}  # type: ignore[union-attr]


def test_the_richer_effect_takes_the_place_of_the_poorer_one(bench: Path) -> None:
    rig = parse(bench.read_text() + EXTRA, bench)
    found = EffectEntry(EffectSetting("asymmetric_friction", "piston", {"forward": 13.0, "backward": 11.0}), {"forward": (12.5, 13.5)})
    text = improved(rig, [found], [], bench.parent)
    again = parse(text, bench)
    assert again.effect("coulomb_friction", "piston") is None
    assert again.effect("asymmetric_friction", "piston").parameters == {"forward": 13.0, "backward": 11.0}  # type: ignore[union-attr]
    assert "12.5 to 13.5 N" in text


def test_whatever_is_found_beside_an_effect_of_the_owner_that_is_zero_can_be_read(bench: Path) -> None:
    effects = [effect for effect in declared().values() if "cylinder" in effect.places and not any(p.most for p in effect.parameters)]
    wanted = {effect.name: declared()[effect.requires] for effect in effects if effect.requires}

    def entries(effect: Effect, share: float) -> list[EffectEntry]:
        both = (wanted[effect.name], effect) if effect.name in wanted else (effect,)
        values = [{p.name: share * p.typical[1] if not p.choices else float(bool(share)) for p in one.parameters} for one in both]
        return [EffectEntry(EffectSetting(one.name, "piston", value), {}) for one, value in zip(both, values)]

    for owners in effects:
        try:
            rig = parse(improved(read(bench), entries(owners, 0.0), [], bench.parent), bench)
        except RigError:  # no rig holds this effect at zero
            continue
        for found in effects:
            again = parse(improved(rig, entries(found, 1.0), [], bench.parent), bench)
            assert again.effect(found.name, "piston") is not None, (owners.name, found.name)


def test_the_model_is_found_from_the_folder_it_is_written_to(bench: Path, tmp_path: Path) -> None:
    folder = tmp_path / "some" / "where"
    folder.mkdir(parents=True)
    text = improved(read(bench), [], [], folder)
    again = parse(text, folder / "improved.toml")
    assert again.model.resolve() == read(bench).model.resolve()


@pytest.mark.parametrize(
    "held", ['effects = {coulomb_friction = {piston = {force = "1 N"}}}', 'effects.coulomb_friction.piston.force = "1 N"']
)
def test_effects_in_braces_or_dots_can_be_added_to(bench: Path, held: str) -> None:
    rig = parse(f"{held}\n{bench.read_text()}", bench)
    leak = EffectEntry(EffectSetting("coulomb_friction", "slide", {"force": 2.0}))
    again = parse(improved(rig, [leak, EffectEntry(EffectSetting("piston_leakage", "piston", {"area": 1e-8}))], [], bench.parent), bench)
    assert {(effect.name, effect.where) for effect in again.effects} == {
        ("coulomb_friction", "piston"),
        ("coulomb_friction", "slide"),
        ("piston_leakage", "piston"),
    }


def test_tables_that_say_the_same_share_one_comment(bench: Path) -> None:
    rig = read(bench)
    found = [("valve_deadband", {"width": 1e-3}, "No finding."), ("valve_offset", {"shift": 1e-3}, "No finding."),
             ("viscous_friction", {"coefficient": 20.0}, "Friction grows with speed.")]  # fmt: skip
    text = improved(rig, [EffectEntry(EffectSetting(name, "piston", values), {}, says) for name, values, says in found], [], bench.parent)
    assert text.count("# No finding.") == 1
    assert text.index("# No finding.") < text.index("[effects.valve_deadband") < text.index("[effects.valve_offset")
    assert "# Friction grows with speed.\n[effects.viscous_friction.piston]" in text


def test_what_the_table_before_says_is_said_to_hold_of_the_next_as_well(bench: Path) -> None:
    rig, says = read(bench), "No finding, a healthy machine shows as much."
    settings = [EffectSetting("sensor_delay", f"piston.pressure_{n}", {"seconds": 7e-6}) for n in (1, 2)]
    late = [EffectEntry(setting, {"seconds": (-1e-5, 2e-5)}, says) for setting in settings]
    lines = improved(rig, late, [], bench.parent).splitlines()
    above = [lines[i - 1] for i, line in enumerate(lines) if line.startswith("[effects.sensor_delay.")]
    assert above == [f"# {says}", "# As above."]
