"""A catalogue of one's own: what it may say, and what is refused in one line."""

import pytest

from exo_sim.errors import RigError
from exo_sim.rig.catalogue import CATALOGUE
from exo_sim.rig.own_catalogue import find_catalogue, included_catalogues, read_catalogue
from exo_sim.rig.valve import area_of

GOOD = """
[[cylinder]]
bore = "50 mm"
rod = "20 mm"
strokes = ["160 mm", "100 mm", "125 mm"]
mass_0 = "1.2 kg"
mass_per_metre = "5 kg/m"
rating = "13 bar"
maker = "Somebody"
[[cylinder]]
bore = "45 mm"
rod = "16 mm"
strokes = ["100 mm", "200 mm"]
mass_0 = "900 g"
mass_per_metre = "4 kg/m"
[[valve]]
C = "3 dm^3/(s bar)"
b = 0.3
kind = "4-way"
lag = "8 ms"
mass = "250 g"
[[valve]]
area = "5 mm^2"
"""


def read(folder, text):
    path = folder / "mine.toml"
    path.write_text(text)
    return read_catalogue(path)


def test_it_is_read_in_si_by_rising_size(tmp_path):
    found = read(tmp_path, GOOD)
    small, large = found.cylinders
    assert (small.bore, large.bore, large.maker, large.rating) == (0.045, 0.05, "Somebody", 13e5)
    assert large.strokes == (0.1, 0.125, 0.16) and large.mass(0.1) == pytest.approx(1.7)
    assert small.rating == pytest.approx(1101325.0)
    assert CATALOGUE[7].pivot_length < small.pivot_length < CATALOGUE[8].pivot_length  # 40 and 50 mm
    assert [one.area for one in found.valves] == [5e-6, pytest.approx(area_of(3e-8))]
    assert (found.valves[1].ratio, found.valves[1].lag, found.valves[1].mass) == (0.3, 0.008, 0.25)


def test_what_it_leaves_out_comes_along(tmp_path):
    assert read(tmp_path, '[[valve]]\narea = "5 mm^2"\n').cylinders == CATALOGUE
    assert read(tmp_path, GOOD[: GOOD.index("[[valve]]")]).valves == ()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('bore = "50 mm"', 'boar = "50 mm"', "cylinder[1].bore is missing"),
        ('maker = "Somebody"', 'makr = "Somebody"', "is not a key of a catalogue"),
        ('rod = "20 mm"', 'rod = "60 mm"', "thinner than the bore"),
        ('strokes = ["100 mm", "200 mm"]', 'strokes = "100 mm"', "must be a list"),
        ('strokes = ["100 mm", "200 mm"]', "strokes = [100]", "strokes.1"),
        ('area = "5 mm^2"', 'lag = "5 ms"', "valve[2].area is missing"),
        ('kind = "4-way"', 'kind = "5/3"', "is not known"),
        ("[[cylinder]]", "[cylinder]", "catalogue"),
        ('rating = "13 bar"', 'rating = "12 barg"', "gauge"),
        ('maker = "Somebody"', 'estimated = "mass_0"', "must be a list of keys"),
        ('maker = "Somebody"', 'estimated = ["mas_0"]', 'did you mean "mass_0"'),
        ('maker = "Somebody"', 'coldest = "20 bar"', "cylinder[1].coldest"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(tmp_path, old, new, words):
    with pytest.raises(RigError) as caught:
        read(tmp_path, GOOD.replace(old, new) if old != "[[cylinder]]" else GOOD[: GOOD.index("[[cylinder]]", 20)].replace(old, new))
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_no_file_and_nothing_in_it(tmp_path):
    with pytest.raises(RigError, match="no such catalogue"):
        read_catalogue(tmp_path / "none.toml")
    with pytest.raises(RigError, match="at least one"):
        read(tmp_path, "")


@pytest.mark.parametrize("name", ["festo", "smc"])
def test_makers_that_come_along_say_where_each_figure_is_from(name):
    found = read_catalogue(find_catalogue(name))
    for one in found.cylinders:
        assert one.maker.lower() == name and one.standard.startswith(one.maker) and one.source
        assert one.coldest == pytest.approx(253.15) and "pivot_length" in one.estimated
        standard = next(each for each in CATALOGUE if each.bore == one.bore)
        assert one.rod == standard.rod and one.rating >= standard.rating
        assert 0.5 * standard.mass(0.1) < one.mass(0.1) <= standard.mass(0.1)
    assert all(one.source and 0.0 < one.ratio < 0.5 for one in found.valves)


def test_published_figures_are_met():
    smc, festo = (read_catalogue(find_catalogue(name)) for name in ("smc", "festo"))
    assert smc.cylinders[-1].mass(0.1) == pytest.approx(4.49)  # CP96, bore 100 and stroke 100 mm: CAT.ES20-204B
    short = next(one for one in festo.cylinders if one.bore == 0.025)
    assert short.mass(0.1) == pytest.approx(0.2902) and set(short.estimated) == {"pivot_length"}  # DSNU-S-25: data sheet 8148789
    switched = [one for one in smc.valves if one.kind == "4-way"]
    assert {one.name: one.ratio for one in switched} == {"SMC SY3000": 0.28, "SMC SY5000": 0.37, "SMC SY7000": 0.28, "SMC SY9000": 0.29}
    assert switched[1].area == pytest.approx(area_of(2.8e-8)) and not switched[1].estimated


def test_a_name_that_is_no_file_and_comes_not_along_has_its_neighbour(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert find_catalogue("smc") == included_catalogues()["smc"]
    (tmp_path / "smc").write_text("")
    assert str(find_catalogue("smc")) == "smc"  # a file of one's own goes first
    with pytest.raises(RigError, match='did you mean "festo"'):
        find_catalogue("fest")
