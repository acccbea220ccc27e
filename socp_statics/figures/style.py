"""How figures look: sizes, fonts, colours, and settings that make files reproducible."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib

from socp_statics.colours import BLACK as BLACK
from socp_statics.colours import BLUE as BLUE
from socp_statics.colours import GREEN as GREEN
from socp_statics.colours import GREY as GREY
from socp_statics.colours import ORANGE as ORANGE
from socp_statics.colours import PURPLE as PURPLE
from socp_statics.colours import REGION_COLOURS
from socp_statics.colours import SKY as SKY
from socp_statics.colours import SOLE as SOLE
from socp_statics.colours import VERMILLION as VERMILLION

COLUMN, TWO_COLUMNS = 3.4, 7.0
DPI = 300

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
    "exact": {"color": REGION_COLOURS["exact"], "linestyle": "-", "linewidth": 1.3, "zorder": 3.0},
    "circumscribed": {"color": REGION_COLOURS["circumscribed"], "linestyle": (0, (3, 3)), "linewidth": 1.3, "zorder": 3.4},
    "inscribed": {"color": REGION_COLOURS["inscribed"], "linestyle": (3, (3, 3)), "linewidth": 1.3, "zorder": 3.5},
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
