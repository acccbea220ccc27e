"""How often pyramids misjudge: rates of falsely stable and falsely unstable verdicts against sides, friction, slope and family."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from socp_statics.figures.draw_rates import circumstances, draw_area_errors, draw_rates, draw_rates_by
from socp_statics.figures.panels import title_panels
from socp_statics.figures.style import TWO_COLUMNS
from socp_statics.report_figures import Kept

NEEDS = {
    "families": Kept("comparison/families.json", "socp-statics compare comparison/families --json results/comparison/families.json"),
}


def draw(records: Mapping[str, Any]) -> Figure:
    """Rates and areas against the number of sides; with four sides against each circumstance."""
    comparison = records["families"]
    figure = Figure(figsize=(TWO_COLUMNS, 4.3), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(2, 6)
    above = [figure.add_subplot(grid[0, :3]), figure.add_subplot(grid[0, 3:])]
    names = circumstances(comparison)
    below = [figure.add_subplot(grid[1, 2 * k : 2 * k + 2]) for k in range(len(names))]
    draw_rates(comparison, above[0])
    draw_area_errors(comparison, above[1])
    for ax, name in zip(below, names, strict=True):
        draw_rates_by(comparison, name, 4, ax)
    above[0].set_ylabel("rate, 95 % band")
    above[1].set_ylabel("area error, 5 to 95 % band")
    below[-1].set_xlabel("")
    units = {"slope": "slope [rad]"}
    for ax in below:
        ax.set_xlabel(units.get(ax.get_xlabel(), ax.get_xlabel()))
    # above the place of what has none on the logarithmic axis
    above[0].legend(loc="lower left", bbox_to_anchor=(0.0, 0.17))
    title_panels([*above, *below], ["false verdicts", "region", *(f"by {name}" for name in names)])
    return figure


def caption(records: Mapping[str, Any]) -> str:
    """The sentence of the comparison."""
    comparison = records["families"]
    bands = "Bands and bars: 95 % confidence (a, c to e), 5 to 95 % of the regions (b). Kernel on both sides."
    return f"{comparison['answer'].rstrip('.')}. {bands}"
