"""Stances as one free body in MuJoCo: a small ball at every contact point on a plane of its own, elliptic friction cones."""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np

from socp_statics.contacts import ContactSet, ExternalWrench, PointContact, Stance, SurfaceContact
from socp_statics.stability.mode_search import search_modes
from socp_statics.stability.one_body import one_body
from socp_statics.stability.strong import AccelerationWitness, in_si
from socp_statics.statics import assemble

BALL = 1e-3  # m, radius of a contact point
STEP, LAST = 5e-4, 1.0  # s
# The acceleration is measured once soft contacts have taken up the load, which they do with an impulse, and before it changes.
EARLY = (0.02, 0.1)  # s
CREEP = 2e-3  # m in one second: soft contacts sink, and friction that is regularised creeps
MASS, INERTIA = 40.0, np.diag([3.0, 2.5, 1.2])


class Run(NamedTuple):
    """What the simulated body did.

    Attributes:
        drift: Largest distance that a contact point or the centre of mass moved after the first fifth of the time [m].
        energy: Kinetic energy at a half and at the end [J].
        acceleration: Of the contact points during `EARLY`, shape (points, 3) [m/s^2].
    """

    drift: float
    energy: tuple[float, float]
    acceleration: np.ndarray

    @property
    def stays(self) -> bool:
        return self.drift < CREEP

    @property
    def leaves(self) -> bool:
        return self.drift > 5 * CREEP and self.energy[1] > max(self.energy[0], 1e-6)


def _vector(v) -> str:
    return " ".join(repr(float(x)) for x in v)


def _quaternion(R) -> str:
    q = np.empty(4)
    mujoco.mju_mat2Quat(q, np.ascontiguousarray(R).ravel())
    return _vector(q)


def scene(stance: Stance, preload: float = 0.0, hardness: float = 1.0) -> str:
    """The stance in MuJoCo's XML; ``preload`` moves every plane into the body [m], ``hardness`` divides the times."""
    planes, balls = [], []
    for k, contact in enumerate(stance.contacts):
        bit, mu = 1 << k, max(contact.friction, 1e-6)
        common = f'friction="{mu} 0 0" condim="{3 if contact.friction else 1}"'
        where = contact.position + preload * contact.normal_W
        placed = f'pos="{_vector(where)}" quat="{_quaternion(contact.rotation)}"'
        planes.append(f'<geom type="plane" size="5 5 1" {placed} contype="{bit}" conaffinity="0" {common}/>')
        for point in contact.points_W:
            centre = point + BALL * contact.normal_W - stance.com
            balls.append(f'<geom type="sphere" size="{BALL}" pos="{_vector(centre)}" contype="0" conaffinity="{bit}" mass="0" {common}/>')
    full = _vector(np.asarray(stance.inertia)[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])
    return (
        f'<mujoco><option timestep="{STEP / hardness}" gravity="{_vector(stance.gravity)}" cone="elliptic" impratio="100"'
        f' solver="Newton" iterations="200"'
        f' tolerance="1e-12" integrator="implicitfast"/><default><geom solref="{0.004 / hardness} 1" solimp="0.99 0.999 0.0005"/></default>'
        f'<worldbody>{"".join(planes)}<body name="robot" pos="{_vector(stance.com)}"><freejoint/>'
        f'<inertial pos="0 0 0" mass="{stance.mass}" fullinertia="{full}"/>{"".join(balls)}</body></worldbody></mujoco>'
    )


def simulate(stance: Stance, preload: float = 0.0, hardness: float = 1.0) -> Run:
    """Let the body go at rest where the stance is and watch it for a second; ``hardness`` divides the times of contacts and of `EARLY`."""
    step, window = STEP / hardness, np.array(EARLY) / hardness
    model = mujoco.MjModel.from_xml_string(scene(stance, preload, hardness))
    data = mujoco.MjData(model)
    body = model.body("robot").id
    points = np.vstack([c.points_W for c in stance.contacts]) - stance.com
    for wrench in stance.external_wrenches:
        data.xfrc_applied[body] += np.concatenate([wrench.force, wrench.moment_about(stance.com)])

    def places():
        R = data.xmat[body].reshape(3, 3)
        return np.vstack([data.xpos[body] + points @ R.T, data.xpos[body]])

    mujoco.mj_forward(model, data)
    energy, settled, early = [], None, []
    for n in range(1, round(LAST / step) + 1):
        mujoco.mj_step(model, data)
        if window[0] <= n * step <= window[1]:
            early.append(places()[:-1].ravel())
        if n == round(LAST / 5 / step):
            settled = places()
        if n in (round(LAST / 2 / step), round(LAST / step)):
            v, w = data.qvel[:3], data.qvel[3:6]
            energy.append(float(stance.mass * v @ v / 2 + w @ np.asarray(stance.inertia) @ w / 2))
    drift = float(np.linalg.norm(places() - settled, axis=1).max())
    t = step * np.arange(len(early))
    fit = np.linalg.lstsq(np.column_stack([np.ones_like(t), t, t**2 / 2]), np.array(early), rcond=None)[0]
    return Run(drift, (energy[0], energy[1]), fit[2].reshape(-1, 3))


def acceleration(stance: Stance) -> AccelerationWitness | None:
    """An acceleration of an unstable stance, from the same inertia, that obeys the contact laws."""
    body = one_body(stance, assemble(stance))
    found = search_modes(body).witness
    return None if found is None else in_si(body, found)


def at_points(stance: Stance, found: AccelerationWitness) -> np.ndarray:
    """Accelerations of the contact points, shape (points, 3) [m/s^2]."""
    arms = np.vstack([c.points_W for c in stance.contacts]) - stance.com
    return found.linear + np.cross(found.angular, arms)


def words(stance: Stance, accelerations: np.ndarray) -> list[str]:
    """What each contact does, from the accelerations of its points: a tenth of the largest one counts as motion."""
    some, out, taken = 0.1 * float(np.linalg.norm(accelerations, axis=1).max()), [], 0
    for contact in stance.contacts:
        count = len(contact.points_W)
        local = accelerations[taken : taken + count] @ contact.rotation
        taken += count
        closed = local[:, 2] < some
        slides = (np.linalg.norm(local[closed, :2], axis=1) > some).any()
        out.append("slides" if slides else "holds" if closed.all() else "opens")
    return out


def difference(stance: Stance, found: AccelerationWitness, run: Run) -> float:
    """Largest difference between simulated and predicted acceleration of a contact point, relative to the largest predicted."""
    predicted = at_points(stance, found)
    return float(np.linalg.norm(run.acceleration - predicted, axis=1).max() / np.linalg.norm(predicted, axis=1).max())


def _stance(contacts, com, push=None) -> Stance:
    loads = () if push is None else (ExternalWrench(force=push, point=com),)
    return Stance(ContactSet(contacts), com, MASS, external_wrenches=loads, inertia=INERTIA)


def _on_a_slope(rng) -> Stance:
    tilt = rng.uniform(0.1, 0.7)
    n = np.array([-np.sin(tilt), 0.0, np.cos(tilt)])
    return _stance([SurfaceContact("sole", (0, 0, 0), normal=n, friction=rng.uniform(0.1, 0.9), size=(0.4, 0.3))], 0.1 * n)


def _two_feet(rng) -> Stance:
    mu = rng.uniform(0.2, 0.8)
    feet = [
        SurfaceContact(name, (rng.uniform(-0.1, 0.1), y, 0), rpy=rng.uniform(-0.4, 0.4, 3), friction=mu, size=(0.22, 0.13))
        for name, y in (("left_foot", 0.15), ("right_foot", -0.15))
    ]
    return _stance(feet, (*rng.uniform(-0.15, 0.15, 2), 0.5))


def _three_points(rng) -> Stance:
    mu, turn = rng.uniform(0.2, 0.8), rng.uniform(0, 0.5) + np.arange(3) * 2 * np.pi / 3
    points = [
        PointContact(
            f"p{k}", (0.3 * np.cos(t), 0.3 * np.sin(t), rng.uniform(0, 0.1)), normal=(*rng.uniform(-0.5, 0.5, 2), 1.0), friction=mu
        )
        for k, t in enumerate(turn)
    ]
    return _stance(points, (*rng.uniform(-0.15, 0.15, 2), 0.4))


def _foot_and_hand(rng) -> Stance:
    mu = rng.uniform(0.2, 0.9)
    foot = SurfaceContact("foot", (0, 0, 0), normal=(0, 0, 1), friction=mu, size=(0.22, 0.13))
    hand = PointContact("hand", (0.5, rng.uniform(-0.05, 0.05), 1.1), normal=(-1, 0, rng.uniform(-0.2, 0.3)), friction=mu)
    return _stance([foot, hand], (rng.uniform(0.0, 0.35), 0.0, 0.7))


def _pushed(rng) -> Stance:
    mu = rng.uniform(0.15, 0.7)
    feet = [
        SurfaceContact(n, (x, y, 0), normal=(0, 0, 1), friction=mu, size=(0.22, 0.13))
        for n, x, y in (("rear", -0.2, -0.1), ("front", 0.2, 0.1))
    ]
    return _stance(feet, (0.0, 0.0, 0.6), push=(-rng.uniform(0.05, 0.5) * MASS * 9.81, 0.0, 0.0))


def between_walls(rng) -> Stance:
    """Held by friction alone between two vertical walls: weakly, not strongly stable."""
    mu = rng.uniform(0.4, 1.0)
    sides = (("left", -0.3), ("right", 0.3))
    return _stance(
        [SurfaceContact(n, (x, 0, 0), normal=(-np.sign(x), 0, 0), friction=mu, size=(0.2, 0.2)) for n, x in sides], (0.0, 0.0, 0.0)
    )


FAMILIES = (_on_a_slope, _two_feet, _three_points, _foot_and_hand, _pushed)


def stances(count: int, seed: int = 0):
    """Named stances, the families in turn."""
    for k in range(count):
        make = FAMILIES[k % len(FAMILIES)]
        yield f"{make.__name__.strip('_')}-{k}", make(np.random.default_rng([seed, k]))
