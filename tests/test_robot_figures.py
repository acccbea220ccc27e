"""Figures of robots: outlines are those of the shapes, cones have their angle, an answer's figure says what the answer says."""

import ast
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Polygon
from matplotlib.text import Text
from scipy.spatial import ConvexHull

from socp_statics import figures
from socp_statics.cases.problem import load_problem
from socp_statics.cases.record import Record
from socp_statics.cases.solve import solve
from socp_statics.comparison import compare_regions
from socp_statics.exceptions import InputError
from socp_statics.figures import answer_figure, draw, draw_robot, robot_views, save_figure
from socp_statics.figures.outlines import VIEWS, Body, back_to_front, nearest_depth, outline
from socp_statics.figures.quantities import force_text
from socp_statics.figures.style import ORANGE
from socp_statics.postures import GENERATORS, pose
from socp_statics.regions.polygon import area
from socp_statics.robots import Robot, Shape, load_robot
from socp_statics.stability import check_equilibrium

POSTURES = {
    "standing": ("standing", {}),
    "arms forward": ("standing", {"arms": "forward"}),
    "half squat": ("squat", {"knee": 1.0}),
    "deep squat": ("squat", {"knee": 2.0}),
    "one foot": ("single_stance", {}),
    "rolled feet": ("rolled_feet", {}),
}


@pytest.fixture(scope="module")
def postures():
    robot = load_robot("hoap2")
    return {name: GENERATORS.load(generator)(robot, **numbers) for name, (generator, numbers) in POSTURES.items()}


@pytest.fixture(scope="module")
def answers():
    names = {"region": "half_squat_2", "forces": "single_stance", "motion": "weak_knees", "push": "push_tips"}
    problems = {key: load_problem(f"hoap2/{name}") for key, name in names.items()}
    regions = {"region": compare_regions(problems["region"].stance())}
    return {key: (solve(problem), regions.get(key), problem.robot_posture) for key, problem in problems.items()}


def words_of(figure):
    return [text.get_text() for text in figure.texts] + [text.get_text() for one in figure.legends for text in one.get_texts()]


def support(points, directions):
    return (points @ directions.T).max(axis=0)


def surface(shape, n=240):
    """Points on the surface of a shape, in its own axes, extreme in every direction to 1e-4 of its size."""
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    if shape.kind == "box":
        return np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * shape.size
    if shape.kind == "cylinder":
        ends = np.repeat([-0.5, 0.5], n)[:, None] * shape.size[1]
        return np.hstack([np.vstack([ring, ring]) * shape.size[0], ends])
    polar = np.linspace(0, np.pi, n // 2)
    return shape.size[0] * np.vstack([np.hstack([np.sin(t) * ring, np.full((n, 1), np.cos(t))]) for t in polar])


def random_rotation(rng):
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


SHAPES = [("box", (0.3, 0.1, 0.2)), ("cylinder", (0.1, 0.4)), ("sphere", (0.15,))]


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize(("kind", "size"), SHAPES, ids=[s[0] for s in SHAPES])
def test_an_outline_is_the_hull_of_the_projected_surface(kind, size, view):
    rng = np.random.default_rng(3)
    shape = Shape("link", kind, size, np.zeros(3), np.eye(3))
    angle = np.linspace(0, 2 * np.pi, 180)
    directions = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for R_WS in (np.eye(3), np.eye(3)[:, [2, 0, 1]], *(random_rotation(rng) for _ in range(4))):
        body = Body(shape, R_WS, rng.normal(size=3))
        corners = outline(body, view)
        points = (body.p_WS + surface(shape) @ R_WS.T)[:, view.axes]
        # a circle of 72 corners lies 1 - cos(pi / 72) inside the round one
        assert np.abs(support(corners, directions) - support(points, directions)).max() < 1.1e-3 * max(size)
        assert ConvexHull(corners).vertices.size == len(corners)
        assert area(corners) > 0.0


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize(("kind", "size"), SHAPES, ids=[s[0] for s in SHAPES])
def test_the_nearest_depth_is_that_of_the_surface(kind, size, view):
    rng = np.random.default_rng(4)
    body = Body(Shape("link", kind, size, np.zeros(3), np.eye(3)), random_rotation(rng), rng.normal(size=3))
    points = body.p_WS + surface(body.shape) @ body.R_WS.T
    toward = np.array(view.toward)
    at = 0.999 * points + 0.001 * body.p_WS
    depth = nearest_depth(body, at[:, view.axes], view)
    assert (depth >= at @ toward - 1e-12).all()
    # the point of the surface that is nearest of all to the reader
    nearest = int(np.argmax(at @ toward))
    assert depth[nearest] == pytest.approx(points[nearest] @ toward, abs=0.01)
    assert np.isneginf(nearest_depth(body, np.array([[9.0, 9.0]]), view)).all()


def test_what_is_nearer_is_painted_later_though_its_centre_is_farther():
    view = VIEWS["front"]
    wall = Body(Shape("wall", "box", (2.0, 0.2, 0.2), np.zeros(3), np.eye(3)), np.eye(3), np.array([0.0, 0.0, 0.0]))
    plate = Body(Shape("plate", "box", (0.1, 1.0, 1.0), np.zeros(3), np.eye(3)), np.eye(3), np.array([0.5, 0.0, 0.0]))
    for bodies in ([wall, plate], [plate, wall]):
        order = [bodies[k].shape.link for k in back_to_front(bodies, [outline(b, view) for b in bodies], view)]
        assert order == ["plate", "wall"]


def test_soles_are_drawn_where_the_contacts_are(postures):
    for posture in postures.values():
        for name, view in VIEWS.items():
            ax = draw_robot(posture, view=name)
            soles = [a.get_xydata() for a in ax.get_children() if isinstance(a, Line2D) and a.get_linewidth() == 1.8]
            shapes = [a.get_xy() for a in ax.get_children() if isinstance(a, Polygon)]
            assert len(soles) == len(posture.contacts)
            for contact, drawn in zip(posture.contacts, soles, strict=True):
                points = contact.points_W[:, view.axes]
                assert np.allclose(drawn.min(axis=0), points.min(axis=0)) and np.allclose(drawn.max(axis=0), points.max(axis=0))
                # the URDF's sole box stands on the same rectangle
                extent = [points[:, 0].min(), points[:, 0].max(), points[:, 1].min()]
                assert any(np.allclose([xy[:, 0].min(), xy[:, 0].max(), xy[:, 1].min()], extent, atol=1e-9) for xy in shapes)


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("mu", [0.2, 0.5, 3.0])
def test_a_friction_cone_has_its_true_angle(view, mu):
    posture = pose(load_robot("hoap2"), {}, ["left_foot"], mu)
    ax = draw_robot(posture, view=view)
    cones = [a.get_xy() for a in ax.get_children() if isinstance(a, Polygon) and a.get_alpha() is not None]
    assert len(cones) == 2
    for corners in cones:
        low, high = corners[:, 1].min(), corners[:, 1].max()
        assert np.ptp(corners[:, 0]) / (high - low) == pytest.approx(2 * mu)
        assert low == pytest.approx(0.0, abs=1e-12)


def test_cones_are_seen_from_inside_where_a_hand_points_to_the_reader(postures):
    robot = load_robot("hoap2")
    posture = pose(robot, {}, ["left_foot", "left_hand"], 0.5)
    normal = posture.contacts["left_hand"].normal_W
    assert np.allclose(np.abs(normal), [1, 0, 0])
    round_ones = [
        a.get_xy() for a in draw_robot(posture, view="front").get_children() if isinstance(a, Polygon) and a.get_alpha() is not None
    ]
    widths = [np.ptp(corners, axis=0) for corners in round_ones]
    assert any(w[0] == pytest.approx(w[1], rel=1e-3) for w in widths)
    assert not any(isinstance(a, Line2D) and a.get_color() == ORANGE for a in draw_robot(posture, cones=False).get_children())


@pytest.mark.parametrize("name", POSTURES)
def test_two_views_to_one_scale_in_metres(postures, name):
    posture = postures[name]
    forces = check_equilibrium(posture).forces
    for columns, inches in ((1, 3.4), (2, 7.0)):
        figure = robot_views(posture, forces, columns=columns)
        figure.canvas.draw()
        side, front = figure.axes
        assert figure.get_figwidth() == pytest.approx(inches)
        assert (side.get_xlabel(), side.get_ylabel(), front.get_xlabel()) == ("x [m]", "z [m]", "y [m]")
        assert side.get_ylim() == front.get_ylim()
        sizes = [(ax.get_window_extent().width, ax.get_window_extent().height) for ax in (side, front)]
        scales = [np.ptp([ax.get_xlim(), ax.get_ylim()], axis=1) / size for ax, size in zip((side, front), sizes, strict=True)]
        assert np.allclose(scales, scales[0][0], rtol=1e-3)
        for ax, view in zip((side, front), VIEWS.values(), strict=True):
            points = np.vstack([posture.contacts.points_W, posture.com_W])[:, view.axes]
            for k, (low, high) in enumerate((ax.get_xlim(), ax.get_ylim())):
                assert (points[:, k] > low).all() and (points[:, k] < high).all()
        words = words_of(figure)
        assert {"contact", "friction cone", "CoM"} <= set(words) and any(w.startswith("forces up to") and w.endswith(" N") for w in words)


def test_forces_seen_at_one_point_are_added_and_drawn_to_scale(postures):
    posture = postures["standing"]
    forces = check_equilibrium(posture).forces
    ax = draw_robot(posture, forces=forces)
    arrows = [a for a in ax.get_children() if isinstance(a, FancyArrowPatch)]
    ends = [np.array(a._posA_posB) for a in arrows]
    lengths = np.array([np.linalg.norm(head - tail) for tail, head in ends])
    sums = {}
    for point, force in zip(forces.point_W, forces.force_W, strict=True):
        key = round(point[0], 6)
        sums[key] = sums.get(key, 0.0) + force[[0, 2]]
    expected = np.array([np.linalg.norm(sums[round(tail[0], 6)]) for tail, _ in ends])
    assert len(arrows) == 2 and np.allclose(lengths / lengths.max(), expected / expected.max())
    # the legend says both what a point carries and what the longest arrow is
    largest = np.linalg.norm(forces.force_W, axis=1).max()
    (words,) = [a.get_label() for a in arrows if str(a.get_label()).startswith("forces")]
    assert words == f"forces up to {force_text(largest)},\nsums up to {force_text(expected.max())}"


def test_a_robot_without_shapes_is_drawn_as_lines(postures):
    model = load_robot("hoap2")
    bare = Robot.from_pinocchio(model.pin_model, model.frames)
    posture = pose(bare, {}, ["left_foot", "right_foot"], 0.5)
    ax = draw(posture)
    bones = [a.get_xydata() for a in ax.get_children() if isinstance(a, Line2D) and a.get_linewidth() == 2.4]
    assert len(bones) == len(bare.joints) + len(bare.frames)
    assert any(np.allclose(b[-1], posture.contacts["left_foot"].position[[0, 2]]) for b in bones)


def test_another_view_or_width_is_refused(postures):
    with pytest.raises(InputError, match="view must be 'side' or 'front', got 'top'"):
        draw_robot(postures["standing"], view="top")
    with pytest.raises(InputError, match="columns must be 1 or 2, got 3"):
        robot_views(postures["standing"], columns=3)


def test_drawing_into_ones_own_axes_grows_their_view(postures):
    figure = Figure(figsize=(4, 4))
    FigureCanvasAgg(figure)
    ax = figure.add_subplot()
    assert draw(postures["standing"], ax) is ax
    figure.canvas.draw()
    assert ax.get_aspect() == 1.0 and not figure.legends
    assert ax.get_ylim()[0] < 0.0 and ax.get_ylim()[1] > 0.45


@pytest.mark.parametrize("ending", [".pdf", ".png", ".svg"])
@pytest.mark.parametrize("name", ["region", "motion"])
def test_the_same_answer_gives_the_same_bytes(answers, tmp_path, name, ending):
    record, regions, posture = answers[name]
    first, second = tmp_path / f"one{ending}", tmp_path / f"two{ending}"
    save_figure(record, first, regions, posture=posture)
    save_figure(Record(dict(record)), second, regions, posture=posture)
    assert first.read_bytes() == second.read_bytes()
    assert b"CreationDate" not in first.read_bytes() and b"/Type3" not in first.read_bytes()


def test_the_figure_of_a_robots_answer(answers):
    figure = answer_figure(*answers["region"])
    plan, side, front, shares, free = figure.axes
    words = words_of(figure)
    assert any(w.startswith("RLEG_JOINT4 at 7") or w.startswith("LLEG_JOINT4 at 7") for w in words)
    assert "regions with torque limits: frozen posture" in words
    (region,) = [w for w in words if w.startswith("torque-limited region, ")]
    assert 99.2 < float(region.split()[2]) < 99.6 and "base of support, 138.18 cm²" in words
    assert [ax.get_xlabel() for ax in (plan, side, front)] == ["x [m]", "x [m]", "y [m]"]
    assert len(shares.get_yticklabels()) == 25 and free.get_xlabel().endswith("[N m]")
    assert figure.get_figwidth() == pytest.approx(3.4)


def test_without_the_posture_the_record_still_has_its_bars(answers):
    record, regions, _ = answers["region"]
    assert [ax.get_xlabel()[:5] for ax in answer_figure(record, regions).axes] == ["x [m]", "share", "torqu"]
    assert len(answer_figure(answers["forces"][0]).axes) == 3
    assert len(answer_figure(answers["motion"][0]).axes) == 2


def test_an_unstable_robot_shows_how_its_joints_give_way(answers):
    record, _, posture = answers["motion"]
    assert record["reason"] == "torque" and record["certificate"]["joints"]
    figure = answer_figure(record, None, posture)
    assert "certified motion" in words_of(figure) and len(figure.axes) == 3
    # without the kinematics of the posture the velocities of the contacts are not known
    assert "certified motion" not in words_of(answer_figure(record))
    rates = np.array([record["certificate"]["joints"].get(joint, 0.0) for joint in posture.robot.joints])
    linear, angular, point = (np.array(record["certificate"][key]) for key in ("linear", "angular", "point"))
    velocity = linear + np.cross(angular, posture.com_W - point) + posture.com_jacobian @ rates
    arrow = [a for a in figure.axes[1].get_children() if isinstance(a, FancyArrowPatch)][-1]
    tail, head = np.array(arrow._posA_posB)
    assert np.allclose(tail, posture.com_W[[0, 2]])
    assert np.allclose((head - tail) / np.linalg.norm(head - tail), velocity[[0, 2]] / np.linalg.norm(velocity[[0, 2]]))


def test_arrows_of_a_motion_and_of_loads_have_one_scale_in_both_views(answers):
    record, _, posture = answers["push"]
    figure = answer_figure(record, None, posture)
    lengths = []
    for ax in figure.axes[1:3]:
        arrows = [np.array(a._posA_posB) for a in ax.get_children() if isinstance(a, FancyArrowPatch) and a.get_label() != "weight 61.25 N"]
        lengths.append({tuple(np.round(tail, 9)): head[1] - tail[1] for tail, head in arrows})
    rising = [[length for (_, z), length in found.items() if abs(z) < 1e-9] for found in lengths]
    assert len(rising[0]) == 1 and len(rising[1]) == 4 and np.allclose(rising[1], rising[0], rtol=0.05)
    assert "load 6.000 N" in words_of(figure)


@pytest.mark.parametrize("name", ["region", "forces", "motion", "push"])
@pytest.mark.parametrize("with_posture", [True, False])
def test_nothing_is_cut_off_or_written_over_another(answers, name, with_posture):
    record, regions, posture = answers[name]
    figure = answer_figure(record, regions, posture if with_posture else None)
    figure.canvas.draw()
    renderer, sheet = figure.canvas.get_renderer(), figure.bbox
    texts = [*figure.texts]
    for ax in figure.axes:
        texts += [text for text in ax.texts if text.get_text()]
        for axis, limits, k in ((ax.xaxis, sorted(ax.get_xlim()), 0), (ax.yaxis, sorted(ax.get_ylim()), 1)):
            if not axis.get_visible():
                continue
            ticks = axis.get_majorticklabels()
            texts += [t for t in ticks if t.get_visible() and t.get_text() and limits[0] <= t.get_position()[k] <= limits[1]]
            texts += [axis.label] if axis.label.get_visible() and axis.label.get_text() else []
    # a name may have a line that leads to its contact, which is not text
    boxes = [Text.get_window_extent(text, renderer) for text in texts] + [legend.get_window_extent(renderer) for legend in figure.legends]
    for k, one in enumerate(boxes):
        assert one.x0 >= sheet.x0 - 1 and one.x1 <= sheet.x1 + 1 and one.y0 >= sheet.y0 - 1 and one.y1 <= sheet.y1 + 1
        # the lines of a table touch; what is written over each other overlaps by more
        for other in boxes[:k]:
            assert min(one.x1, other.x1) - max(one.x0, other.x0) < 2 or min(one.y1, other.y1) - max(one.y0, other.y0) < 3


def test_no_file_of_the_figures_room_imports_pinocchio():
    for path in Path(figures.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any(name.split(".")[0] == "pinocchio" for name in names), path
