"""Contacts and their joints: (3.5)-(3.8), (3.10), (3.15)-(3.23), and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from socp_statics.contacts import (
    CONTACT_TYPES,
    FrictionlessPointContact,
    FrictionlessSurfaceContact,
    Handle,
    LineContact,
    PointContact,
    SoftFingerContact,
    SurfaceContact,
    contact_from_statement,
)
from socp_statics.contacts import joint as j
from socp_statics.exceptions import InputError, StaticsError

UP = (0.0, 0.0, 1.0)
R = np.array([[0.0, -0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, 0.6]])
P = (0.3, -0.2, 1.0)
NAN, INF = float("nan"), float("inf")
SAMPLES = {
    "point": PointContact("c", P, R, friction=0.5, normal_force=[10, 200]),
    "surface": SurfaceContact("c", P, R, friction=0.6, size=[0.2, 0.1]),
    "line": LineContact("c", P, R, friction=0.4, size=[0.3]),
    "soft_finger": SoftFingerContact("c", P, R, friction=0.5, torsional_friction=0.02, shape="box"),
    "frictionless_point": FrictionlessPointContact("c", P, R, normal_force=[0, INF]),
    "frictionless_surface": FrictionlessSurfaceContact("c", P, R, vertices=[[0, 0], [0.2, 0], [0, 0.1]]),
    "handle": Handle("c", P, R, transmits=["mz", "fx", "fz", "mx"], limits={"fx": (-100, 50), "mz": (-INF, 2)}),
}
HARD = {"point": ("fz",), "surface": ("fz", "mx", "my"), "line": ("fz", "my"), "soft_finger": ("fz",), "frictionless_point": ("fz",),
        "frictionless_surface": ("fz", "mx", "my"), "handle": ("fx", "fz", "mx", "mz")}  # fmt: skip
SOFT = {"point": ("fx", "fy"), "surface": ("fx", "fy", "mz"), "line": ("fx", "fy", "mz"), "soft_finger": ("fx", "fy", "mz"),
        "frictionless_point": (), "frictionless_surface": (), "handle": ()}  # fmt: skip


@pytest.fixture(params=SAMPLES)
def contact(request):
    return SAMPLES[request.param]


def test_there_is_a_sample_of_every_type():
    assert set(SAMPLES) == set(CONTACT_TYPES)
    assert all(type(c) is CONTACT_TYPES[word] and c.type == word for word, c in SAMPLES.items())


# Geometry.


def test_points_lie_in_the_contact_plane(contact):
    assert contact.points_W.shape == (len(contact.points_C), 3)
    np.testing.assert_allclose((contact.points_W - np.array(P)) @ R[:, :2], contact.points_C, atol=1e-15)
    np.testing.assert_allclose((contact.points_W - np.array(P)) @ contact.normal_W, 0.0, atol=1e-15)


def test_points_of_each_type():
    counts = {word: len(c.points_C) for word, c in SAMPLES.items()}
    single = dict.fromkeys(("point", "soft_finger", "frictionless_point", "handle"), 1)
    assert counts == {"surface": 4, "line": 2, "frictionless_surface": 3} | single
    assert {tuple(p) for p in SAMPLES["surface"].points_C} == {(0.1, 0.05), (-0.1, 0.05), (-0.1, -0.05), (0.1, -0.05)}
    assert {tuple(p) for p in SAMPLES["line"].points_C} == {(0.15, 0.0), (-0.15, 0.0)}
    np.testing.assert_allclose(SAMPLES["line"].points_W[0] - SAMPLES["line"].points_W[1], 0.3 * R[:, 0])


def test_only_handles_are_bilateral(contact):
    assert contact.unilateral == (contact.type != "handle")


def test_contacts_are_immutable(contact):
    for key in ("name", "position", "friction", "points_C", "anything"):
        with pytest.raises(AttributeError, match="immutable"):
            setattr(contact, key, None)
    for key in ("position", "rotation", "points_C"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(contact, key)[0] = 1.0


def test_a_contact_keeps_its_own_copy_of_what_it_was_given():
    p, vertices = np.zeros(3), np.array([[0.0, 0], [1, 0], [0, 1]])
    contact = SurfaceContact("c", p, normal=UP, friction=0.5, vertices=vertices)
    p[0], vertices[0] = 9.0, -9.0
    assert contact.position[0] == 0.0 and contact.vertices.min() == 0.0


def test_a_statement_can_be_stated_again(contact):
    statement = contact.statement()
    again = contact_from_statement(statement)
    assert type(again) is type(contact)
    assert again.statement() == statement
    np.testing.assert_array_equal(again.points_W, contact.points_W)
    np.testing.assert_array_equal(again.rotation, contact.rotation)
    for key in ("normal_force", "friction", "hard", "soft", "limits", "shape", "torsional_friction"):
        assert getattr(again, key, None) == getattr(contact, key, None)


# Joints.


def test_hard_and_soft_directions(contact):
    assert (contact.hard, contact.soft) == (HARD[contact.type], SOFT[contact.type])
    index = [j.COMPONENTS.index(word) for word in contact.hard]
    np.testing.assert_array_equal(j.hard_basis(contact), np.eye(6)[:, index])
    np.testing.assert_array_equal(j.soft_basis(contact), np.eye(6)[:, [j.COMPONENTS.index(word) for word in contact.soft]])


@pytest.mark.parametrize("word", ["point", "surface", "line", "soft_finger"])
def test_friction_zero_means_the_frictionless_type(word):
    smooth = contact_from_statement(SAMPLES[word].statement() | {"friction": 0})
    assert smooth.frictionless and smooth.soft == () and smooth.hard == HARD[word]


@pytest.mark.parametrize("word", ["frictionless_point", "frictionless_surface"])
def test_a_frictionless_contact_may_say_friction_zero(word):
    assert contact_from_statement(SAMPLES[word].statement() | {"friction": 0}).friction == 0.0
    with pytest.raises(InputError, match="friction is not a key"):
        contact_from_statement(SAMPLES[word].statement() | {"friction": 0.1})


def test_constraint_and_mobility_bases_complete_each_other(contact):
    B_c, B_m = j.constraint_basis(contact), j.mobility_basis(contact)
    assert B_c.shape[1] + B_m.shape[1] == 6
    np.testing.assert_array_equal(np.abs(np.linalg.det(np.hstack([B_c, B_m]))), 1.0)
    np.testing.assert_array_equal(B_c.T @ B_m, 0.0)
    np.testing.assert_array_equal(B_c @ B_c.T + B_m @ B_m.T, np.eye(6))


def test_the_complement_is_the_set_of_the_other_columns():
    # D8: "E - B" of (3.19) has no meaning for a 6 x c matrix; twice complemented is the same set.
    B = j.basis(["my", "fz", "mx"])
    np.testing.assert_array_equal(j.complement(B), np.eye(6)[:, [0, 1, 5]])
    np.testing.assert_array_equal(j.complement(j.complement(B)), B)
    assert j.complement(np.eye(6)).shape == (6, 0)
    assert j.complement(np.zeros((6, 0))).shape == (6, 6)
    with pytest.raises(ValueError):
        np.eye(6) - B


def test_a_hand_on_a_bar_transmits_four_components():
    printed = np.zeros((6, 4))  # (3.6)
    printed[[0, 2, 3, 5], range(4)] = 1.0
    np.testing.assert_array_equal(j.constraint_basis(SAMPLES["handle"]), printed)
    np.testing.assert_array_equal(j.contact_wrench(printed, [1, 2, 3, 4]), [1, 0, 2, 3, 0, 4])


def test_a_frictionless_sole_transmits_three_components():
    printed = np.zeros((6, 3))  # (3.7)
    printed[[2, 3, 4], range(3)] = 1.0
    B_c = j.constraint_basis(SAMPLES["frictionless_surface"])
    np.testing.assert_array_equal(B_c, printed)
    np.testing.assert_array_equal(j.contact_wrench(B_c, [700.0, 3.0, -2.0]), [0, 0, 700, 3, -2, 0])


def test_joints_suppress_what_they_do_not_transmit(contact):
    rng = np.random.default_rng(1)
    B_c, B_m = j.constraint_basis(contact), j.mobility_basis(contact)
    wrench, twist = j.contact_wrench(B_c, rng.normal(size=B_c.shape[1])), j.contact_twist(B_m, rng.normal(size=B_m.shape[1]))
    np.testing.assert_array_equal(j.untransmitted_wrench(B_m, wrench), 0.0)
    np.testing.assert_array_equal(j.suppressed_twist(B_c, twist), 0.0)
    assert wrench @ twist == 0.0


@pytest.mark.parametrize("word", ["point", "surface", "line", "soft_finger"])
def test_sliding_lies_in_the_soft_directions(word):
    # D7: (3.21) and (3.23) print B_c, the hard directions of the frictionless joint; friction would then do no work.
    contact = SAMPLES[word]
    rng = np.random.default_rng(2)
    f_s, v_s = rng.normal(size=(2, len(contact.soft)))
    wrench, twist = j.friction_wrench(contact, f_s), j.sliding_twist(contact, v_s)
    np.testing.assert_array_equal(j.friction_components(contact, wrench), f_s)
    np.testing.assert_array_equal(j.sliding_velocity(contact, twist), v_s)
    assert wrench @ twist == pytest.approx(f_s @ v_s)
    np.testing.assert_array_equal(j.hard_basis(contact).T @ twist, 0.0)


def test_the_printed_basis_has_the_wrong_size_for_a_point():
    printed = j.hard_basis(SAMPLES["point"])
    assert printed.shape == (6, 1)
    with pytest.raises(ValueError):
        printed @ np.array([0.1, 0.2])
    assert j.sliding_twist(SAMPLES["point"], [0.1, 0.2]).tolist() == [0.1, 0.2, 0, 0, 0, 0]
    # For a sole both have three columns, which hides the slip; yet the printed one lifts and tips instead of sliding.
    assert j.hard_basis(SAMPLES["surface"]).shape == j.soft_basis(SAMPLES["surface"]).shape
    assert (j.hard_basis(SAMPLES["surface"]) @ [0.1, 0, 0])[2] == 0.1


def test_complementarity_is_zero_while_holding_or_open():
    np.testing.assert_array_equal(j.complementarity([5.0, 0.0, 2.0], [0.0, 3.0, 1.0]), [0.0, 0.0, 2.0])


def test_sliding_friction_opposes_the_velocity_on_the_cone():
    v = np.random.default_rng(4).normal(size=(6, 2))
    f_n = np.arange(1.0, 7.0)
    f = np.column_stack([-0.4 * f_n[:, None] * v / np.linalg.norm(v, axis=1, keepdims=True), f_n])
    np.testing.assert_allclose(j.sliding_friction_residual(f, v, 0.4), 0.0, atol=1e-14)
    assert np.abs(j.sliding_friction_residual(f * [-1, -1, 1], v, 0.4)).max() > 0.1
    assert j.sliding_friction_residual(f[0], v[0], 0.4).shape == (2,)


# Orientation.


@pytest.mark.parametrize("n", [(0, 0, 1), (0, 0, -2), (0.3, -0.2, 0.9), (-1, 0, 0.2), (0, 5, 0), (0.98, 0.1, 0.1)])
def test_t1_of_a_normal_is_world_x_projected(n):
    rotation = PointContact("c", P, normal=n, friction=0.5).rotation
    unit = np.array(n) / np.linalg.norm(n)
    assert abs(unit[0]) <= 0.99
    t1 = np.array([1.0, 0, 0]) - unit[0] * unit
    t1 /= np.linalg.norm(t1)
    np.testing.assert_allclose(rotation, np.column_stack([t1, np.cross(unit, t1), unit]), atol=1e-15)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("n", [(1, 0, 0), (-1, 0, 0), (-1, 0.1, 0.05)])
def test_t1_of_a_normal_along_x_is_world_y_projected(n):
    rotation = PointContact("c", P, normal=n, friction=0.5).rotation
    unit = np.array(n) / np.linalg.norm(n)
    assert abs(unit[0]) > 0.99
    assert rotation[:, 0] @ unit == pytest.approx(0.0, abs=1e-15) and rotation[1, 0] > 0.9
    assert rotation[:, 0] @ np.cross(unit, [0, 1, 0]) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("scale", [1e-300, 1e-30, 1e30, 1e300])
def test_normals_of_any_length_are_normalised(scale):
    rotation = PointContact("c", P, normal=np.array([0.3, 0.4, 1.2]) * scale, friction=0.5).rotation
    np.testing.assert_allclose(rotation[:, 2], np.array([0.3, 0.4, 1.2]) / 1.3, atol=1e-15)


def test_rpy_is_yaw_after_pitch_after_roll():
    r, p, y = 0.3, -0.5, 1.1
    Rx = np.array([[1, 0, 0], [0, np.cos(r), -np.sin(r)], [0, np.sin(r), np.cos(r)]])
    Ry = np.array([[np.cos(p), 0, np.sin(p)], [0, 1, 0], [-np.sin(p), 0, np.cos(p)]])
    Rz = np.array([[np.cos(y), -np.sin(y), 0], [np.sin(y), np.cos(y), 0], [0, 0, 1]])
    np.testing.assert_allclose(PointContact("c", P, rpy=[r, p, y], friction=0.5).rotation, Rz @ Ry @ Rx, atol=1e-15)


def test_a_rotation_within_a_millionth_is_made_orthonormal():
    off = np.random.default_rng(5).uniform(-4e-7, 4e-7, (3, 3)) / 2
    rotation = PointContact("c", P, R + off, friction=0.5).rotation
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(rotation, R, atol=1e-6)


# Polygons.

TRIANGLE = [[0.0, 0.0], [0.2, 0.0], [0.0, 0.1]]


def corners(vertices):
    return SurfaceContact("c", P, R, friction=0.5, vertices=vertices).vertices


@pytest.mark.parametrize("vertices", [
    TRIANGLE,
    TRIANGLE[::-1],
    [TRIANGLE[0], TRIANGLE[0], *TRIANGLE[1:], TRIANGLE[2], TRIANGLE[0]],
    [[0, 0], [0.05, 0], [0.1, 0], [0.2, 0], [0.1, 0.05], [0, 0.1], [0, 0.02]],
    [[0.1, 0], *TRIANGLE[1:], TRIANGLE[0]],
])  # fmt: skip
def test_polygons_are_cleaned_and_counter_clockwise(vertices):
    found = corners(vertices)
    assert {tuple(p) for p in found.tolist()} == {tuple(p) for p in TRIANGLE}
    x, y = found.T
    assert 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)) == pytest.approx(0.01)


@pytest.mark.parametrize("scale", [1e-4, 1e4])
def test_polygons_of_any_size(scale):
    assert len(corners(scale * np.array(TRIANGLE))) == 3


def star(points, step):
    a = 2 * np.pi * step * np.arange(points) / points
    return np.column_stack([np.cos(a), np.sin(a)])


# What is refused: a call, the contact it names and the field.


def given(kind=PointContact, /, **keys):
    defaults = {"position": P, "friction": 0.5} | ({"rotation": R} if not {"normal", "rpy", "rotation"} & set(keys) else {})
    if kind in (FrictionlessPointContact, FrictionlessSurfaceContact, Handle):
        defaults.pop("friction")
    return lambda: kind("knee", **(defaults | keys))


def stated(**keys):
    return lambda: contact_from_statement({"name": "knee", "type": "point", "position": P, "normal": UP, "friction": 0.5} | keys)


MIRROR = R * [1, 1, -1]
BACK_AND_FORTH = [[0, 0], [1, 0], [2, 0], [1, 0], [0, 1]]
WRONG_CALLS = {
    "position": [given(position=p) for p in ([0, 0], [0, NAN, 0], [0, INF, 0], "here", None, [[0, 0, 0]], [1j, 0, 0])],
    "friction": [given(friction=mu) for mu in (-0.1, NAN, INF, "rough", None, True, [0.5], 10**400)]
    + [stated(type="handle"), stated(friction="rough")],
    "rotation": [given(rotation=r) for r in (None, MIRROR, R * 1.001, R + 1e-5, np.zeros((3, 3)), R * NAN, np.full((3, 3), INF), R.ravel())]
    + [given(rotation=R, normal=UP), given(normal=UP, rpy=[0, 0, 0])],
    "normal": [given(normal=n) for n in ((0, 0, 0), (0, NAN, 1), (0, INF, 1), (0, 1))],
    "rpy": [given(rpy=angles) for angles in ([0, 0], [0, 0, NAN])],
    "normal_force": [given(normal_force=b) for b in ([-1, 5], [5, 1], [0, NAN], [1], 7.0, [INF, INF], "low")],
    "size": [given(SurfaceContact, size=s) for s in (None, [1, 0], [1, -1], [1], [1, NAN])]
    + [given(LineContact, size=s) for s in ([0], [-1], [1, 2], [NAN], None)]
    + [given(SurfaceContact, size=[1, 1], vertices=TRIANGLE), given(FrictionlessSurfaceContact, size=[INF, 1])]
    + [stated(size=[1]), stated(type="line")],
    "vertices": [given(SurfaceContact, vertices=v) for v in (
        TRIANGLE[:2], [[0, 0], [1, 1], [2, 2], [3, 3]], [[1, 1]] * 4, [[0, 0], [1, 0], [0, 1], [1, 1]], star(5, 2),
        np.vstack([star(4, 1)] * 2), [[0, 0], [1, 0], [0.2, 0.2], [0, 1]], [[0, 0], [1, NAN], [0, 1]], BACK_AND_FORTH,
        [[0, 0, 0]] * 3, [[0, 0], [1], [0, 1]], "round",
    )],
    "torsional_friction": [given(SoftFingerContact, torsional_friction=g) for g in (0, -1, INF)] + [stated(type="soft_finger")],
    "shape": [given(SoftFingerContact, torsional_friction=0.1, shape=s) for s in ("round", None)],
    "transmits": [given(Handle, transmits=words) for words in ([], ["fx", "fx"], ["f"], 5, None)],
    "limits": [given(Handle, transmits=["fx"], limits=pairs) for pairs in ([1, 2], "fx")],
    "limits.fx": [given(Handle, transmits=["fx"], limits={"fx": pair}) for pair in ([1, -1], [0, NAN], 5)],
    "limits.fz": [given(Handle, transmits=["fx"], limits={"fz": [0, 1]})],
    "type": [stated(type=word) for word in ("foot", None, ["point"])],
    "frcition": [stated(frcition=0.3)],
}  # fmt: skip
WRONG = [(call, field) for field, calls in WRONG_CALLS.items() for call in calls]


@pytest.mark.parametrize(("call", "field"), WRONG, ids=[f"{i}-{field}" for i, (_, field) in enumerate(WRONG)])
def test_wrong_contacts_are_named_with_the_field(call, field):
    with pytest.raises(InputError) as caught:
        call()
    assert (caught.value.name, caught.value.field) == ("knee", field)
    sentence = str(caught.value)
    assert "knee" in sentence and field in sentence and "\n" not in sentence
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, StaticsError)


@pytest.mark.parametrize("key", ["position", "friction"])
def test_a_missing_key_is_named(key):
    statement = SAMPLES["point"].statement()
    statement.pop(key)
    with pytest.raises(InputError, match=f"contact 'c': {key} is missing") as caught:
        contact_from_statement(statement)
    assert caught.value.field == key


@pytest.mark.parametrize("name", ["", None, 3])
def test_a_name_is_a_word(name):
    with pytest.raises(InputError) as caught:
        PointContact(name, P, R, friction=0.5)
    assert caught.value.field == "name"
