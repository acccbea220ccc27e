"""From stances to arrays and back: wrench maps by virtual work, loads, units, and the forces of an answer."""

from __future__ import annotations

import numpy as np
import pytest
from programs import stance_of_kind
from random_stances import moved

from socp_statics.contacts import ContactSet, ExternalWrench, FrictionlessPointContact, Handle, PointContact, Stance
from socp_statics.statics import assemble, point_forces, wrench_range

KINDS = ("feet", "frictionless", "bounds", "grip", "box and line", "all types")
UP = (0.0, 0.0, 1.0)


def unknowns(stance):
    """What each entry of x is: (contact, point in world axes, component), in the order that StaticsData promises."""

    def group(c):
        if c.friction == 0:
            return 3
        return {"box": 1, "elliptic": 2}[c.shape] if c.type == "soft_finger" else 0

    ordered = sorted((c for c in stance.contacts if c.unilateral), key=group)
    points = [(c, p) for c in ordered for p in c.points_W]
    out = [(c, p, word) for c, p in points if c.friction > 0 for word in ("fx", "fy")]
    out += [(c, p, "fz") for c, p in points]
    out += [(c, p, "mz") for c, p in points if c.type == "soft_finger" and c.friction > 0]
    return out + [(c, c.position, word) for c in stance.contacts if not c.unilateral for word in c.transmits]


def power(stance, load, v, w, at):
    """Power in watts of a unit unknown on a rigid motion: velocity v at a point, angular velocity w."""
    contact, p, word = load
    axis = contact.rotation[:, "xyz".index(word[1])]
    return axis @ (v + np.cross(w, p - at)) if word[0] == "f" else axis @ w


@pytest.mark.parametrize("kind", KINDS)
def test_columns_of_the_map_do_the_work_of_their_unknowns(kind):
    stance = stance_of_kind(kind, 0.7)
    data = assemble(stance)
    order = unknowns(stance)
    assert data.wrench_map.shape == (6, len(order))
    size, origin = stance.contacts.size, stance.contacts.centre
    rng = np.random.default_rng(1)
    for _ in range(5):
        v, w = rng.normal(size=(2, 3))
        twist = np.concatenate([v, size * w])
        scale = np.array([1.0 if word[0] == "f" else size for *_, word in order])
        # A unit of a moment unknown is W times the size.
        wanted = scale * [power(stance, load, v, w, origin) for load in order]
        np.testing.assert_allclose(data.wrench_map.T @ twist, wanted, atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_columns_of_the_map_by_finite_displacements(kind):
    """Work along a small finite rotation and shift of the whole robot, in SI."""
    stance = stance_of_kind(kind, 0.3)
    data = assemble(stance)
    h, size, origin = 1e-5, stance.contacts.size, stance.contacts.centre
    for k, unit in enumerate(np.eye(6)):
        shift, angle = h * unit[:3], h * unit[3:]
        for i, (contact, p, word) in enumerate(unknowns(stance)):
            turned = p - origin + np.cross(angle, p - origin) + 0.5 * np.cross(angle, np.cross(angle, p - origin))
            axis = contact.rotation[:, "xyz".index(word[1])]
            work = axis @ (shift + turned - (p - origin)) if word[0] == "f" else axis @ angle
            # Arms are in units of the size.
            arm = size if k >= 3 and word[0] == "f" else 1.0
            assert work / h == pytest.approx(arm * data.wrench_map[k, i], abs=2e-5), (k, i, word)


def test_the_unknowns_of_all_types_have_their_places():
    data = assemble(stance_of_kind("all types"))
    # rail (4 components), foot (4), thumb (box), edge (2), finger (elliptic), peg (1), wall (frictionless).
    assert (data.circular, data.box, data.elliptic, data.frictionless, data.points, data.slipping) == (8, 1, 1, 1, 10, 9)
    assert [data.names[k] for k in data.contact_of_point] == ["foot"] * 4 + ["edge"] * 2 + ["peg", "thumb", "finger", "wall"]
    assert (data.tangential, data.normal) == (slice(0, 18), slice(18, 28))
    assert (data.torsional, data.handle) == (slice(28, 30), slice(30, 34))
    assert data.friction.tolist() == [0.6] * 4 + [0.5] * 2 + [0.5, 0.5, 0.6]
    np.testing.assert_allclose(data.torsion * data.units.length, [0.03, 0.05])
    assert data.contact_of_handle.tolist() == [0] * 4 and data.component_of_handle.tolist() == [0, 1, 2, 3]
    assert data.limit_names == ("rail.fx", "rail.fx", "rail.fz", "rail.fz", "rail.mx", "rail.mx")


def test_handle_limits_are_rows_in_scaled_units():
    data = assemble(stance_of_kind("all types"))
    W, size = data.units.force, data.units.length
    x = np.zeros(34)
    x[data.handle] = [60 / W, 1e9, -100 / W, 5 / (W * size)]
    np.testing.assert_allclose(data.limit_rows @ x - data.limit_values, np.array([0, -150, -200, 0, 0, -10 / size]) / W, atol=1e-12)


def test_infinite_limits_are_no_rows_and_bounds_are_scaled():
    handle = Handle("h", [0, 0, 0], normal=UP, transmits=["fx", "fz"], limits={"fx": (-np.inf, 5), "fz": (-np.inf, np.inf)})
    toe = FrictionlessPointContact("toe", [1, 0, 0], normal=UP, normal_force=[49.05, np.inf])
    data = assemble(Stance(ContactSet([handle, toe]), (0, 0, 1), 10.0))
    assert data.limit_rows.tolist() == [[0.0, 1.0, 0.0]] and data.limit_values.tolist() == pytest.approx([5 / 98.1])
    assert data.bounded.tolist() == [1] and data.bounds.tolist() == [[pytest.approx(0.5), np.inf]]


# Loads.


@pytest.mark.parametrize("kind", KINDS)
def test_the_load_is_gravity_and_external_wrenches_about_the_centre(kind):
    stance = stance_of_kind(kind, 0.4)
    data = assemble(stance)
    force = stance.mass * stance.gravity
    moment = np.cross(stance.com - stance.contacts.centre, force)
    for load in stance.external_wrenches:
        force = force + load.force
        moment = moment + load.moment + (0 if load.point is None else np.cross(load.point - stance.contacts.centre, load.force))
    np.testing.assert_allclose(data.load * data.units.wrench, [*force, *moment], atol=1e-10)


@pytest.mark.parametrize("gravity", [(0, 0, -9.81), (1.0, -2.0, -9.0)])
def test_the_load_changes_with_the_centre_of_mass(gravity):
    base = stance_of_kind("wall hand")
    stance = Stance(base.contacts, base.com, 60.0, gravity, base.external_wrenches)
    data = assemble(stance)
    for axis in (0, 1):
        shift = 0.25 * np.eye(3)[axis]
        there = assemble(Stance(stance.contacts, stance.com + shift, 60.0, gravity, stance.external_wrenches))
        np.testing.assert_allclose(there.load - data.load, data.com_load[:, axis] * 0.25 / data.units.length, atol=1e-14)
    np.testing.assert_allclose(data.com * data.units.length + data.units.origin, stance.com, atol=1e-14)


# Units.


@pytest.mark.parametrize(("push", "wanted"), [
    (ExternalWrench(force=(0, 300, 400), point=(0, 0, 0)), 500.0),
    (ExternalWrench(moment=(0, 0, 900)), 450.0),
    (ExternalWrench(force=(10, 0, 0), moment=(0, 0, 20), point=(5, 5, 5)), 98.1),
])  # fmt: skip
def test_the_unit_of_force_is_the_largest_load(push, wanted):
    contacts = ContactSet([PointContact(n, [x, 0, 0], normal=UP, friction=0.5) for n, x in (("a", 0.0), ("b", 2.0))])
    units = assemble(Stance(contacts, (0, 0, 1), 10.0, external_wrenches=(push,))).units
    assert units.force == pytest.approx(wanted)
    assert units.length == 2.0 and units.origin.tolist() == [1, 0, 0]
    np.testing.assert_allclose(units.wrench, [units.force] * 3 + [2 * units.force] * 3)


def test_without_load_and_size_units_are_one():
    units = assemble(Stance(ContactSet([PointContact("a", [3, 0, 0], normal=UP, friction=0.5)]), (0, 0, 1), 1.0, (0, 0, 0))).units
    assert (units.force, units.length, units.origin.tolist()) == (1.0, 1.0, [3, 0, 0])


ARRAYS = ("wrench_map", "load", "com_load", "com", "friction", "torsion", "bounds", "limit_rows", "limit_values", "position", "point",
          "rotation")  # fmt: skip


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "grip"])
@pytest.mark.parametrize(("changes", "tolerance"), [
    ({"shift": (1000.0, -700.0, 300.0)}, 1e-11),
    ({"scale": 0.01}, 1e-13),
    ({"scale": 100.0}, 1e-13),
    ({"scale": 0.01, "shift": (1000.0, -700.0, 300.0)}, 1e-9),
])  # fmt: skip
def test_scaled_arrays_do_not_depend_on_place_or_size(kind, changes, tolerance):
    stance = stance_of_kind(kind, 0.6)
    here, there = assemble(stance), assemble(moved(stance, **changes))
    for name in ARRAYS:
        np.testing.assert_allclose(getattr(there, name), getattr(here, name), atol=tolerance, err_msg=name)


@pytest.mark.parametrize("factor", [1e-6, 1e9])
def test_scaled_arrays_do_not_depend_on_mass(factor):
    stance = stance_of_kind("feet")
    here, there = assemble(stance), assemble(Stance(stance.contacts, stance.com, factor * stance.mass))
    for name in ARRAYS:
        np.testing.assert_allclose(getattr(there, name), getattr(here, name), rtol=1e-14, atol=1e-16, err_msg=name)
    assert there.units.force == pytest.approx(factor * here.units.force)


def test_a_twist_in_si_has_the_power_of_the_scaled_one():
    data = assemble(stance_of_kind("all types"))
    twist, x = np.random.default_rng(2).normal(size=(2, 6))
    v, w = data.units.twist_in_si(twist)
    wrench = x * data.units.wrench
    assert v @ wrench[:3] + w @ wrench[3:] == pytest.approx(data.units.force * (twist @ x))


# Forces.


@pytest.mark.parametrize("kind", KINDS)
def test_point_forces_have_the_wrench_of_the_unknowns(kind):
    stance = stance_of_kind(kind, 0.5)
    data = assemble(stance)
    x = np.random.default_rng(3).normal(size=data.wrench_map.shape[1])
    forces = point_forces(data, x)
    total = data.wrench_map @ x * data.units.wrench
    arms = forces.point_W - stance.contacts.centre
    np.testing.assert_allclose(forces.force_W.sum(axis=0), total[:3], atol=1e-10)
    np.testing.assert_allclose((np.cross(arms, forces.force_W) + forces.moment_W).sum(axis=0), total[3:], atol=1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_entries_are_at_the_points_in_the_order_of_the_contacts(kind):
    stance = stance_of_kind(kind, 0.5)
    forces = point_forces(assemble(stance), np.random.default_rng(4).normal(size=assemble(stance).wrench_map.shape[1]))
    entries = forces.entries()
    assert [e["contact"] for e in entries] == [c.name for c in stance.contacts for _ in c.points_W]
    np.testing.assert_allclose([e["point"] for e in entries], stance.contacts.points_W, atol=1e-14)
    for e in entries:
        assert ("moment" in e) == (stance.contacts[e["contact"]].type in ("soft_finger", "handle"))
        assert all(isinstance(v, float) for v in e["force"])


@pytest.mark.parametrize("kind", KINDS)
def test_wrenches_are_the_sums_of_the_entries_about_each_position(kind):
    stance = stance_of_kind(kind, 0.5)
    data = assemble(stance)
    forces = point_forces(data, np.random.default_rng(5).normal(size=data.wrench_map.shape[1]))
    wrenches = forces.wrenches()
    assert [w["contact"] for w in wrenches] == list(stance.contacts.names)
    for wrench in wrenches:
        contact = stance.contacts[wrench["contact"]]
        mine = [e for e in forces.entries() if e["contact"] == contact.name]
        force = sum(np.array(e["force"]) for e in mine)
        moment = sum(np.cross(np.array(e["point"]) - contact.position, e["force"]) + e.get("moment", np.zeros(3)) for e in mine)
        np.testing.assert_allclose(wrench["force"], force, atol=1e-10)
        np.testing.assert_allclose(wrench["moment"], moment, atol=1e-10)


def test_each_unknown_is_a_force_along_its_axis():
    stance = stance_of_kind("all types", 0.2)
    data = assemble(stance)
    names = [c.name for c in stance.contacts for _ in c.points_W]
    for k, (contact, p, word) in enumerate(unknowns(stance)):
        forces = point_forces(data, np.eye(34)[k])
        axis = contact.rotation[:, "xyz".index(word[1])]
        at = next(i for i, name in enumerate(names) if name == contact.name and np.allclose(forces.point_W[i], p))
        wanted_f, wanted_m = np.zeros((2, len(names), 3))
        if word[0] == "f":
            wanted_f[at] = data.units.force * axis
        else:
            wanted_m[at] = data.units.force * data.units.length * axis
        np.testing.assert_allclose(forces.force_W, wanted_f, atol=1e-10)
        np.testing.assert_allclose(forces.moment_W, wanted_m, atol=1e-10)


# Rank.


def test_full_rank_keeps_the_rows():
    reach = wrench_range(assemble(stance_of_kind("feet")).wrench_map)
    assert reach.rank == 6 and reach.null.shape == (6, 0)
    np.testing.assert_array_equal(reach.basis, np.eye(6))
    assert reach.outside(np.ones(6)) == 0.0


@pytest.mark.parametrize(("smallest", "rank"), [(1.01e-9, 6), (0.99e-9, 5), (0.0, 5)])
def test_singular_values_below_a_billionth_are_zero(smallest, rank):
    rng = np.random.default_rng(6)
    U, _ = np.linalg.qr(rng.normal(size=(6, 6)))
    V, _ = np.linalg.qr(rng.normal(size=(9, 6)))
    reach = wrench_range(U @ np.diag([1, 1, 1, 1, 1, smallest]) @ V.T)
    assert reach.rank == rank
    if rank == 5:
        np.testing.assert_allclose(np.abs(reach.null.T @ U[:, 5]), 1.0)
        assert reach.outside(3e-8 * U[:, 5] + U[:, 0]) == pytest.approx(3e-8, rel=1e-6)


@pytest.mark.parametrize(("kind", "rank"), [("feet", 6), ("two points", 5), ("elliptic", 6), ("chimney", 6)])
def test_ranks_of_stances(kind, rank):
    assert wrench_range(assemble(stance_of_kind(kind)).wrench_map).rank == rank


def test_a_load_about_the_line_through_two_points_is_out_of_reach():
    contacts = ContactSet([PointContact(n, [x, 0, 0], normal=UP, friction=0.5) for n, x in (("a", -1.0), ("b", 1.0))])
    for y, wanted in ((0.0, 0.0), (1e-6, 0.5e-6), (0.3, 0.15)):
        data = assemble(Stance(contacts, (0, y, 0), 60.0))
        assert wrench_range(data.wrench_map).outside(data.load) == pytest.approx(wanted, abs=1e-14)


@pytest.mark.parametrize("smallest", [0.9e-4, 1e-6, 1e-7])
def test_rows_of_weak_directions_count_like_the_others(smallest):
    rng = np.random.default_rng(7)
    U, _ = np.linalg.qr(rng.normal(size=(6, 6)))
    V, _ = np.linalg.qr(rng.normal(size=(9, 6)))
    wrench_map = U @ np.diag([2, 1, 1, 1, 1, smallest]) @ V.T
    reach = wrench_range(wrench_map)
    rows = reach.basis.T @ wrench_map
    np.testing.assert_allclose(rows @ rows.T, np.eye(6), atol=1e-7)
    np.testing.assert_allclose(np.linalg.matrix_rank(reach.basis, tol=0.1), 6)


def test_no_row_is_enlarged_beyond_what_rounding_leaves():
    reach = wrench_range(np.hstack([np.diag([1, 1, 1, 1, 1, 2e-9]), np.zeros((6, 2))]))
    assert reach.rank == 6 and np.linalg.norm(reach.basis, axis=0).max() == pytest.approx(1e7)
