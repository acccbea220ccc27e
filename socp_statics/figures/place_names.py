"""Names of contacts, put where they hide nothing."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.ft2font import LoadFlags
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Patch
from matplotlib.patheffects import withStroke

from socp_statics.figures.window import Window
from socp_statics.spatial import Array

SIZE = 7.0
GAP = 3.0
STEP = 2.0


@cache
def text_width(words: str, size: float = SIZE, weight: str = "normal") -> float:
    """Width of a line of text in points."""
    font = get_font(_font_file(weight))
    font.set_size(size, 72)
    font.set_text(words, 0.0, flags=LoadFlags.NO_HINTING)
    return font.get_width_height()[0] / 64.0


@cache
def _font_file(weight: str) -> str:
    return findfont(FontProperties(family="DejaVu Sans", weight=weight))


def with_room_for_names(window: Window, points: Mapping[str, Array], inches: float) -> Window:
    """A window with room beside, above and below the outermost contacts for the names of those that are points.

    Args:
        window: What the figure would show.
        points: The drawn points of each name, shape (k, 2) [m].
        inches: Width of the axes.

    Returns:
        The window, at most a third wider and higher.
    """
    # the names take as many metres more as the window gets wider by them
    metres = window.width / (72.0 * inches) * 4.0 / 3.0
    low, high = np.array([window.x_min, window.y_min]), np.array([window.x_max, window.y_max])
    everything = np.vstack(list(points.values()))
    first, last = everything.min(axis=0), everything.max(axis=0)
    rim = np.array([window.width, window.height]) / 6.0
    least, most = low - rim, high + rim
    for name, xy in points.items():
        room = np.array([text_width(name) + 2.0 * GAP + 4.0, SIZE + 2.0 * GAP]) * metres
        start, end = xy.min(axis=0), xy.max(axis=0)
        if (end - start < 0.3 * room[0]).all() and window.holds(xy.mean(axis=0)):
            low = np.where(start <= first, np.minimum(low, start - room), low)
            high = np.where(end >= last, np.maximum(high, end + room), high)
    low, high = np.maximum(low, least), np.minimum(high, most)
    return Window(float(low[0]), float(high[0]), float(low[1]), float(high[1]))


def place_names(ax: Axes, points: Mapping[str, Array]) -> None:
    """Write names beside (or inside) what they name: off lines and markers, off each other, inside the axes.

    Args:
        ax: Axes whose limits are final.
        points: The drawn points of each name, shape (k, 2), in data units.
    """
    ax.apply_aspect()
    scale = 72.0 / _dpi(ax)
    frame = np.asarray(ax.get_window_extent().extents) * scale
    ink = _ink(ax) * scale
    taken: list[Array] = []
    for name, xy in points.items():
        around = ax.transData.transform(np.asarray(xy, dtype=float)) * scale
        middle = 0.5 * (around.min(axis=0) + around.max(axis=0))
        if not (frame[0] <= middle[0] <= frame[2] and frame[1] <= middle[1] <= frame[3]):
            middle = np.clip(middle, frame[:2], frame[2:])
        half = 0.5 * np.array([text_width(name) + 2.0, 0.95 * SIZE])
        extent = np.minimum(0.5 * np.ptp(around, axis=0), 0.5 * (frame[2:] - frame[:2]))
        choices = [middle + offset for offset in _offsets(extent, half)]
        costs = [_cost(place, half, middle, ink, taken, frame) + _leader_cost(place, half, middle, extent, taken) for place in choices]
        best = choices[int(np.argmin(costs))]
        taken.append(np.concatenate([best - half, best + half]))
        far = _far(best, half, middle, extent)
        note = ax.annotate(
            name, xy=tuple(ax.transData.inverted().transform(middle / scale)), xytext=tuple(best - middle), textcoords="offset points",
            ha="center", va="center", fontsize=SIZE, color="#222222", zorder=7.0, annotation_clip=False,
            arrowprops={"arrowstyle": "-", "linewidth": 0.5, "color": "#666666", "shrinkA": 0.0, "shrinkB": 0.0} if far else None,
        )  # fmt: skip
        note.set_path_effects([withStroke(linewidth=1.6, foreground="white")])


def _offsets(extent: Array, half: Array) -> list[Array]:
    """Where a name may stand from the middle of its contact: on it, at its sides and corners, then farther away."""
    places = [np.zeros(2)]
    places += [np.array([0.0, s * t * extent[1]]) for t in (0.35, 0.6) for s in (1.0, -1.0)]
    for ring in range(6):
        gap = GAP + 6.0 * ring
        reach = extent + half + gap
        places += [reach * np.array(d) for d in ((0, 1), (0, -1), (1, 0), (-1, 0))]
        slanted = extent + half + 0.5 * gap
        places += [slanted * np.array(d) for d in ((1, 1), (-1, 1), (1, -1), (-1, -1))]
        places += [np.array([x * extent[0], y * reach[1]]) for x in (0.5, -0.5) for y in (1.0, -1.0)]
    return places


def _cost(place: Array, half: Array, middle: Array, ink: Array, taken: list[Array], frame: Array) -> float:
    low, high = place - half, place + half
    outside = float(np.maximum(frame[:2] + 2.0 - low, 0.0).sum() + np.maximum(high - frame[2:] + 2.0, 0.0).sum())
    covered = 0.0
    for box in taken:
        overlap = np.minimum(high, box[2:]) - np.maximum(low, box[:2]) + 1.0
        covered += float(overlap.prod()) if (overlap > 0.0).all() else 0.0
    crossed = int(((ink > low - 1.0) & (ink < high + 1.0)).all(axis=1).sum()) if len(ink) else 0
    return 100.0 * outside + 20.0 * covered + 3.0 * crossed + 0.25 * float(np.linalg.norm(place - middle))


def _far(place: Array, half: Array, middle: Array, extent: Array) -> bool:
    """Whether a name stands so far from its contact that a line has to lead to it."""
    return float((np.abs(place - middle) - extent - half).max()) > 4.0 * GAP


def _leader_cost(place: Array, half: Array, middle: Array, extent: Array, taken: list[Array]) -> float:
    """What it costs that the line to a far name runs through other names."""
    if not _far(place, half, middle, extent):
        return 0.0
    return 100.0 * sum(_clipped(middle, place, box) is not None for box in taken)


def _dpi(ax: Axes) -> float:
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure.dpi


def _ink(ax: Axes) -> Array:
    """Points on everything that is drawn as a line, an edge or a marker, every few pixels, shape (n, 2) in display units."""
    found = []
    for artist in ax.get_children():
        if artist is ax.patch or not isinstance(artist, Line2D | Patch):
            continue
        if isinstance(artist, FancyArrowPatch):
            paths, transform = [artist.get_path()], ax.transData
        elif isinstance(artist, Line2D):
            paths, transform = [artist.get_path()], artist.get_transform()
            if artist.get_marker() not in (None, "None", "none", "", " "):
                found.append(_marker_ink(transform.transform(artist.get_xydata()), artist, ax))
            if artist.get_linestyle() == "None":
                continue
        else:
            paths, transform = [artist.get_path()], artist.get_transform()
        for path in paths:
            for corners in path.to_polygons(transform, closed_only=False):
                found.append(_along(np.asarray(corners), STEP * _dpi(ax) / 72.0, ax))
    return np.vstack(found) if found else np.zeros((0, 2))


def _marker_ink(centres: Array, line: Line2D, ax: Axes) -> Array:
    reach = 0.5 * line.get_markersize() * _dpi(ax) / 72.0
    ring = np.array([(x, y) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)]) * reach
    return (np.asarray(centres).reshape(-1, 1, 2) + ring).reshape(-1, 2)


def _along(corners: Array, step: float, ax: Axes) -> Array:
    """Points every step along a line; what is far outside the axes is left out."""
    frame = np.asarray(ax.get_window_extent().extents)
    pieces = []
    for a, b in zip(corners[:-1], corners[1:], strict=True):
        inside = _clipped(a, b, frame)
        if inside is not None:
            a, b = inside
            n = max(2, int(np.linalg.norm(b - a) / step) + 1)
            pieces.append(a + np.linspace(0.0, 1.0, n)[:, None] * (b - a))
    return np.vstack(pieces) if pieces else np.zeros((0, 2))


def _clipped(a: Array, b: Array, frame: Array) -> tuple[Array, Array] | None:
    """The part of a segment inside the frame (Liang and Barsky 1984), None where there is none."""
    first, last = 0.0, 1.0
    way = b - a
    for k in (0, 1):
        for low, sign in ((frame[k], 1.0), (frame[k + 2], -1.0)):
            speed, room = sign * way[k], sign * (a[k] - low)
            if speed == 0.0:
                if room < 0.0:
                    return None
            elif speed > 0.0:
                first = max(first, -room / speed)
            else:
                last = min(last, -room / speed)
    return (a + first * way, a + last * way) if first < last else None
