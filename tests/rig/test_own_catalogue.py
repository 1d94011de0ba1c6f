"""A catalogue of one's own: what it may say, and what is refused in one line."""

import pytest

from exo_sim.errors import RigError
from exo_sim.rig.catalogue import CATALOGUE
from exo_sim.rig.own_catalogue import read_catalogue
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
