"""Independent oracles of joint torques: statics of whole robots by Pinocchio's Jacobians in SI units, linear programs by HiGHS.

Postures, loads, forces and limits to ask about are here too. The oracles use the package's postures and contacts, not its torques.
"""

import math

import numpy as np
import pinocchio as pin
import pytest
from oracles import HIGHS, points_of
from scipy.linalg import null_space
from scipy.optimize import linprog

import socp_statics as ss
from socp_statics.contacts.joint import constraint_basis
from socp_statics.postures import GENERATORS, pose
from socp_statics.postures.moved import posture_on
from socp_statics.spatial import skew
from socp_statics.statics import assemble

FOUR = ("left_foot", "right_foot", "left_hand", "right_hand")
LOADS = ("RARM_LINK4", "LLEG_LINK4", "HEAD_LINK2", "BODY_LINK1", "PELVIS")
INF = math.inf


def generate(name, robot, **numbers):
    return GENERATORS.load(name)(robot, **numbers)


def random_posture(robot, rng, support=FOUR):
    return pose(robot, rng.uniform(robot.lower, robot.upper), support, at=rng.uniform(-1, 1, 3))


def moved_posture(posture, motion):
    """The posture at ``q (+) motion``: base in its own axes, then joints, shape (nv,); contact frames ride on their links."""
    return posture_on(posture, pin.integrate(posture.robot.pin_model, posture.q, np.asarray(motion, dtype=float)))


def braced(robot, rng):
    """A bent posture near a squat whose hands and feet all touch something, at angles of their own."""
    angles = generate("squat", robot, knee=0.8).angles + rng.normal(0, 0.12, len(robot.joints))
    friction = {name: float(rng.uniform(0.2, 0.9)) for name in FOUR}
    return pose(robot, np.clip(angles, robot.lower, robot.upper), rng.permutation(FOUR), friction=friction)


def random_load(posture, rng):
    return ss.ExternalWrench(rng.normal(0, 10, 3), rng.normal(0, 1, 3), rng.uniform(-1, 1, 3), link=str(rng.choice(LOADS)))


def legs(t):
    return {"default": INF, "?LEG_JOINT*": t}


def random_limits(robot, rng, size):
    """An asymmetric interval around 0 for each joint, a fifth of the ends infinite."""
    ends = size * rng.uniform(0.3, 2.0, (len(robot.joints), 2)) * [-1, 1]
    ends[rng.random(ends.shape) < 0.2] *= INF
    return dict(zip(robot.joints, ends.tolist(), strict=True))


def full_jacobian(posture, link, point_W):
    """Velocity ``[linear; angular]`` of a point of a link in world axes due to base and joints, shape (6, 6 + n), by Pinocchio."""
    model = posture.robot.pin_model
    data = model.createData()
    pin.computeJointJacobians(model, data, posture.q)
    pin.updateFramePlacements(model, data)
    index = model.getFrameId(link, pin.FrameType.BODY)
    J = pin.getFrameJacobian(model, data, index, pin.LOCAL_WORLD_ALIGNED).copy()
    J[:3] -= skew(np.asarray(point_W) - data.oMf[index].translation) @ J[3:]
    return J


def generalised_gravity(posture):
    model = posture.robot.pin_model
    return pin.computeGeneralizedGravity(model, model.createData(), posture.q)


def acting(posture, forces, loads=()):
    """Everything outside that acts on the robot but gravity: (link, point, force, moment)."""
    for entry in forces.entries():
        link = posture.robot.frames[entry["contact"]].frame
        yield link, np.array(entry["point"]), np.array(entry["force"]), np.array(entry.get("moment", (0, 0, 0)))
    for load in loads:
        yield load.link or posture.robot.base, load.point, load.force, load.moment


def world_wrenches(posture, F):
    """Forces and moments of contact components in world axes, shapes (k, 3)."""
    forces, moments, start = [], [], 0
    for contact in posture.contacts:
        B = constraint_basis(contact)
        local = B @ F[start : start + B.shape[1]]
        start += B.shape[1]
        forces.append(contact.rotation @ local[:3])
        moments.append(contact.rotation @ local[3:])
    return np.array(forces), np.array(moments)


def balancing(stance, rng, spread=20.0):
    """Scaled unknowns that balance the load, otherwise random: internal forces of tens of newtons, no cones."""
    data = assemble(stance)
    x = np.linalg.lstsq(data.wrench_map, -data.load, rcond=None)[0]
    N = null_space(data.wrench_map)
    return data, x + N @ rng.normal(0, spread / data.units.force, N.shape[1])


def point_jacobians(posture):
    """(contact, point, Jacobian (3, 6 + n)) of every contact point."""
    for contact in posture.contacts:
        for point in points_of(contact):
            yield contact, point, full_jacobian(posture, posture.robot.frames[contact.name].frame, point)[:3]


def solution(A, b, rng):
    """Some x with A x = b."""
    return np.linalg.lstsq(A, b, rcond=None)[0] + null_space(A) @ rng.normal(0, 20, A.shape[1] - np.linalg.matrix_rank(A))


class Linear:
    """Statics over pyramids: forces are rays times z >= 0, ``g - T z = [0; tau]`` over all 6 + n rows."""

    def __init__(self, posture, kind, sides, limits=None):
        angles = (2 * np.arange(sides) + 1) * np.pi / sides
        width = 1.0 if kind == "inscribed" else 1.0 / np.cos(np.pi / sides)
        self.posture, self.g = posture, generalised_gravity(posture)
        rays, owner, T = [], [], []
        for i, (contact, point, J) in enumerate(point_jacobians(posture)):
            mu = contact.friction * width
            corners = np.column_stack([mu * np.cos(angles), mu * np.sin(angles), np.ones(sides)]) @ contact.rotation.T
            rays += [np.concatenate([f, np.cross(point, f)]) for f in corners]
            T.append(J.T @ corners.T)
            owner += [i] * sides
        self.rays, self.T, self.owner = np.array(rays).T, np.hstack(T), np.array(owner)
        self.normals = np.column_stack([J.T @ c.rotation[:, 2] for c, _, J in point_jacobians(posture)]).sum(axis=1)
        self.limits = posture.torque_limits(limits) if limits else np.tile([-INF, INF], (len(posture.robot.joints), 1))

    def torque_rows(self):
        """Rows A z <= end - offset of the finite limits: (A, end, offset) with tau inside them."""
        T, g = self.T[6:], self.g[6:]
        lower, upper = self.limits.T
        above, below = np.isfinite(upper), np.isfinite(lower)
        return np.vstack([-T[above], T[below]]), np.r_[upper[above], -lower[below]], np.r_[g[above], -g[below]]

    def least_use(self):
        """Least s with s lower <= tau <= s upper; zero limits are kept exactly. None where there is none."""
        A, end, offset = self.torque_rows()
        cost = np.r_[np.zeros(self.T.shape[1]), 1.0]
        return self._solve(cost, np.column_stack([A, -end]), -offset, np.zeros(6))

    def margin(self):
        """Largest reserve t: forces are rays times z plus t along the normals of all points."""
        A, end, offset = self.torque_rows()
        lower, upper = self.limits.T
        moved = np.r_[-self.normals[6:][np.isfinite(upper)], self.normals[6:][np.isfinite(lower)]]
        cost = np.r_[np.zeros(self.T.shape[1]), -1.0]
        value = self._solve(cost, np.column_stack([A, moved]), end - offset, self.normals[:6], free=True)
        return None if value is None else -value

    def _solve(self, cost, A, b, column, free=False):
        nz = self.T.shape[1]
        E = np.column_stack([self.T[:6], column])
        bounds = [(0, None)] * nz + [(None, None) if free else (0, None)]
        answer = linprog(cost, A, b, E, self.g[:6], bounds, options=HIGHS)
        assert answer.status in (0, 2), answer.message
        return answer.fun if answer.status == 0 else None

    def orin_oh(self, rates, b):
        """Least sum |tau rate| + b max f_n."""
        nz, points = self.T.shape[1], self.owner.max() + 1
        rate = np.array([rates.get(joint, 0.0) for joint in self.posture.robot.joints])
        n = len(rate)
        P, p0 = -rate[:, None] * self.T[6:], rate * self.g[6:]
        N = (self.owner == np.arange(points)[:, None]).astype(float)
        A, end, offset = self.torque_rows()
        rows = np.block(
            [
                [P, -np.eye(n), np.zeros((n, 1))],
                [-P, -np.eye(n), np.zeros((n, 1))],
                [N, np.zeros((points, n)), -np.ones((points, 1))],
                [A, np.zeros((len(A), n + 1))],
            ]
        )
        right = np.concatenate([-p0, p0, np.zeros(points), end - offset])
        E = np.hstack([self.T[:6], np.zeros((6, n + 1))])
        answer = linprog(np.r_[np.zeros(nz), np.ones(n), b], rows, right, E, self.g[:6], [(0, None)] * (nz + n + 1), options=HIGHS)
        return answer.fun if answer.status == 0 else None

    def reach(self, direction):
        """Farthest frozen CoM position along a horizontal direction: the weight moves, gravity torques and Jacobians stay."""
        weight = self.posture.mass * np.array([0, 0, -9.81])
        A, end, offset = self.torque_rows()
        moving = np.vstack([np.zeros((3, 2)), np.cross(np.eye(3)[:2], weight).T])
        E = np.hstack([self.rays, moving])
        cost = np.r_[np.zeros(self.T.shape[1]), -np.asarray(direction)]
        bounds = [(0, None)] * self.T.shape[1] + [(None, None)] * 2
        level = np.array([0, 0, self.posture.com_W[2]])
        load = np.concatenate([weight, np.cross(level, weight)])
        answer = linprog(cost, np.hstack([A, np.zeros((len(A), 2))]), end - offset, E, -load, bounds, options=HIGHS)
        assert answer.status == 0, answer.message
        return -answer.fun


def check_motion(posture, limits, motion, rng, loads=()):
    """No sampled admissible forces and torques keep load and them from doing the promised power on the motion, all in SI."""
    robot, g = posture.robot, generalised_gravity(posture)
    at_base = motion.linear + np.cross(motion.angular, posture.p_WB - motion.point)
    rates = np.array([motion.joints.get(joint, 0.0) for joint in robot.joints])
    velocity = np.concatenate([posture.R_WB.T @ at_base, posture.R_WB.T @ motion.angular, rates])
    load = -g @ velocity
    for w in loads:
        load += np.r_[w.force, w.moment] @ full_jacobian(posture, w.link or robot.base, w.point) @ velocity
    lower, upper = posture.torque_limits(limits).T
    against = np.where(rates > 0, lower, upper)
    assert np.isfinite(against[rates != 0]).all()
    worst = sum(a * r for a, r in zip(against, rates, strict=True) if r != 0)
    assert type(motion.power) is float and motion.power > 0
    assert load + worst == pytest.approx(motion.power, rel=1e-5, abs=1e-6)

    slack = 1e-5 * posture.mass * 9.81
    contact_points = [(c, c.rotation.T @ J @ velocity) for c, _, J in point_jacobians(posture)]
    corners = [np.where(np.isfinite(end), end, 0.0) for end in (lower, upper)]
    for _ in range(200):
        work = load + np.where(rng.random(len(rates)) < 0.5, *corners) @ rates
        for contact, v in contact_points:
            normal = rng.exponential(20.0)
            angle, share = rng.uniform(0, 2 * np.pi), min(1.0, 2 * rng.random())
            slide = contact.friction * normal * share * np.array([np.cos(angle), np.sin(angle)])
            work += np.r_[slide, normal] @ v
        assert work >= motion.power - slack
    for contact, v in contact_points:
        assert v[2] - contact.friction * np.hypot(v[0], v[1]) >= -1e-6
