"""Figures of comparisons: drawn from the file alone, the same bytes every time, everything asked for is shown."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure

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


def test_what_has_no_region_and_no_error_is_drawn_too(tmp_path):
    problem = ss.load_problem("contacts/flat_double_stance").with_values({"posture.gravity": [9.81, 0.0, 0.0]})
    nothing = compare(problem, (4,), 1, with_times=False)
    assert isinstance(comparison_figure(nothing), Figure)
    flat = compare(ss.load_problem("contacts/flat_double_stance"), (4,), 1, with_times=False)
    save_comparison(flat, tmp_path / "flat.png")
    assert np.frombuffer((tmp_path / "flat.png").read_bytes(), dtype=np.uint8).size > 1000
    with pytest.raises(InputError, match=".pdf"):
        save_comparison(flat, tmp_path / "flat.txt")
