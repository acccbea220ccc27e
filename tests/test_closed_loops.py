"""Closed loops: sums of wrenches, parts of contact wrenches, limb torques; against virtual work by finite differences."""

import numpy as np
import pytest
from random_postures import POSTURES, moved_contact, random_posture

from socp_statics.contacts import FrictionlessSurfaceContact, Handle, PointContact, SurfaceContact
from socp_statics.contacts.joint import constraint_basis, mobility_basis
from socp_statics.distribution.closed_loops import closure_wrench, limb_torque, link_wrench, root_wrench, total_contact_wrenches
from socp_statics.distribution.contact_components import constraint_and_mobility, hard_and_soft, loop_wrench_parts
from socp_statics.distribution.limb_torques import (
    constraint_torque,
    contact_torque,
    limb_jacobians,
    mobility_torque,
    permuted_jacobian,
    redundant_limb_torque,
)
from socp_statics.exceptions import InputError
from socp_statics.spatial import wrench_translation

RNG = np.random.default_rng(5)
FOOT = SurfaceContact("foot", (0.1, 0.2, 0.3), rpy=(0.3, -0.2, 0.5), friction=0.6, size=(0.2, 0.1))
ICE = FrictionlessSurfaceContact("ice", (-0.2, 0.1, 0.0), rpy=(0.1, 0.2, -0.4), size=(0.2, 0.1))
HAND = PointContact("hand", (0.4, 0.1, 1.0), normal=(-1, 0.2, 0.1), friction=0.4)
BAR = Handle("bar", (0.3, 0.0, 0.9), rpy=(0.1, 0.2, 0.3), transmits=["fx", "fz", "mx"])
CONTACTS = (FOOT, ICE, HAND, BAR)


def test_3_24_to_3_26_the_same_reactions_seen_at_links_contacts_root_and_closure():
    links, contacts = RNG.normal(size=(3, 3)), RNG.normal(size=(2, 3))
    shares = RNG.normal(size=(3, 2, 6))
    of_links = np.array([link_wrench(link, contacts, share) for link, share in zip(links, shares, strict=True)])
    total = total_contact_wrenches(shares)
    root, closure = RNG.normal(size=3), RNG.normal(size=3)
    assert np.allclose(root_wrench(root, links, of_links), root_wrench(root, contacts, total), atol=1e-13)
    assert np.allclose(closure_wrench(closure, links, of_links), closure_wrench(closure, contacts, total), atol=1e-13)
    written_out = sum(wrench_translation(root - r) @ F for r, F in zip(contacts, total, strict=True))
    assert np.allclose(root_wrench(root, contacts, total), written_out, atol=1e-13)
    with pytest.raises(InputError, match="2 are expected"):
        root_wrench(root, contacts, total[:1])


@pytest.mark.parametrize("contact", CONTACTS, ids=lambda c: c.name)
def test_3_28_constraint_and_mobility_parts_are_orthogonal_and_add_up(contact):
    F = RNG.normal(size=6)
    parts = constraint_and_mobility(contact, F)
    assert np.allclose(parts.first_wrench + parts.second_wrench, F) and parts.first_wrench @ parts.second_wrench == 0.0
    assert len(parts.first) == constraint_basis(contact).shape[1] and len(parts.second) == 6 - len(parts.first)


def test_3_28_the_stacked_components_are_the_wrench_only_up_to_their_order():
    F = np.arange(1.0, 7.0)
    parts = constraint_and_mobility(ICE, F)
    stacked = np.concatenate([parts.first, parts.second])
    assert not np.allclose(stacked, F) and np.allclose(np.sort(stacked), F)


@pytest.mark.parametrize("contact", [FOOT, HAND], ids=lambda c: c.name)
def test_3_29_hard_and_soft_parts_are_the_reactions_of_a_contact_with_friction(contact):
    B = constraint_basis(contact)
    F = B @ RNG.normal(size=B.shape[1])
    parts = hard_and_soft(contact, F)
    assert np.allclose(parts.first_wrench + parts.second_wrench, F) and parts.first_wrench @ parts.second_wrench == 0.0
    assert len(parts.second) == (3 if contact is FOOT else 2)


def test_3_30_the_loop_wrench_by_parts_is_the_moved_sum():
    from socp_statics.contacts import ContactSet

    contacts, point = ContactSet(CONTACTS), RNG.normal(size=3)
    local = RNG.normal(size=(4, 6))
    first = np.concatenate([constraint_and_mobility(c, F).first for c, F in zip(contacts, local, strict=True)])
    second = np.concatenate([constraint_and_mobility(c, F).second for c, F in zip(contacts, local, strict=True)])
    world = np.array([np.kron(np.eye(2), c.rotation) @ F for c, F in zip(contacts, local, strict=True)])
    F_c, F_m = loop_wrench_parts(contacts, point, first, second)
    assert np.allclose(F_c + F_m, closure_wrench(point, [c.position for c in contacts], world), atol=1e-13)
    assert not loop_wrench_parts(contacts, point, first)[1].any()
    with pytest.raises(InputError, match="constrained: .* components are expected"):
        loop_wrench_parts(contacts, point, first[:-1])
    with pytest.raises(InputError, match="mobile: .* components are expected"):
        loop_wrench_parts(contacts, point, first, [0.0])


@pytest.mark.parametrize("name", POSTURES)
def test_3_27_and_3_31_to_3_33_torques_do_the_work_of_the_contact_wrenches(name):
    posture = random_posture(name, 1)
    h = 1e-6
    for contact in posture.contacts:
        F = RNG.normal(size=6)
        J_c, J_m = limb_jacobians(contact, posture.jacobian[contact.name])
        local = np.kron(np.eye(2), contact.rotation.T) @ F
        F_c, F_m = constraint_basis(contact).T @ local, mobility_basis(contact).T @ local
        tau = limb_torque(posture.jacobian[contact.name], F)
        assert np.allclose(tau, constraint_torque(J_c, F_c) + mobility_torque(J_m, F_m), atol=1e-12)
        assert np.allclose(tau, contact_torque(J_c, J_m, F_c, F_m), atol=1e-12)
        step = RNG.normal(size=len(tau))
        forward, back = moved_contact(posture, contact.name, h * step), moved_contact(posture, contact.name, -h * step)
        work = F @ (forward - back) / (2 * h)
        assert work == pytest.approx(-tau @ step, abs=1e-7 * (1 + abs(work)))


def test_3_34_the_homogeneous_torque_exerts_no_contact_force_with_the_projector_of_the_formula():
    J, F, u = RNG.normal(size=(6, 9)), RNG.normal(size=6), RNG.normal(size=9)
    tau = redundant_limb_torque(J, F, u)
    assert np.allclose(np.linalg.pinv(J).T @ tau, -F)
    sharp = np.linalg.pinv(J)
    printed_below = np.eye(9) - sharp @ sharp.T
    assert not np.allclose(printed_below @ printed_below, printed_below), "the line below (3.34) prints no projector"


def test_3_33_the_permuted_jacobian_is_the_jacobian_in_another_order():
    J = RNG.normal(size=(6, 8))
    J_c, J_m = limb_jacobians(ICE, J)
    rows = np.kron(np.eye(2), ICE.rotation.T) @ J
    assert np.allclose(np.sort(permuted_jacobian(J_c, J_m), axis=0), np.sort(rows, axis=0))
