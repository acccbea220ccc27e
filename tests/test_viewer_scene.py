"""What the 3-D view shows, checked without a browser: counts, places and directions of its marks."""

from dataclasses import replace

import numpy as np
import pytest

from socp_statics.cases.answers import ANSWERS
from socp_statics.cases.hashing import plain
from socp_statics.cases.problem import load_problem, problem_from_tables
from socp_statics.cases.solve import solve
from socp_statics.contacts import ContactSet, Handle, PointContact, Stance, SurfaceContact
from socp_statics.engines import SINGLE
from socp_statics.postures import pose
from socp_statics.robots import Robot, load_robot
from socp_statics.stability import check_equilibrium
from socp_statics.viewer import ask
from socp_statics.viewer.body import body_marks
from socp_statics.viewer.floor_marks import REACH, base_marks, region_marks
from socp_statics.viewer.marks import Arrows, Frame, Lines, Name, Solid, dashed
from socp_statics.viewer.motion import BODY, CertifiedMotion
from socp_statics.viewer.scene import LAYERS, following, scene_of
from socp_statics.viewer.words import answer_html, answer_lines

KINDS = (
    "contacts/foot_and_wall_hand", "contacts/bar_hang", "contacts/soft_finger_elliptic", "contacts/frictionless_floor",
    "contacts/slope_block_inscribed", "contacts/slope_block_slides", "contacts/tilted_gravity", "contacts/unbounded_one_way",
    "contacts/table_minimax", "contacts/reference_forces", "degenerate/empty_region", "degenerate/line_contact", "degenerate/one_point",
    "degenerate/two_points", "degenerate/kilometre_away", "degenerate/ten_millimetres", "hoap2/hands_on_the_wall", "hoap2/push_tips",
    "hoap2/torque_infeasible", "hoap2/weak_knees",
)  # fmt: skip


def asked(name, **values):
    problem = load_problem(name)
    problem = problem.with_values(values) if values else problem
    return ask(problem, solve(problem, SINGLE), SINGLE)


def drawn(question):
    scene = scene_of(question)
    return scene, following(scene, question.stance, question.record)


def triangles(solid):
    corners = solid.vertices[solid.faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_of_problem_has_a_scene(name):
    question = asked(name)
    scene, moving = drawn(question)
    marks = [*scene.still, *moving.marks]
    assert len({mark.name for mark in marks}) == len(marks)
    assert {mark.name.split("/")[0] for mark in marks} <= set(LAYERS)
    for mark in marks:
        assert all(np.isfinite(part).all() for part in mark if isinstance(part, np.ndarray))
    contacts = question.stance.contacts
    assert [mark.text for mark in marks if isinstance(mark, Name)] == list(contacts.names)
    rough = sum(len(c.points_W) for c in contacts if c.unilateral and c.friction > 0)
    smooth = sum(len(c.points_W) for c in contacts if c.unilateral and c.friction == 0)
    assert sum(mark.name.startswith("cones/") and mark.name.endswith("/cone") for mark in marks) == rough
    assert sum(mark.name.startswith("cones/") and mark.name.endswith("/normal") for mark in marks) == smooth
    frames = [mark for mark in marks if isinstance(mark, Frame)]
    posture = question.stance.posture
    assert len(frames) == (1 if posture is None else posture.robot.pin_model.njoints - 1)
    assert (moving.motion is not None) == (question.record["verdict"] == "unstable")
    if posture is not None:
        assert sum(isinstance(mark, Solid) and mark.name.startswith("body/") for mark in marks) == len(posture.robot.shapes)


@pytest.mark.parametrize("name", ["hoap2/hands_on_the_wall", "contacts/backpack", "contacts/ladder", "contacts/table_minimax"])
def test_force_arrows_are_the_forces_of_the_record_to_one_scale_and_balance(name):
    question = asked(name)
    scene, moving = drawn(question)
    arrows = {mark.name: mark for mark in moving.marks if isinstance(mark, Arrows)}
    shown = arrows["forces/contacts"]
    entries = question.record["forces"]
    assert len(entries) >= len(shown.tails) > 0
    for tail, way in zip(shown.tails, shown.ways, strict=True):
        match = [e for e in entries if np.allclose(e["point"], tail, atol=1e-12) and np.allclose(scene.scale * np.array(e["force"]), way)]
        assert match
    parts = [arrows[f"forces/{kind}"].ways.sum(axis=0) for kind in ("contacts", "weight", "loads")]
    left_out = 1e-3 * len(entries) * 0.45 * scene.extent
    assert np.linalg.norm(sum(parts)) <= left_out
    assert np.allclose(arrows["forces/weight"].tails, question.stance.com)
    longest = max(np.linalg.norm(way) for mark in arrows.values() for way in mark.ways)
    assert longest == pytest.approx(0.45 * scene.extent)


def test_a_capability_is_shown_at_its_largest_load_with_what_stops_more_and_follows():
    question = asked("hoap2/payload_in_front")
    _, moving = drawn(question)
    limit = question.record["capability"]
    arrows = {mark.name: mark for mark in moving.marks if isinstance(mark, Arrows)}
    assert np.allclose(arrows["forces/loads"].tails[-1], limit["point"]) and moving.motion is not None
    parts = [arrows[f"forces/{kind}"].ways.sum(axis=0) for kind in ("contacts", "weight", "loads")]
    assert np.linalg.norm(sum(parts)) <= 1e-2 * np.linalg.norm(arrows["forces/weight"].ways)
    _, other = question.moved_to(question.stance.com[:2] - [0.01, 0.0])
    assert other["objective"] > question.record["objective"]


def test_what_does_not_follow_the_centre_of_mass_is_not_shown_for_another_one(monkeypatch):
    question = asked("hoap2/payload_in_front")
    answer = ANSWERS.load("capability")
    monkeypatch.setattr(type(ANSWERS), "load", lambda self, name: replace(answer, follows_com=False))
    _, record = question.moved_to(question.stance.com[:2])
    assert "capability" not in record and record["verdict"] == question.record["verdict"] and record["objective"] is None
    assert dict(answer_lines(record))["verdict"] == "stable"


def test_cones_are_exact_and_stand_on_the_contact_points():
    question = asked("contacts/foot_and_wall_hand")
    for contact in question.stance.contacts:
        cones = [m for m in scene_of(question).still if m.name.startswith(f"cones/{contact.name}/") and isinstance(m, Solid)]
        assert np.allclose([cone.vertices[0] for cone in cones], contact.points_W)
        for cone in cones:
            f_C = (cone.vertices[1:] - cone.vertices[0]) @ contact.rotation
            assert np.allclose(np.linalg.norm(f_C[:, :2], axis=1), contact.friction * f_C[:, 2])
            assert np.allclose(np.linalg.norm(f_C, axis=1), np.linalg.norm(f_C[0]))
            outward = triangles(cone) @ contact.rotation
            assert (outward[:, 2] < 0).all()  # seen from outside, the side of a cone looks down


def test_a_pyramid_is_drawn_over_the_exact_cone():
    question = asked("contacts/slope_block_inscribed")
    (contact,) = question.stance.contacts
    pyramid = next(mark for mark in scene_of(question).still if mark.name == f"cones/{contact.name}/0/pyramid")
    sides = question.problem.cone.sides
    assert len(pyramid.pieces) == 2 * sides
    corners = (pyramid.pieces[:sides, 1] - contact.points_W[0]) @ contact.rotation
    assert np.allclose(np.linalg.norm(corners[:, :2], axis=1), contact.friction * corners[:, 2])


def test_the_floor_shows_the_region_and_the_base_of_support():
    question = asked("hoap2/hands_on_the_wall")
    stance, region = question.stance, question.region
    inner, outer = region_marks(region, stance.contacts, 1.0)
    assert np.allclose(inner.vertices[:, :2], region.inner)
    assert 0.5 * triangles(inner)[:, 2].sum() == pytest.approx(region.inner_area)
    assert np.allclose(outer.pieces[:, 0, :2], region.outer)
    assert np.allclose(inner.vertices[:, 2], stance.contacts.points_W[:, 2].min(), atol=0.01)
    (base,) = base_marks(stance.contacts, 1.0)
    from socp_statics.regions import base_of_support

    assert np.allclose(base_of_support(stance.contacts).margin(base.pieces[..., :2]), 0.0, atol=1e-12)


def test_regions_without_an_area_or_an_end_and_none():
    contacts = {name: asked(name) for name in ("contacts/unbounded_one_way", "degenerate/two_points", "degenerate/one_point")}
    extent = 1.0
    for question in contacts.values():
        marks = region_marks(question.region, question.stance.contacts, extent)
        centre = question.stance.contacts.centre[:2]
        if question.region.kind == "unbounded":
            flat = marks[0].vertices[:, :2]
            assert np.abs(flat - centre).max() == pytest.approx(REACH * extent)
            assert (question.region.margin(flat) >= -1e-9).all()
        elif question.region.kind == "segment":
            assert np.allclose(marks[0].pieces[0, :, :2], question.region.inner[[0, -1]])
        else:
            assert question.region.kind == "point" and len(marks) == 1
    empty = asked("degenerate/empty_region")
    assert empty.region.kind == "empty" and region_marks(empty.region, empty.stance.contacts, extent) == []
    assert region_marks(None, empty.stance.contacts, extent) == []


def test_the_shapes_of_a_robot_are_where_its_links_are():
    posture = load_problem("hoap2/hands_on_the_wall").robot_posture
    marks = body_marks(posture.stance(), 1.0)
    frames = {mark.name: mark for mark in marks if isinstance(mark, Frame)}
    solids = [mark for mark in marks if isinstance(mark, Solid)]
    for shape, solid in zip(posture.robot.shapes, solids, strict=True):
        frame = frames[solid.name.rsplit("/", 1)[0]]
        middle = frame.rotation @ (0.5 * (solid.vertices.min(axis=0) + solid.vertices.max(axis=0))) + frame.position
        R_WF, p_WF = posture.link_placement(shape.link)
        assert np.allclose(middle, p_WF + R_WF @ shape.position, atol=2e-3)
        if shape.kind == "box":
            assert np.prod(shape.size) == pytest.approx(np.abs((triangles(solid) * solid.vertices[solid.faces[:, 0]]).sum()) / 6.0)


def test_a_robot_without_shapes_is_a_skeleton_that_reaches_its_contacts():
    hoap2 = load_robot("hoap2")
    bare = Robot.from_pinocchio(hoap2.pin_model, hoap2.frames, torque_limits_real=False)
    posture = pose(bare, {"LARM_JOINT1": -1.0}, support=["left_foot", "right_foot", "left_hand"])
    marks = body_marks(posture.stance(), 1.0)
    frames = {mark.name: mark for mark in marks if isinstance(mark, Frame)}
    bones = [mark for mark in marks if isinstance(mark, Solid) and "/bone_" in mark.name]
    assert len(frames) == len([mark for mark in marks if mark.name.endswith("/joint")]) == bare.pin_model.njoints - 1
    for contact in posture.contacts:
        (bone,) = [mark for mark in bones if mark.name.endswith(f"/bone_to_{contact.name}")]
        frame = frames[bone.name.rsplit("/", 1)[0]]
        points = bone.vertices @ frame.rotation.T + frame.position
        assert np.linalg.norm(points - contact.position, axis=1).min() <= 0.0081


@pytest.mark.parametrize("name", ["contacts/slope_block_slides", "contacts/push_tips", "hoap2/push_tips", "hoap2/weak_knees",
                                  "hoap2/torque_infeasible"])  # fmt: skip
def test_the_motion_that_is_played_begins_as_the_certificate_says(name):
    question = asked(name)
    motion = CertifiedMotion(question.record["certificate"], question.stance)
    points, share = question.stance.contacts.points_W, 1e-6
    still, moved = motion.bodies(0.0), motion.bodies(share)
    posture = question.stance.posture
    found = []
    for contact in question.stance.contacts:
        body = BODY
        if posture is not None:
            frame = posture.robot.pin_model.frames[posture.robot.frame_id(posture.robot.frames[contact.name].frame)]
            body = posture.robot.pin_model.names[frame.parentJoint]
        local = (contact.points_W - still[body].position) @ still[body].rotation
        found.append(local @ moved[body].rotation.T + moved[body].position - contact.points_W)
    found = np.vstack([*found, motion.com(share) - question.stance.com])
    expected = motion.velocities * motion.duration * share
    assert np.allclose(found, expected, atol=1e-4 * np.abs(expected).max())
    end = max(np.linalg.norm(motion.com(1.0) - question.stance.com), 1e-12)
    assert end < question.stance.contacts.size
    if motion.turns:
        through, along = motion.axis()
        certificate = question.record["certificate"]
        here = certificate["linear"] + np.cross(certificate["angular"], through - certificate["point"])
        assert np.allclose(np.cross(here, along), 0.0, atol=1e-9)
    if name == "hoap2/weak_knees":
        assert question.record["certificate"]["joints"] and not motion.turns
    assert len(points) + 1 == len(motion.velocities)


def test_com_margin_and_verdict_follow_the_centre_of_mass_as_if_the_file_had_said_so():
    question = asked("contacts/foot_and_wall_hand")
    com = question.stance.com
    for xy in ([0.25, 0.02], [0.05, -0.04], [-1.0, 0.0]):
        stance, record = question.moved_to(xy)
        stated = asked("contacts/foot_and_wall_hand", **{"posture.com": [*xy, float(com[2])]}).record
        assert stance.com.tolist() == [*xy, com[2]] == record["case"]["generated"]["com"]
        assert record["verdict"] == stated["verdict"]
        for key in ("margin", "com_margin"):
            assert record[key] == stated[key] if isinstance(stated[key], str) else record[key] == pytest.approx(stated[key], rel=2e-3)
        assert bool(record["forces"]) == (record["verdict"] == "stable")


def test_a_robot_keeps_its_posture_its_torque_limits_and_its_region():
    question = asked("hoap2/weak_knees")
    _, record = question.moved_to(question.stance.com[:2] + [0.01, 0.0])
    answer = check_equilibrium(replace(question.stance, com=question.stance.com + [0.01, 0.0, 0.0]), engine=SINGLE)
    assert record["margin"] == plain(answer.margin) and record["verdict"] == answer.verdict
    assert record["torque_limits"] == question.record["torque_limits"]
    region = asked("hoap2/double_stance")
    _, moved = region.moved_to([1.0, 0.0])
    assert moved["verdict"] == "unstable" and moved["status"] == "solved" and moved["com_margin"] < 0
    assert moved["region"] == region.record["region"] and moved["expect"] == []


def test_the_forces_that_a_model_asks_for_follow_too():
    question = asked("contacts/table_minimax")
    _, same = question.moved_to(question.stance.com[:2])
    assert same["objective"] == pytest.approx(question.record["objective"]) and same["forces"] == question.record["forces"]
    _, other = question.moved_to(question.stance.com[:2] + [0.05, 0.02])
    assert other["objective"] > question.record["objective"]


def test_the_safety_offset_follows_too():
    question = asked("contacts/safety_zone")
    _, same = question.moved_to(question.stance.com[:2])
    assert same["safety"] == question.record["safety"]
    _, away = question.moved_to([5.0, 5.0])
    assert not away["safety"]["in_region"] and not away["safety"]["in_base"]


def test_without_vertical_gravity_there_is_no_region_to_show():
    tables = {
        "model": "equilibrium",
        "posture": {
            "generator": "contacts", "mass": 1.0, "com": [0.0, 0.0, 0.0], "gravity": [0.0, 0.0, 0.0],
            "contacts": [{"name": "a", "type": "point", "position": [1, 0, 0], "normal": [-1, 0, 0], "friction": 0.5},
                         {"name": "b", "type": "point", "position": [-1, 0, 0], "normal": [1, 0, 0], "friction": 0.5}],
        },
    }  # fmt: skip
    problem = problem_from_tables(tables, "afloat")
    question = ask(problem, solve(problem, SINGLE), SINGLE)
    scene, _ = drawn(question)
    assert question.region is None and not [mark for mark in scene.still if mark.name.startswith("region/")]
    assert question.moved_to([0.0, 0.1])[1]["com_margin"] is None


def test_points_and_handles_are_drawn_as_dots_and_boxes_and_walls_as_plates():
    floor = SurfaceContact("sole", (0, 0, 0), normal=(0, 0, 1), friction=0.5, size=(0.2, 0.1))
    wall = PointContact("palm", (0.4, 0, 1), normal=(-1, 0, 0), friction=0.5)
    grip = Handle("grip", (0, 0.3, 1), normal=(0, 0, 1), transmits=["fx", "fz"])
    from socp_statics.viewer.contact_marks import contact_marks

    marks = {mark.name: mark for mark in contact_marks(ContactSet([floor, wall, grip]), 1.0)}
    assert set(marks) == {f"contacts/{rest}" for rest in ("sole/outline", "sole/name", "palm/point", "palm/carrier", "palm/name",
                                                          "grip/point", "grip/name")}  # fmt: skip
    plate = marks["contacts/palm/carrier"].vertices
    assert np.allclose(plate[:, 0], plate[0, 0]) and 0.4 < plate[0, 0] < 0.41
    assert len(marks["contacts/grip/point"].vertices) == 8 and np.allclose(marks["contacts/palm/point"].vertices.mean(axis=0), [0.4, 0, 1])


def test_dashes_begin_and_end_where_the_line_does():
    line = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]])
    pieces = dashed(line, 0.1)
    assert np.allclose(pieces[0, 0], line[0, 0]) and np.allclose(pieces[-1, 1], line[0, 1]) and len(pieces) == 6
    lengths = np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1)
    assert np.allclose(lengths, lengths[0]) and lengths.sum() == pytest.approx(6 / 11)
    assert dashed(line, 3.0).shape == (1, 2, 3)


def test_the_words_are_those_of_the_summary_and_cannot_break_the_page():
    record = asked("hoap2/push_tips").record
    words = dict(answer_lines(record))
    assert words["verdict"] == "unstable" and words["because"].startswith("tips about the back edge of left_foot")
    assert words["CoM margin"].endswith("outside the region")
    named = {**record, "verdict": "unstable", "certificate": {**record["certificate"], "reading": "opens at <script>&"}}
    assert "opens at &lt;script&gt;&amp;" in answer_html(named) and "<script>" not in answer_html(named)


def test_a_stance_of_one_point_below_its_centre_of_mass_has_an_extent():
    stance = Stance(ContactSet([PointContact("tip", (0, 0, 0), normal=(0, 0, 1), friction=0.5)]), (0, 0, 0), 1.0)
    marks = body_marks(stance, 1.0)
    assert isinstance(marks[0], Frame) and not any(isinstance(mark, Lines) for mark in marks)
