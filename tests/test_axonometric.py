"""The view of space from an angle: a parallel projection with upright z."""

import numpy as np
from matplotlib.figure import Figure

from socp_statics.figures.axonometric import add_axes_of_space, seen_from


def test_the_drawing_plane_is_square_to_the_reader():
    view = seen_from(0.7, 0.4)
    frame = np.array([view.right, view.up, view.toward])
    assert np.allclose(frame @ frame.T, np.eye(3), atol=1e-14) and np.isclose(np.linalg.det(frame), 1.0)
    assert np.allclose(view.flat([0, 0, 1])[0], 0.0) and view.flat([0, 0, 1])[1] > 0


def test_known_views():
    front = seen_from(0.0, 0.0)
    assert np.allclose(front.flat([[3.0, 1.0, 0.0], [3.0, 0.0, 2.0]]), [[1.0, 0.0], [0.0, 2.0]])
    side = seen_from(-np.pi / 2, 0.0)
    assert np.allclose(side.flat([1.0, 5.0, 0.5]), [1.0, 0.5])


def test_equal_lengths_along_a_direction_stay_equal():
    view, p = seen_from(-0.4, 0.3), np.array([0.1, 0.2, 0.3])
    assert np.allclose(view.flat(p + [0.5, 0, 0]) - view.flat(p), view.flat([0.5, 0, 0]))


def test_axes_of_space_are_named():
    ax = Figure().add_subplot()
    places = add_axes_of_space(ax, seen_from(0.3, 0.3), np.zeros(3), [1.0, 1.0, 2.0], ("x", "y", "z"))
    assert places.shape == (3, 2) and [t.get_text() for t in ax.texts] == ["x", "y", "z"]
