"""How figures look: sizes, fonts, the Okabe-Ito colours, and settings that make files reproducible."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib

COLUMN, TWO_COLUMNS = 3.4, 7.0
DPI = 300

BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
BLUE = "#0072B2"
VERMILLION = "#D55E00"
PURPLE = "#CC79A7"
GREY = "#6B6B6B"
SOLE = "#D4D4D4"

SETTINGS: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7.0,
    "axes.labelsize": 7.5,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "#444444",
    "axes.axisbelow": True,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "lines.linewidth": 1.0,
    "lines.dash_capstyle": "butt",
    "patch.linewidth": 0.8,
    "savefig.dpi": DPI,
    "savefig.bbox": None,
    "savefig.transparent": False,
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "socp_statics",
    "path.simplify": False,
    # a contact may be called anything, dollar signs too
    "text.parse_math": False,
}

# offsets are chosen so that regions that coincide still show both colours along their edge
REGION_LINES: dict[str, dict[str, Any]] = {
    "exact": {"color": BLUE, "linestyle": "-", "linewidth": 1.3, "zorder": 3.0},
    "circumscribed": {"color": ORANGE, "linestyle": (0, (3, 3)), "linewidth": 1.3, "zorder": 3.4},
    "inscribed": {"color": GREEN, "linestyle": (3, (3, 3)), "linewidth": 1.3, "zorder": 3.5},
}
BASE_LINE: dict[str, Any] = {"color": GREY, "linestyle": (0, (1.2, 1.6)), "linewidth": 2.4, "zorder": 2.6}


@contextmanager
def house_style() -> Iterator[None]:
    """Settings of this package, whatever the user's own are, for the time of a ``with`` block."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        for key, value in SETTINGS.items():
            matplotlib.rcParams[key] = value  # type: ignore[index]
        yield
