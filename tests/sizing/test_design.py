"""Designs: the rig that comes of one, and its mass."""

import pytest

from exo_sim import rig as rigs
from exo_sim.machine.linkage import check_strokes
from exo_sim.machine.rig_model import load
from exo_sim.sizing.design import actuator_mass, fit, fitted
from exo_sim.sizing.screening import chosen_bores
from exo_sim.sizing.sized_rig import sized_text


def _chosen(exo, space, loads, **changed):
    numbers = {**space.owners(exo), **changed}
    return space.design(numbers, chosen_bores(exo, space, (loads,), numbers))


def test_sized_rig_reads_back_and_fits_its_machine(exo, space, loads, tmp_path):
    design = _chosen(exo, space, loads, **{"hip.turn": 0.1, "knee.to": 0.08})
    (tmp_path / "sized.toml").write_text(sized_text(exo, space.kinds, design, tmp_path), encoding="utf-8")
    back = rigs.read(tmp_path / "sized.toml")
    wanted = fitted(exo, space.kinds, design)
    assert back.supply.pressure == pytest.approx(wanted.supply.pressure)
    for name, cylinder in wanted.cylinders.items():
        other = back.cylinders[name]
        for key in ("bore", "rod", "stroke", "retracted_length", "dead_volume_1", "dead_volume_2", "valve_area"):
            assert getattr(other, key) == pytest.approx(getattr(cylinder, key), rel=1e-6), key
        assert other.attachment is not None and cylinder.attachment is not None
        assert other.attachment.base == pytest.approx(cylinder.attachment.base)
        assert other.attachment.rod == pytest.approx(cylinder.attachment.rod)
    check_strokes(back, load(back))
    assert back.ankle == exo.ankle and "# 250 psi" not in back.name


def test_mass_is_the_catalogues(exo, space, loads):
    design = _chosen(exo, space, loads)
    masses = [2 * design.joints[k.name].cylinder.mass(fit(k, design.joints[k.name]).stroke) for k in space.kinds]
    assert actuator_mass(space.kinds, design) == pytest.approx(sum(masses))
