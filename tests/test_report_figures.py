"""The report figures: every script is drawn from records, looks like the committed picture, and its caption says the same numbers."""

import re

import numpy as np
import pytest
from matplotlib.testing.compare import compare_images

from socp_statics.cli import main
from socp_statics.exceptions import InputError
from socp_statics.report_figures import Kept, figure_names, figure_script, make_figures, scripts_folder

MADE = scripts_folder() / "made"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
# root mean square over 8-bit channels; other versions of FreeType move glyphs by a fraction of a pixel
TOLERANCE = 3.0


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The figures of the scripts, each drawn once when it is first asked for."""
    folder = tmp_path_factory.mktemp("figures")

    def draw(name):
        if not (folder / f"{name}.txt").exists():
            make_figures([name], folder)
        return folder

    return draw


@pytest.mark.parametrize("name", figure_names())
def test_a_figure_looks_like_the_committed_one(name, made):
    assert compare_images(str(MADE / f"{name}.png"), str(made(name) / f"{name}.png"), TOLERANCE) is None


@pytest.mark.parametrize("name", figure_names())
def test_the_numbers_of_a_caption_are_those_of_the_records(name, made):
    new, old = ((folder / f"{name}.txt").read_text() for folder in (made(name), MADE))
    assert NUMBER.sub("#", new) == NUMBER.sub("#", old)
    np.testing.assert_allclose([float(n) for n in NUMBER.findall(new)], [float(n) for n in NUMBER.findall(old)], rtol=0.02, atol=0.1)


@pytest.mark.parametrize("name", figure_names())
def test_fonts_are_embedded_and_figures_one_or_two_columns_wide(name, made):
    pdf = (made(name) / f"{name}.pdf").read_bytes()
    width = float(re.search(rb"/MediaBox \[ 0 0 ([\d.]+)", pdf)[1]) / 72.0
    assert width == pytest.approx(3.4) or width == pytest.approx(7.0)
    assert b"/FontFile2" in pdf and b"/Type3" not in pdf


def test_a_change_is_seen(made, tmp_path):
    from PIL import Image

    picture = Image.open(made("torque_limited_regions") / "torque_limited_regions.png").convert("RGB")
    changed = np.array(picture)
    changed[200:400, 1200:1500] = (255, 0, 0)
    Image.fromarray(changed).save(tmp_path / "changed.png")
    assert compare_images(str(MADE / "torque_limited_regions.png"), str(tmp_path / "changed.png"), TOLERANCE) is not None


def test_the_same_records_give_the_same_bytes(made, tmp_path):
    make_figures(["torque_limited_regions"], tmp_path)
    for ending in (".pdf", ".png", ".txt"):
        file = f"torque_limited_regions{ending}"
        assert (tmp_path / file).read_bytes() == (made("torque_limited_regions") / file).read_bytes()


def test_every_script_says_what_it_shows():
    for name in figure_names():
        script = figure_script(name)
        assert script.__doc__ and script.NEEDS
        for need in script.NEEDS.values():
            assert need.path.exists() if isinstance(need, Kept) else need.stated().case_count >= 1


def test_the_verb_names_what_it_wrote(tmp_path, capsys):
    assert main(["figures", "torque_limited_regions", "--out", str(tmp_path / "new")]) == 0
    written = capsys.readouterr().out.split()
    assert written == [str(tmp_path / "new" / f"torque_limited_regions{ending}") for ending in (".pdf", ".png", ".txt")]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["torque_limited_region"], "did you mean 'torque_limited_regions'"),
        (["nothing like it"], "region_gallery"),
        (["../cones"], "no report figure"),
    ],
)
def test_an_unknown_figure_is_refused(arguments, words, capsys):
    assert main(["figures", *arguments]) == 2
    assert words in capsys.readouterr().err.splitlines()[-1]


def test_a_file_where_a_folder_is_expected(tmp_path, capsys):
    (tmp_path / "taken").write_text("x")
    assert main(["figures", "torque_limited_regions", "--out", str(tmp_path / "taken")]) == 2
    assert "--out" in capsys.readouterr().err.splitlines()[-1]


def test_a_file_that_is_not_kept_is_named_with_its_command(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(Kept, "path", property(lambda kept: tmp_path / kept.file))
    assert main(["figures", "false_verdicts", "--out", str(tmp_path)]) == 2
    assert "socp-statics compare comparison/families --json" in capsys.readouterr().err.splitlines()[-1]


def test_an_installed_package_has_no_report_figures(monkeypatch, tmp_path):
    monkeypatch.setattr("socp_statics.report_figures.problems_folder", lambda: tmp_path / "named_problems")
    with pytest.raises(InputError, match="made in a checkout"):
        figure_names()
