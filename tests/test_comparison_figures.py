"""Figures of comparisons: drawn from the file alone, the same bytes every time, everything asked for is shown."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import socp_statics as ss
from socp_statics.comparison import compare
from socp_statics.comparison.times import Timed
from socp_statics.exceptions import InputError
from socp_statics.figures import comparison_figure, save_comparison

TIMES = [
    Timed("region", "exact", None, "kernel", 2e-4),
    Timed("region", "inscribed", 4, "kernel", 2e-4),
    Timed("region", "inscribed", 4, "HiGHS", 9e-3, 3e-3),
]


@pytest.fixture(scope="module")
def stance():
    return compare(ss.load_problem("contacts/foot_and_wall_hand"), (4, 8), 3, with_times=False)


@pytest.fixture(scope="module")
def population():
    problem = ss.load_problem("comparison/families").with_values({"posture.family": "sloped_feet", "posture.friction": 0.5})
    few = {"posture.slope": [0.1, 0.4], "posture.seed": {"from": 0, "to": 9}}
    raw = {**problem.raw, "sweep": few}
    from socp_statics.cases.problem import problem_from_tables

    return compare(problem_from_tables(raw, "few"), (4, 8), threads=2)


def test_the_family_of_regions_and_errors_and_times_are_shown(stance):
    figure = comparison_figure(stance, TIMES)
    family, errors, times = figure.axes
    lines = [line for line in family.get_children() if getattr(line, "get_xdata", None) and len(line.get_xdata()) > 3]
    assert len(lines) >= 1 + 3 + 3
    for ax, words in ((family, "inscribed, 4 sides"), (errors, "circumscribed: unsafe"), (times, "of it inside HiGHS")):
        assert words in ax.get_legend_handles_labels()[1]
    assert stance["answer"].split()[-1] in figure.get_suptitle()
    assert len(comparison_figure(stance).axes) == 2


def test_rates_have_bands_and_every_circumstance_a_panel(population):
    figure = comparison_figure(population)
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert labels.count("sides of the pyramid") == 2 and "slope" in labels
    assert all(len(ax.collections) for ax in figure.axes)
    assert population["by"] == ["slope"]


def test_the_same_comparison_gives_the_same_bytes_also_from_its_json(stance, population, tmp_path):
    for found, times, ending in ((stance, TIMES, "pdf"), (population, (), "svg")):
        save_comparison(found, tmp_path / f"a.{ending}", times)
        save_comparison(json.loads(found.to_json()), tmp_path / f"b.{ending}", times)
        assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()


@pytest.fixture(scope="module")
def chimney():
    return compare(ss.load_problem("contacts/chimney"), (4,), 2, with_times=False)


def drawn(figure):
    figure.canvas.draw()
    return figure.canvas.get_renderer()


@pytest.mark.parametrize("slow", [2.5e-3, 2.05e-3, 9e-2])
def test_ticks_are_plain_numbers_also_within_one_decade(chimney, slow):
    times = [Timed("region", "exact", None, "kernel", 2e-3), Timed("region", "inscribed", 4, "kernel", slow)]
    figure = comparison_figure(chimney, times)
    drawn(figure)
    for ax in figure.axes:
        for axis, (low, high) in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
            words = [t.get_text() for t in (*axis.get_ticklabels(), *axis.get_ticklabels(minor=True))]
            assert not any("$" in word for word in words)
            assert sum(low <= tick <= high for tick in axis.get_majorticklocs()) >= (1 if axis is ax.xaxis else 2)


def test_nothing_falls_off_the_sheet(stance, chimney, population):
    for found, times in ((stance, TIMES), (stance, ()), (chimney, TIMES), (population, ())):
        figure = comparison_figure(found, times)
        renderer = drawn(figure)
        for ax in figure.axes:
            box, sheet = ax.get_tightbbox(renderer), figure.bbox
            assert box.x0 >= -1 and box.y0 >= -1 and box.x1 <= sheet.x1 + 1 and box.y1 <= sheet.y1 + 1


def test_a_region_without_end_has_no_edge_in_sight_and_says_so(chimney):
    family, errors = comparison_figure(chimney).axes
    words = family.get_legend_handles_labels()[1]
    assert {"the region has no end", "exact: no end", "inscribed, 4 sides: no end"} <= set(words)
    (x_min, x_max), (y_min, y_max) = family.get_xlim(), family.get_ylim()
    lines = [line.get_xydata() for line in family.get_children() if isinstance(line, Line2D) and len(line.get_xdata()) > 3]
    assert len(lines) == 1 + 2 + 2
    for xy in lines:
        assert not ((xy[:, 0] > x_min) & (xy[:, 0] < x_max) & (xy[:, 1] > y_min) & (xy[:, 1] < y_max)).any()
    # what has no error has no mark, in the panel and in its legend
    marked = {label: handle.get_marker() for handle, label in zip(*errors.get_legend_handles_labels(), strict=True)}
    assert marked["margin: no error"] in ("None", None) and marked["area: no error"] in ("None", None)
    assert "margin" not in marked and "area" not in marked and marked["minimax"] == "D"


def test_a_line_without_end_is_drawn_out_of_sight():
    family, errors = comparison_figure(compare(ss.load_problem("degenerate/bar_line"), (4,), 1, with_times=False)).axes
    lines = [line.get_xydata() for line in family.get_children() if isinstance(line, Line2D) and len(line.get_xdata()) > 1]
    assert len(lines) == 3
    low, high = family.get_ylim()
    assert all(xy[:, 1].min() < low and xy[:, 1].max() > high for xy in lines)
    assert [text.get_text() for text in errors.texts] == ["no error"]


def test_errors_that_come_down_to_nothing_end_in_a_triangle(stance):
    errors = comparison_figure(stance).axes[1]
    assert "down to 0 at some heading" in errors.get_legend_handles_labels()[1]
    low, _ = errors.get_ylim()
    bars = np.concatenate([segment[:, 1] for lines in errors.collections for segment in lines.get_segments()])
    assert (bars > low).all()
    ends = [y for line in errors.get_lines() if line.get_marker() == "v" for y in line.get_ydata()]
    zero = [r for r in stance["spread"] if abs(r["least"]) <= 1e-4 < abs(r["most"])]
    assert len(ends) == len(zero) > 0


def test_one_number_of_sides_has_bars_and_zero_has_a_place():
    from socp_statics.cases.problem import problem_from_tables

    raw = ss.load_problem("comparison/families").with_values({"posture.family": "flat", "posture.friction": 0.5}).raw
    found = compare(problem_from_tables({**raw, "sweep": {"posture.seed": {"from": 0, "to": 5}}}, "few"), (4,), threads=2)
    figure = comparison_figure(found)
    for ax in figure.axes[:2]:
        assert len(ax.containers) == len({r["kind"] for r in found["rates"] if r["rate"] is not None})
        low, high = ax.get_ylim()
        for bars in ax.containers:
            (y,) = bars.lines[0].get_ydata()
            assert low < y < high
    drawn(figure)
    assert "less" in [t.get_text() for t in figure.axes[0].get_yticklabels()]


def test_what_has_no_region_and_no_error_is_drawn_too(tmp_path):
    problem = ss.load_problem("contacts/flat_double_stance").with_values({"posture.gravity": [9.81, 0.0, 0.0]})
    nothing = compare(problem, (4,), 1, with_times=False)
    assert isinstance(comparison_figure(nothing), Figure)
    flat = compare(ss.load_problem("contacts/flat_double_stance"), (4,), 1, with_times=False)
    save_comparison(flat, tmp_path / "flat.png")
    assert np.frombuffer((tmp_path / "flat.png").read_bytes(), dtype=np.uint8).size > 1000
    with pytest.raises(InputError, match=".pdf"):
        save_comparison(flat, tmp_path / "flat.txt")
