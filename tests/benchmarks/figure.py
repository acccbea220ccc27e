"""The figure of the benchmarks: time against the number of contact points, and speed against the number of threads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.curves import Curve, Sharing

# Okabe and Ito, in the order of the curves; markers tell them apart without colour.
STYLES = {
    "kernel": ("#D55E00", "o", "kernel, exact cones"),
    "Clarabel compiled": ("#0072B2", "s", "Clarabel compiled, exact cones"),
    "bare Clarabel": ("#56B4E9", "D", "bare Clarabel, exact cones"),
    "Klampt polygon, 4 sides": ("#009E73", "^", "Klampt, 4-sided pyramids"),
    "HiGHS LP, 4 sides": ("#CC79A7", "v", "HiGHS, 4-sided pyramids"),
}
WIDTH = 3.5
PANEL = 2.6
INK = "#000000"


def draw(curves: Sequence[Curve], sharing: Sharing, path: str | Path) -> None:
    """Draw a single-column figure.

    Args:
        curves: Times of support regions of one family against the number of contact points.
        sharing: Times of a batch of regions; its panel is left out where there are none.
        path: Where to write it; the ending says how.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.ticker import FixedLocator, NullLocator, StrMethodFormatter

    shared = len(sharing.seconds) > 1
    with plt.rc_context({"font.size": 8, "axes.linewidth": 0.6, "pdf.fonttype": 42, "svg.hashsalt": "benchmarks"}):
        count = 2 if shared else 1
        figure, all_axes = plt.subplots(
            count, 1, figsize=(WIDTH, PANEL + 0.7 + (1.9 if shared else 0.0)), layout="constrained", squeeze=False,
            height_ratios=[3.3, 1.9][:count],
        )  # fmt: skip
        axes = all_axes[0, 0]
        points = sorted({n for c in curves for n in c.points})
        for curve in curves:
            if curve.points:
                colour, marker, label = STYLES[curve.way.name]
                exponent = "" if curve.exponent is None else f", $n^{{{curve.exponent:.2f}}}$"
                times = [1e3 * t for t in curve.seconds]
                axes.loglog(curve.points, times, color=colour, marker=marker, ms=3.5, lw=1.1, label=label + exponent)
        axes.set_xlabel("contact points $n$")
        axes.set_ylabel("time of a support region [ms]")
        axes.xaxis.set_major_locator(FixedLocator([n for n in points if n != 4]))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:.0f}"))
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.grid(True, which="major", lw=0.3, color="0.85")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", frameon=False, handlelength=1.6)
        if shared:
            lower = all_axes[1, 0]
            threads = list(sharing.seconds)
            lower.plot(threads, threads, color="0.6", lw=0.8, ls="--", label="ideal")
            colour, marker, _ = STYLES["kernel"]
            lower.plot(threads, [sharing.speedup(n) for n in threads], color=colour, marker=marker, ms=3.5, lw=1.1, label="kernel")
            lower.set_xlabel(f"threads, batch of {sharing.regions} regions")
            lower.set_ylabel("speed over\none thread")
            lower.set_xticks(threads)
            lower.set_yticks(range(1, max(threads) + 1) if max(threads) <= 8 else threads)
            lower.grid(True, lw=0.3, color="0.85")
            lower.legend(frameon=False)
        for one in all_axes.ravel():
            one.spines[["top", "right"]].set_visible(False)
        figure.savefig(path, dpi=300)
        plt.close(figure)
