"""The pictures of a report as SVG text: histograms and thumbnails of regions."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from socp_statics.colours import BLACK, BLUE, GREY, SOLE, VERDICT_COLOURS
from socp_statics.report.gathering import Thumbnail

BINS = 40
WIDTH, HEIGHT, BASE = 420, 150, 120
SMALL, EDGE = 120, 12


def histogram(values: Sequence[float], unit: str, factor: float = 1.0) -> str:
    """A histogram; what lies beyond the middle 98 % is counted at the ends.

    Args:
        values: Finite numbers.
        unit: Of the axis.
        factor: From the values to that unit.

    Returns:
        An ``<svg>`` element, empty text where there is nothing to draw.
    """
    if not len(values):
        return ""
    shown = np.asarray(values, dtype=float) * factor
    low, high = (float(v) for v in np.percentile(shown, [1.0, 99.0]))
    if not high > low:
        low, high = low - 0.5 * max(abs(low), 1e-6), high + 0.5 * max(abs(high), 1e-6)
    counts, edges = np.histogram(np.clip(shown, low, high), BINS, (low, high))
    step, most = WIDTH / BINS, max(int(counts.max()), 1)
    bars = "".join(
        f'<rect x="{k * step:.1f}" y="{BASE - 100 * n / most:.1f}" width="{step - 1:.1f}" height="{100 * n / most:.1f}" fill="{BLUE}"/>'
        for k, n in enumerate(counts)
        if n
    )
    zero = (0.0 - low) / (high - low) * WIDTH
    line = f'<line x1="{zero:.1f}" y1="10" x2="{zero:.1f}" y2="{BASE}" stroke="{BLACK}" stroke-dasharray="3 3"/>'
    line = line if 0 < zero < WIDTH else ""
    labels = "".join(
        f'<text x="{x}" y="{BASE + 18}" text-anchor="{anchor}">{escape(f"{value:.3g}")}</text>'
        for x, anchor, value in ((0, "start", edges[0]), (WIDTH / 2, "middle", 0.5 * (low + high)), (WIDTH, "end", edges[-1]))
    )
    most_label = f'<text x="0" y="14">{most}</text>'
    axis = f'<line x1="0" y1="{BASE}" x2="{WIDTH}" y2="{BASE}" stroke="{GREY}"/>'
    unit_label = f'<text x="{WIDTH}" y="14" text-anchor="end">{escape(unit)}</text>'
    return f'<svg viewBox="-4 0 {WIDTH + 8} {HEIGHT}" width="{WIDTH}" role="img">{bars}{line}{axis}{labels}{most_label}{unit_label}</svg>'


def thumbnail(one: Thumbnail) -> str:
    """A region as a small floor plan: outer polygon, inner polygon, contact points, centre of mass; x to the right, y up.

    Args:
        one: What to draw.

    Returns:
        An ``<svg>`` element.
    """
    inner, outer = (np.array(one.region.get(key) or [], dtype=float).reshape(-1, 2) for key in ("inner", "outer"))
    touched = np.array([entry["point"][:2] for entry in one.region.get("points", ())], dtype=float).reshape(-1, 2)
    com = np.array([one.com])
    shape = outer if len(outer) else inner
    everything = np.vstack([shape, touched])
    middle = 0.5 * (everything.min(axis=0) + everything.max(axis=0))
    span = max(float(np.ptp(everything, axis=0).max()), 1e-9)
    # A centre of mass that is far away is drawn at the edge of the picture.
    com = np.clip(com, middle - 0.75 * span, middle + 0.75 * span)
    span = max(span, 2.0 * float(np.abs(com - middle).max()))
    scale = (SMALL - 2 * EDGE) / span

    def place(points: np.ndarray) -> np.ndarray:
        return np.column_stack([SMALL / 2 + scale * (points[:, 0] - middle[0]), SMALL / 2 - scale * (points[:, 1] - middle[1])])

    def path(points: np.ndarray, style: str) -> str:
        return f'<polygon points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in place(points))}" {style}/>' if len(points) else ""

    def dots(points: np.ndarray, radius: float, style: str) -> str:
        return "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" {style}/>' for x, y in place(points))

    return (
        f'<svg viewBox="0 0 {SMALL} {SMALL}" width="{SMALL}" role="img">'
        + path(inner, f'fill="{SOLE}" stroke="{BLUE}" stroke-width="1.2" stroke-linejoin="round"')
        + path(outer, f'fill="none" stroke="{GREY}" stroke-width="0.6"')
        + dots(touched, 1.6, f'fill="{BLACK}"')
        + dots(com, 3.2, f'fill="{VERDICT_COLOURS[one.verdict]}" stroke="white" stroke-width="0.8"')
        + "</svg>"
    )
