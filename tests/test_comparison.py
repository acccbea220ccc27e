"""Pyramids bracket the exact region: inscribed in exact in circumscribed."""

import numpy as np
import pytest

from socp_statics.comparison import compare_regions
from socp_statics.contacts import ContactSet, LineContact, PointContact, Stance, SurfaceContact
from socp_statics.exceptions import InputError

UP = (0.0, 0.0, 1.0)
KINDS = ("inscribed", "exact", "circumscribed")


def sole(name, position, friction, size=(0.2, 0.1), **orientation):
    return SurfaceContact(name, position, friction=friction, size=size, **(orientation or {"normal": UP}))


def flat_feet():
    return [sole("left_foot", [0, 0.1, 0], 0.6), sole("right_foot", [0, -0.1, 0], 0.6)]


STANCES = {
    "tilted feet": Stance(
        [sole("left", [0, 0.15, 0], 0.5, rpy=[0.35, 0, 0]), sole("right", [0.05, -0.15, 0], 0.5, rpy=[-0.35, 0.2, 0])], [0, 0, 0.5], 60.0
    ),
    "wall hand": Stance([*flat_feet(), PointContact("hand", [0.4, 0.2, 1.0], normal=[-1, 0, 0.1], friction=0.4)], [0.2, 0, 0.8], 60.0),
    "three leaning points": Stance(
        [
            PointContact(f"finger_{k}", [0.2 * np.cos(a), 0.2 * np.sin(a), 0], normal=[-np.cos(a), -np.sin(a), 2.0], friction=0.5)
            for k, a in enumerate((0.0, 2.1, 4.2))
        ],
        [0, 0, 0.5],
        10.0,
    ),
    "ladder": Stance(
        [
            LineContact("ground", [0, 0, 0], normal=UP, friction=0.5, size=[0.4]),
            LineContact("top", [0, 1.2, 3.0], normal=[0, -1, 0], friction=0.2, size=[0.4]),
        ],
        [0, 0.5, 1.5],
        70.0,
    ),
}


@pytest.mark.parametrize("sides", [4, 6])
@pytest.mark.parametrize("name", STANCES)
def test_regions_are_nested_in_area_and_as_sets(name, sides):
    regions = compare_regions(STANCES[name], sides=sides)
    assert set(regions) == set(KINDS)
    areas = [regions[kind].inner_area for kind in KINDS]
    assert areas[0] < areas[2]
    for small, large in (("inscribed", "exact"), ("exact", "circumscribed")):
        assert regions[small].inner_area <= regions[large].outer_area
        A, b = regions[large].halfplanes
        assert (regions[small].inner @ A.T - b).max() <= 1e-9 * STANCES[name].contacts.size
    assert [regions[kind].cone.sides for kind in KINDS] == [sides, None, sides]


def test_more_sides_come_closer():
    few, many = (compare_regions(STANCES["wall hand"], sides=sides) for sides in (4, 16))
    assert many["inscribed"].inner_area > few["inscribed"].inner_area
    assert many["circumscribed"].inner_area < few["circumscribed"].inner_area


def test_on_a_flat_floor_pyramids_change_nothing():
    regions = compare_regions(Stance(flat_feet(), [0.05, 0, 0.8], 60.0))
    for region in regions.values():
        assert region.inner_area == pytest.approx(0.2 * 0.3, abs=1e-9)
        assert region.com_margin == pytest.approx(0.05, abs=1e-9)


def test_contacts_are_enough_where_mass_does_not_matter():
    listed, together = compare_regions(flat_feet()), compare_regions(ContactSet(flat_feet()))
    assert listed["exact"].inner.tolist() == together["exact"].inner.tolist()


def test_heading_turns_the_pyramids():
    straight, turned = (compare_regions(STANCES["wall hand"], heading=heading) for heading in (0.0, np.pi / 4))
    assert straight["inscribed"].inner_area != pytest.approx(turned["inscribed"].inner_area, rel=1e-3)
    assert straight["exact"].inner.tolist() == turned["exact"].inner.tolist()


@pytest.mark.parametrize("wrong", [{"sides": 2}, {"sides": 4.5}, {"heading": np.nan}, {"tolerance": 0.0}])
def test_wrong_numbers_are_refused(wrong):
    with pytest.raises(InputError) as caught:
        compare_regions(flat_feet(), **wrong)
    assert caught.value.field in wrong
