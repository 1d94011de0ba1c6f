import pytest
from matplotlib.figure import Figure

from exo_sim.report.panel_grid import Room, grid_of_panels, with_legend


def drawn():
    figure = Figure(figsize=(9.0, 5.0))
    room = Room(left=0.7, right=0.2, below=0.4, above=0.3, columns=0.5, rows=0.6)
    return figure, room, grid_of_panels(figure, 2, 3, room)


def inches(figure, panel):
    place = panel.get_position()
    width, height = figure.get_size_inches()
    return place.x0 * width, place.y0 * height, place.x1 * width, place.y1 * height


def test_there_is_as_much_room_around_and_between_panels_as_was_asked():
    figure, _, panels = drawn()
    assert panels.shape == (2, 3)
    left, _, first_ends, above = inches(figure, panels[0][0])
    second_begins, _, _, _ = inches(figure, panels[0][1])
    _, below, right, lower_ends = inches(figure, panels[1][2])
    assert (left, 9.0 - right, below, 5.0 - above) == pytest.approx((0.7, 0.2, 0.4, 0.3))
    assert second_begins - first_ends == pytest.approx(0.5)
    assert inches(figure, panels[0][2])[1] - lower_ends == pytest.approx(0.6)


def test_a_legend_stands_above_the_panels_and_every_line_of_it_takes_room():
    tops = []
    for columns in (4, 2, 1):
        figure, room, panels = drawn()
        lines = [panels[0][0].plot([0, 1], label=f"line {i}")[0] for i in range(4)]
        with_legend(figure, room, lines, [one.get_label() for one in lines], columns, "upper center", 8.0)
        figure.draw_without_rendering()
        legend = figure.legends[0].get_window_extent().y0 / figure.dpi
        tops.append(inches(figure, panels[0][0])[3])
        assert 0.0 <= legend - tops[-1] - room.above < 0.2
    assert tops == sorted(tops, reverse=True)
