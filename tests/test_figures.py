"""Figures: same bytes for the same answer, nothing hidden, nothing solved, nothing half written."""

import subprocess
import sys

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text

from socp_statics import engines, figures
from socp_statics.cases.record import Record
from socp_statics.comparison import compare_regions
from socp_statics.contacts import ExternalWrench, Handle, PointContact, Stance, SurfaceContact
from socp_statics.exceptions import InputError
from socp_statics.figures import answer_figure, draw, draw_motion, draw_region, draw_stance, quantities, save_figure
from socp_statics.figures.window import Window
from socp_statics.regions import base_of_support, trace_support_region, tracing
from socp_statics.stability import check_equilibrium

UP = (0.0, 0.0, 1.0)


def sole(name, position, size=(0.22, 0.13), friction=0.6, **orientation):
    return SurfaceContact(name, position, friction=friction, size=size, **(orientation or {"normal": UP}))


def point(name, position, normal=UP, friction=0.5):
    return PointContact(name, position, normal=normal, friction=friction)


def feet(x=0.0, y=0.0):
    return [sole("left_foot", [x, y + 0.1, 0]), sole("right_foot", [x, y - 0.1, 0])]


HAND = point("hand", [0.4, 0.2, 1.0], [-1, 0, 0.1], 0.4)
STANCES = {
    "polygon": Stance(feet(), [0.05, 0, 0.8], 60.0),
    "tipping": Stance(feet(), [0.15, 0.03, 0.8], 60.0),
    "segment": Stance([point("a", [0, 0.1, 0]), point("b", [0, -0.1, 0])], [0.05, 0, 1.0], 60.0),
    "point": Stance([point("tip", [0, 0, 0])], [0, 0, 1.0], 60.0),
    "empty": Stance([point("ceiling", [0, 0, 1], [0, 0, -1])], [0.05, 0.1, 0.3], 60.0),
    "unbounded": Stance(
        [sole("left", [0, 0.3, 0], friction=1, normal=[0, -1, 0]), sole("right", [0, -0.3, 0], friction=1, normal=[0, 1, 0])],
        [0, 0, 0],
        60.0,
    ),
    "wall hand": Stance([*feet(), HAND], [0.2, 0, 0.8], 60.0),
    "push": Stance(feet(), [0, 0, 0.8], 60.0, external_wrenches=(ExternalWrench(force=[100, 20, 0], point=[0, 0, 0.5]),)),
    "handle": Stance([*feet(), Handle("bar", [0.3, 0, 1], normal=UP, transmits=["fz"], limits={"fz": [-50, 50]})], [0, 0, 0.8], 60.0),
    "one kilometre away": Stance(feet(1000.0, -1000.0), [1000.03, -999.98, 0.8], 60.0),
    "ten millimetres": Stance([sole("a", [0, 0.004, 0], (0.01, 0.005)), sole("b", [0, -0.004, 0], (0.01, 0.005))], [0, 0, 0.02], 0.1),
    "hundred metres": Stance([sole("platform", [0, 0, 0], (100.0, 60.0))], [10, 0, 1], 1e6),
}


def record_of(stance, name="contacts/example", model="support_region"):
    answer = check_equilibrium(stance)
    posture = {
        "gravity": stance.gravity,
        "external_wrenches": [{"force": w.force, "moment": w.moment, "point": w.point} for w in stance.external_wrenches],
    }
    generated = {"contacts": [c.statement() for c in stance.contacts], "com": stance.com, "mass": stance.mass}
    entries = {
        "problem": name,
        "model": model,
        "case": {"posture": posture, "generated": generated},
        "verdict": answer.verdict,
        "reason": answer.reason,
        "cone": answer.cone.as_record(),
        "margin": answer.margin,
        "idle": answer.idle,
        "idle_margin": answer.idle_margin,
        "com_margin": None,
        "forces": [] if answer.forces is None else answer.forces.entries(),
        "certificate": None if answer.certificate is None else answer.certificate.as_record(),
    }
    if model == "support_region":
        region = trace_support_region(stance)
        entries |= {"com_margin": region.com_margin, "region": region.as_record()}
    return Record(entries)


@pytest.fixture(scope="module")
def answers():
    return {name: (record_of(stance), compare_regions(stance)) for name, stance in STANCES.items()}


def words_of(figure):
    legend = [text.get_text() for one in figure.legends for text in one.get_texts()]
    return [text.get_text() for text in figure.texts] + legend


def shown_ticks(axis, limits, k):
    return [t for t in axis.get_ticklabels() if limits[0] <= t.get_position()[k] <= limits[1]]


@pytest.mark.parametrize("ending", [".pdf", ".png", ".svg", ".PDF"])
@pytest.mark.parametrize("name", ["wall hand", "tipping"])
def test_the_same_answer_gives_the_same_bytes(answers, tmp_path, name, ending):
    record, regions = answers[name]
    first, second = tmp_path / f"one{ending}", tmp_path / f"two{ending}"
    save_figure(record, first, regions)
    save_figure(Record(dict(record)), second, regions)
    assert first.read_bytes() == second.read_bytes()
    assert first.read_bytes()[:4] == {".pdf": b"%PDF", ".png": b"\x89PNG", ".svg": b"<?xm"}[ending.lower()]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([first.name, second.name])


@pytest.mark.parametrize("ending", [".pdf", ".svg"])
def test_no_date_and_no_bitmap_fonts_in_vector_files(answers, tmp_path, ending):
    save_figure(*answers["polygon"][:1], tmp_path / f"figure{ending}", answers["polygon"][1])
    text = (tmp_path / f"figure{ending}").read_bytes()
    assert b"CreationDate" not in text and b"dc:date" not in text
    assert b"/Type3" not in text


def test_the_users_settings_do_not_matter(answers, tmp_path):
    import matplotlib

    save_figure(answers["polygon"][0], tmp_path / "one.svg")
    with matplotlib.rc_context({"font.size": 20.0, "svg.hashsalt": "other", "lines.linewidth": 9.0}):
        save_figure(answers["polygon"][0], tmp_path / "two.svg")
        assert matplotlib.rcParams["font.size"] == 20.0
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()


@pytest.mark.parametrize("name", STANCES)
def test_every_answer_has_a_picture_with_equal_axes_in_metres(answers, name):
    record, regions = answers[name]
    stance = STANCES[name]
    figure = answer_figure(record, regions)
    figure.canvas.draw()
    (ax,) = figure.axes
    assert ax.get_xlabel() == "x [m]" and ax.get_ylabel() == "y [m]"
    box = ax.get_window_extent()
    assert np.ptp(ax.get_xlim()) / box.width == pytest.approx(np.ptp(ax.get_ylim()) / box.height, rel=1e-3)
    (x_min, x_max), (y_min, y_max) = ax.get_xlim(), ax.get_ylim()
    window = Window(x_min, x_max, y_min, y_max)
    assert all(window.holds(p[:2]) for p in stance.contacts.points_W)
    assert window.holds(stance.com[:2])
    assert window.span < 8.0 * max(stance.contacts.size if len(stance.contacts.points_W) > 1 else 0.1, 1e-3)
    assert figure.get_figwidth() == pytest.approx(3.4)


@pytest.mark.parametrize("name", STANCES)
@pytest.mark.parametrize("model", ["support_region", "equilibrium"])
def test_nothing_is_cut_off_and_no_name_is_written_over_another(answers, name, model):
    record, regions = answers[name]
    if model == "equilibrium":
        record = Record({key: value for key, value in record.items() if key != "region"} | {"model": model})
    figure = answer_figure(record, regions)
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    sheet = figure.bbox
    texts = [*figure.texts, *figure.legends]
    for ax in figure.axes:
        names = [text.get_window_extent(renderer) for text in ax.texts]
        assert len(names) == len(STANCES[name].contacts)
        for k, one in enumerate(names):
            assert not any(one.overlaps(other) for other in names[:k])
            assert ax.get_window_extent().x0 <= one.x0 and one.x1 <= ax.get_window_extent().x1
        below, beside = shown_ticks(ax.xaxis, ax.get_xlim(), 0), shown_ticks(ax.yaxis, ax.get_ylim(), 1)
        texts += [ax.xaxis.label, ax.yaxis.label, *below, *beside]
        for ticks, label in ((below, ax.xaxis.label), (beside, ax.yaxis.label)):
            boxes = [t.get_window_extent(renderer) for t in ticks]
            assert len(boxes) >= 2 and not any(a.overlaps(b) for a, b in zip(boxes[:-1], boxes[1:], strict=True))
            assert not any(label.get_window_extent(renderer).overlaps(box) for box in boxes)
    for text in texts:
        extent = text.get_window_extent(renderer)
        assert extent.x0 >= sheet.x0 - 1 and extent.x1 <= sheet.x1 + 1 and extent.y0 >= sheet.y0 - 1 and extent.y1 <= sheet.y1 + 1
    (legend,) = figure.legends
    assert not any(legend.get_window_extent(renderer).overlaps(ax.get_window_extent()) for ax in figure.axes)


def test_words_and_legend_carry_units(answers):
    words = words_of(answer_figure(*answers["polygon"]))
    assert words[0] == "contacts/example"
    assert words[1] == "stable; margin 40.13 N; CoM margin 60.00 mm"
    for line in ("exact region, 726.00 cm²", "inscribed, 4 sides, 726.00 cm²", "circumscribed, 4 sides, 726.00 cm²"):
        assert line in words
    assert "base of support, 726.00 cm²" in words and "CoM" in words and "CoM margin" in words


def test_an_unstable_answer_says_and_shows_the_motion(answers):
    record, regions = answers["tipping"]
    words = words_of(answer_figure(record, regions))
    assert words[1].startswith("unstable; margin \N{MINUS SIGN}26.75 N")
    assert record["certificate"]["reading"] in " ".join(words)
    assert {"certified motion", "axis of rotation", "moves up"} <= set(words)


def climber():
    """Hands on hooks that let go downwards, feet on the wall below them: it falls along the wall and turns about an axis far from it."""
    hands = [Handle(f"{side}_hand", [0, y, 1.8], normal=[1, 0, 0], transmits=["fx", "fz"]) for side, y in (("left", 0.3), ("right", -0.3))]
    toes = [point(f"{side}_foot", [0, y, 0], [1, 0, 0], 0.8) for side, y in (("left", 0.2), ("right", -0.2))]
    return Stance([*hands, *toes], [0.3, 0, 1.0], 70.0)


def test_an_axis_out_of_sight_is_not_in_the_legend():
    figure = answer_figure(record_of(climber(), model="equilibrium"))
    words = words_of(figure)
    assert "certified motion" in words and "axis of rotation" not in words
    assert "slides freely along -z at left_hand and right_hand" in " ".join(words)


def test_no_line_to_a_name_runs_through_another_name():
    figure = answer_figure(record_of(climber(), model="equilibrium"))
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    for ax in figure.axes:
        boxes = [Text.get_window_extent(note, renderer) for note in ax.texts]
        assert len(boxes) == 4 and not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])
        for note in ax.texts:
            if note.arrow_patch is None:
                continue
            line = note.arrow_patch.get_path().interpolated(50).vertices
            line = note.arrow_patch.get_transform().transform(line)
            others = [box for box, other in zip(boxes, ax.texts, strict=True) if other is not note]
            assert not any(box.contains(*at) for box in others for at in line)


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("segment", "exact region, 200.0 mm long"),
        ("point", "exact region, a point"),
        ("unbounded", "the region has no end"),
        ("empty", "the region is empty, with pyramids too"),
        ("push", "load 102.0 N"),
        ("handle", "handle"),
        ("hundred metres", "exact region, 6000.0 m²"),
        ("ten millimetres", "exact region, 1.3000 cm²"),
    ],
)
def test_each_kind_of_answer_is_named(answers, name, line):
    assert line in words_of(answer_figure(*answers[name]))


@pytest.mark.parametrize("name", ["wall hand", "tipping", "push", "empty"])
def test_an_answer_without_a_region_is_seen_from_the_side_too(name):
    figure = answer_figure(record_of(STANCES[name], model="equilibrium"))
    plan, side = figure.axes
    assert side.get_ylabel() == "z [m]" and side.get_xlabel() in ("x [m]", "y [m]")
    weight = f"weight {quantities.force_text(STANCES[name].weight)}"
    assert weight in words_of(figure)
    assert any(line.startswith("forces up to") for line in words_of(figure)) == (name in ("wall hand", "push"))


def test_a_failed_or_undecided_record_can_be_drawn():
    entries = dict(record_of(STANCES["polygon"], model="equilibrium"))
    entries |= {"verdict": "undecided", "reason": "boundary", "margin": None, "forces": [], "certificate": None}
    assert "undecided (boundary)" in words_of(answer_figure(Record(entries)))


def test_a_region_with_pyramids_takes_the_place_of_its_kind():
    stance = STANCES["wall hand"]
    region = trace_support_region(stance, cone="inscribed", sides=8)
    entries = dict(record_of(stance)) | {"cone": region.cone.as_record(), "region": region.as_record(), "com_margin": region.com_margin}
    words = words_of(answer_figure(Record(entries), compare_regions(stance)))
    assert f"inscribed, 8 sides, {quantities.area_text(region.inner_area)}" in words
    assert not any(line.startswith("inscribed, 4") for line in words)


def test_the_com_margin_is_that_of_the_cones_asked_for():
    stance = STANCES["wall hand"]
    regions = compare_regions(stance)
    for kind, region in regions.items():
        entries = dict(record_of(stance, model="equilibrium")) | {"cone": region.cone.as_record()}
        line = words_of(answer_figure(Record(entries), regions))[1]
        assert line.endswith(f"CoM margin {quantities.length_text(region.com_margin)}"), kind
    entries["cone"] = {"kind": "inscribed", "sides": 8, "heading": 0.0}
    assert "CoM margin" not in words_of(answer_figure(Record(entries), regions))[1]


@pytest.mark.parametrize("file", ["figure.gif", "figure", "figure.pdf.txt"])
def test_another_ending_is_refused_and_nothing_is_written(answers, tmp_path, file):
    with pytest.raises(InputError, match=r"figure.*a file that ends in \.pdf, \.png, \.svg is expected") as caught:
        save_figure(*answers["polygon"][:1], tmp_path / file)
    assert str(tmp_path / file) in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_nothing_is_left_when_drawing_or_writing_fails(answers, tmp_path, monkeypatch):
    record = answers["polygon"][0]
    kept = tmp_path / "kept.png"
    kept.write_bytes(b"as it was")

    def breaks(self, draft, **_):
        draft.write_bytes(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(Figure, "savefig", breaks)
    with pytest.raises(OSError, match="disk full"):
        save_figure(record, kept)
    assert [path.name for path in tmp_path.iterdir()] == ["kept.png"] and kept.read_bytes() == b"as it was"
    monkeypatch.undo()
    with pytest.raises(OSError):
        save_figure(record, tmp_path / "no_such_folder" / "figure.png")


def test_figures_never_solve(answers, tmp_path, monkeypatch):
    regions = {name: trace_support_region(stance) for name, stance in STANCES.items()}

    def solves(*_):
        raise AssertionError("a figure asked an engine")

    monkeypatch.setattr(engines, "engines_for", solves)
    monkeypatch.setattr(tracing, "engines_for", solves)
    for name, stance in STANCES.items():
        save_figure(answers[name][0], tmp_path / "figure.svg", answers[name][1])
        for thing in (regions[name], stance, stance.contacts, base_of_support(stance.contacts), answers[name][0]):
            draw(thing)


def test_drawing_works_without_a_screen_and_without_pyplot():
    code = "import sys, socp_statics.figures; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("name", STANCES)
def test_drawing_into_ones_own_axes_grows_their_view(name):
    stance = STANCES[name]
    figure = Figure(figsize=(5, 4))
    FigureCanvasAgg(figure)
    ax = figure.add_subplot()
    region = trace_support_region(stance)
    assert draw(region, ax) is ax and draw(stance, ax) is ax and draw(base_of_support(stance.contacts), ax) is ax
    figure.canvas.draw()
    assert ax.get_aspect() == 1.0
    (x_min, x_max), (y_min, y_max) = ax.get_xlim(), ax.get_ylim()
    assert all(Window(x_min, x_max, y_min, y_max).holds(p[:2]) for p in stance.contacts.points_W)
    assert not figure.legends
    labels = ax.get_legend_handles_labels()[1]
    assert len(set(labels)) == len(labels)


def test_each_thing_has_its_drawing():
    stance = STANCES["wall hand"]
    forces = check_equilibrium(stance).forces.entries()
    motion = check_equilibrium(STANCES["tipping"]).certificate
    axes = [
        draw_stance(stance, forces=forces),
        draw_stance([*stance.contacts]),
        draw_region(trace_support_region(stance)),
        draw_motion(motion, STANCES["tipping"]),
        draw_motion(motion.as_record(), STANCES["tipping"]),
    ]
    assert all(ax.get_xlabel() == "x [m]" for ax in axes)
    with pytest.raises(InputError, match="draw: a support region.* is expected, got int"):
        draw(3)
    assert figures.draw is draw


def test_names_may_contain_anything_a_person_types(tmp_path):
    names = ("$\\alpha_{", "a very long name of a contact that nobody would give")
    stance = Stance([sole(names[0], [0, 0.1, 0]), sole(names[1], [0, -0.1, 0])], [0, 0, 1], 60.0)
    save_figure(record_of(stance, "my_$problem with_a_very_long_name/" + 60 * "x"), tmp_path / "figure.pdf", compare_regions(stance))
    assert (tmp_path / "figure.pdf").stat().st_size > 1000


def test_a_picture_is_not_blank(answers, tmp_path):
    save_figure(answers["wall hand"][0], tmp_path / "figure.png", answers["wall hand"][1])
    pixels = imread(tmp_path / "figure.png")[..., :3].reshape(-1, 3)
    assert pixels.min() == 0.0 and pixels.max() == 1.0
    coloured = np.ptp(pixels, axis=1) > 0.3
    assert 0.02 < coloured.mean() < 0.5
