"""What figures are made of: numbers with units, windows onto the plane."""

import numpy as np
import pytest

from socp_statics.figures import quantities
from socp_statics.figures.window import Window, choose_window, inside


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (quantities.area_text(0.013818), "138.18 cm²"),
        (quantities.area_text(0.0), "0 cm²"),
        (quantities.area_text(8400.0), "8400.0 m²"),
        (quantities.area_text(2e-9), "0.002 mm²"),
        (quantities.length_text(-0.04), "\N{MINUS SIGN}40.00 mm"),
        (quantities.length_text(30.0), "30.00 m"),
        (quantities.length_text(0.0), "0 mm"),
        (quantities.length_text(0.99999999999), "1000 mm"),
        (quantities.length_text(-1e-9), "\N{MINUS SIGN}1e\N{MINUS SIGN}06 mm"),
        (quantities.force_text(14.234), "14.23 N"),
        (quantities.force_text(735749.0), "735.7 kN"),
        (quantities.force_text(-0.5), "\N{MINUS SIGN}0.5000 N"),
    ],
)
def test_numbers_are_written_with_units(text, expected):
    assert text == expected


def test_a_polygon_is_cut_to_a_window():
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    part = inside(square, Window(0.0, 2.0, 0.0, 2.0))
    assert sorted(map(tuple, part.tolist())) == [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)]
    assert len(inside(square, Window(2.0, 3.0, 2.0, 3.0))) == 0


def test_a_large_region_does_not_make_the_robot_tiny():
    robot = np.array([[0.0, 0.0], [0.3, 0.2]])
    twenty_metres = 10.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    for bounded, endless in (([twenty_metres], []), ([], [twenty_metres])):
        assert choose_window(robot, np.zeros((0, 2)), bounded, endless).span < 3.0
