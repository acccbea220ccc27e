"""Contact sets, loads and stances, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from socp_statics.contacts import ContactSet, ExternalWrench, Handle, PointContact, Stance, SurfaceContact
from socp_statics.contacts.stance import stance_of
from socp_statics.exceptions import InputError

UP = (0.0, 0.0, 1.0)
NAN, INF = float("nan"), float("inf")


def trio():
    return [PointContact("a", [0, 0, 0], normal=UP, friction=0.5), SurfaceContact("b", [1, 0, 0], normal=UP, friction=0.5, size=[0.2, 0.2]),
            Handle("c", [0, 3, 0], normal=UP, transmits=["fz"])]  # fmt: skip


def test_a_contact_set_is_an_immutable_sequence_with_names():
    contacts = ContactSet(iter(trio()))
    assert contacts.names == ("a", "b", "c") and len(contacts) == 3
    assert contacts["b"] is contacts[1] and [c.name for c in contacts] == ["a", "b", "c"]
    with pytest.raises(TypeError):
        contacts[0] = contacts[1]
    with pytest.raises(InputError, match="'d': no such contact, there are a, b, c"):
        contacts["d"]


def test_size_and_centre_are_of_all_contact_points():
    contacts = ContactSet(trio())
    assert contacts.points_W.shape == (6, 3)
    assert contacts.size == pytest.approx(np.hypot(1.1, 3.1))
    np.testing.assert_allclose(contacts.centre, contacts.points_W.mean(axis=0))


def test_one_point_has_the_size_of_a_metre():
    assert ContactSet(trio()[:1]).size == 1.0


def test_size_and_centre_survive_far_from_the_origin():
    far = np.array([1e6, -1e6, 1e5])
    moved = ContactSet([PointContact(n, far + p, normal=UP, friction=0.5) for n, p in (("a", (0, 0, 0)), ("b", (0.01, 0, 0)))])
    assert moved.size == pytest.approx(0.01, rel=1e-6)
    np.testing.assert_allclose(moved.centre - far, [0.005, 0, 0], atol=1e-9)


@pytest.mark.parametrize(("contacts", "field"), [([], "contacts"), (["foot"], "contacts"), ([*trio(), trio()[0]], "name")])
def test_wrong_sets_are_refused(contacts, field):
    with pytest.raises(InputError) as caught:
        ContactSet(contacts)
    assert caught.value.field == field


def test_a_stance_has_weight_and_is_immutable():
    stance = Stance(trio(), [0, 0, 1], 10, gravity=(3, 0, -4))
    assert isinstance(stance.contacts, ContactSet)
    assert stance.weight == pytest.approx(50.0)
    assert stance.gravity.tolist() == [3, 0, -4] and Stance(trio(), [0, 0, 1], 10).gravity.tolist() == [0, 0, -9.81]
    with pytest.raises(AttributeError):
        stance.mass = 3.0
    with pytest.raises(ValueError, match="read-only"):
        stance.com[0] = 1.0


GOOD = {"com": [0, 0, 1], "mass": 10.0}


@pytest.mark.parametrize(("keys", "field"), [
    ({"com": [0, 0]}, "com"), ({"com": [0, 0, NAN]}, "com"), ({"mass": 0}, "mass"), ({"mass": -1.0}, "mass"), ({"mass": NAN}, "mass"),
    ({"mass": INF}, "mass"), ({"mass": None}, "mass"), ({"gravity": [0, 0, INF]}, "gravity"), ({"gravity": -9.81}, "gravity"),
    ({"inertia": np.zeros((3, 3))}, "inertia"), ({"inertia": -np.eye(3)}, "inertia"), ({"inertia": np.eye(2)}, "inertia"),
    ({"inertia": [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]}, "inertia"),
])  # fmt: skip
def test_wrong_stances_are_refused(keys, field):
    with pytest.raises(InputError) as caught:
        Stance(trio(), **(GOOD | keys))
    assert caught.value.field == field and field in str(caught.value)


@pytest.mark.parametrize(("keys", "field"), [
    ({"force": (1, 0, 0)}, "point"), ({"force": (1, 0)}, "force"), ({"moment": (0, NAN, 0)}, "moment"),
    ({"force": (1, 0, 0), "point": (0, INF, 0)}, "point"),
])  # fmt: skip
def test_wrong_loads_are_refused(keys, field):
    with pytest.raises(InputError) as caught:
        ExternalWrench(**keys)
    assert caught.value.field == field


@pytest.mark.parametrize("load", [{"forse": (1, 0, 0)}, 3.0])
def test_a_load_that_is_none_is_wrong_input(load):
    with pytest.raises(InputError):
        stance_of(trio(), [0, 0, 1], 10.0, external_wrenches=[load])


@pytest.mark.parametrize("contacts", [None, trio()[0], 3.0])
def test_what_is_no_set_of_contacts_is_wrong_input(contacts):
    with pytest.raises(InputError):
        stance_of(contacts, [0, 0, 1], 10.0)


def test_moments_of_a_load_about_a_point():
    assert ExternalWrench(force=(0, 0, 2), point=(1, 0, 0)).moment_about(np.zeros(3)).tolist() == [0, -2, 0]
    assert ExternalWrench(moment=(0, 0, 5)).moment_about(np.ones(3)).tolist() == [0, 0, 5]


def test_stance_of_takes_a_stance_or_its_parts():
    stance = Stance(trio(), **GOOD)
    assert stance_of(stance) is stance
    built = stance_of(trio(), [0, 0, 1], 10.0, (0, 0, -1.6), [{"moment": (0, 0, 1)}])
    assert built.gravity[2] == -1.6 and built.external_wrenches[0].moment[2] == 1
    assert stance_of(trio(), [0, 0, 1]).mass == 1.0
    for keys in ({"com": [0, 0, 0]}, {"mass": 3.0}, {"gravity": (0, 0, -1)}, {"external_wrenches": [{"moment": (0, 0, 1)}]}):
        with pytest.raises(InputError, match="given twice") as caught:
            stance_of(stance, **keys)
        assert caught.value.field == next(iter(keys))


def test_mass_may_be_left_out_only_where_newtons_do_not_matter():
    bounded = PointContact("toe", [0, 0, 0], normal=UP, friction=0.5, normal_force=[0, 100])
    held = Handle("rail", [0, 0, 0], normal=UP, transmits=["fz"], limits={"fz": (0, 10)})
    for contacts, loads, word in (([bounded], (), "'toe'"), ([held], (), "'rail'"), (trio(), [{"moment": (0, 0, 1)}], "external wrenches")):
        with pytest.raises(InputError, match=f"mass is missing.*{word}"):
            stance_of(contacts, [0, 0, 1], external_wrenches=loads)
    with pytest.raises(InputError, match="com is missing"):
        stance_of(trio(), mass=3.0)
