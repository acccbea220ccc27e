"""Accuracy against time of every way to a support region: exact cones and pyramids, this toolkit and its peers, in one run."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from socp_statics.figures.style import BLUE, ORANGE, TWO_COLUMNS
from socp_statics.report_figures import Kept

NEEDS = {"benchmark": Kept("benchmarks/kernel.json", "python tests/benchmarks/kernel.py --json results/benchmarks/kernel.json")}
MEDIAN = re.compile(r"area ([-+]?[\d.]+) % median, ([-+]?[\d.]+) % worst")


def _ways(benchmark: Mapping[str, Any]) -> list[tuple[str, float, float, bool]]:
    """Name, median time of a region [s], median size of the error of its area, and whether the cones are exact; fastest first."""
    found = []
    for name, way in benchmark["questions"]["region"].items():
        said = MEDIAN.search(way["error"] or "")
        if said and way["seconds"]:
            found.append((name, float(np.median(list(way["seconds"].values()))), abs(float(said[1])) / 100.0, way["side"] == "exact"))
    return sorted(found, key=lambda way: way[1])


def draw(records: Mapping[str, Any]) -> Figure:
    """Time along, error up, a mark for each way."""
    figure = Figure(figsize=(TWO_COLUMNS, 2.6), layout="constrained")
    FigureCanvasAgg(figure)
    ax = figure.add_subplot()
    ways = _ways(records["benchmark"])
    for number, (name, seconds, error, exact) in enumerate(ways, 1):
        ax.plot(1e3 * seconds, max(100.0 * error, 1e-3), marker="o" if exact else "s", color=BLUE if exact else ORANGE, markersize=4.0,
                linestyle="none", label=f"{number}  {name}", zorder=3.0)  # fmt: skip
        at = (1e3 * seconds, max(100.0 * error, 1e-3))
        ax.annotate(str(number), at, (0.0, 4.5), textcoords="offset points", ha="center", fontsize=6.5)
    ax.set_xscale("log")
    ax.set_yscale("log")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
    ax.margins(x=0.06, y=0.14)
    ax.grid(color="#dddddd", linewidth=0.4)
    ax.set_xlabel("median time of a region [ms]")
    ax.set_ylabel("median error of its area [%]")
    figure.legend(loc="outside right upper", handlelength=1.0)
    return figure


def caption(records: Mapping[str, Any]) -> str:
    """Times and errors by way."""
    benchmark = records["benchmark"]
    ways = _ways(benchmark)
    stances = len(next(iter(benchmark["questions"]["region"].values()))["seconds"])
    listed = "; ".join(f"({k}) {name} {1e3 * seconds:.3g} ms, {100 * error:.2g} %" for k, (name, seconds, error, _) in enumerate(ways, 1))
    return (
        f"Median time of a support region and median error of its area over {stances} stances, one thread, one run. Circles: "
        f"second-order cones to a relative gap of 1e-3; squares: pyramids inscribed in them. {listed}."
    )
