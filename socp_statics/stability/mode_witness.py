"""From a solution of the contact-mode program to one of the exact contact laws: a witness that the body may accelerate."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from socp_statics.contacts.joint import complementarity, sliding_friction_residual
from socp_statics.spatial import Array
from socp_statics.stability.contact_modes import OPEN, SLIDE, STICK, Candidate
from socp_statics.stability.linear_program import ProgramRows
from socp_statics.stability.one_body import OneBody

EXACT = 1e-9
UNLOADED = 1e-7
PIVOTS = (0.0, 0.03, 0.2)
HALF, TURNED, STEPS = 0.5, 1e-4, 30
STICKING_RAYS = 12


@dataclass(frozen=True, eq=False)
class Witness:
    """Acceleration and forces that obey every contact law, in scaled units.

    Attributes:
        a: Acceleration about the origin, shape (6,).
        x: Forces, shape (nx,).
        mode: OPEN, STICK or SLIDE, shape (points,).
        give: Acceleration along the normal of what each bounded contact touches, by index of the contact; zero unless the resultant
            is at a bound.
        power: Power of the load on the acceleration, and of lower bounds that push.
        residual: Largest violation of balance, cones, bounds, (3.8) and (3.10).
    """

    a: Array
    x: Array
    mode: Array
    give: dict[int, float]
    power: float
    residual: float


def refined(body: OneBody, candidate: Candidate, least_power: float) -> Witness | None:
    """The exact solution near a candidate, found in its modes by linear programs whose friction follows the sliding of the one before.

    Points that hardly move, next to those that move most, are also tried as pivots that stick.

    Args:
        body: The body.
        candidate: A solution of the contact-mode program.
        least_power: What counts as an acceleration.

    Returns:
        The witness, checked to 1e-9; None where there is none in these modes or the search left them.
    """
    speed = np.zeros(body.data.points)
    speed[: body.data.slipping] = np.linalg.norm(_tangential(body, candidate.a), axis=1)
    tried: list[list[int]] = []
    for share in PIVOTS:
        pivots = (candidate.mode == SLIDE) & (speed <= share * speed.max(initial=0.0))
        mode = np.where(pivots, STICK, candidate.mode)
        if mode.tolist() in tried:
            continue
        tried.append(mode.tolist())
        found = _in_modes(body, replace(candidate, mode=mode), least_power)
        if found is not None:
            return found
    return None


def _in_modes(body: OneBody, candidate: Candidate, least_power: float) -> Witness | None:
    near = _polished(body, candidate, _Step(candidate.a, candidate.x, candidate.give))
    if near.residual <= EXACT and near.power >= least_power:
        return near
    data = body.data
    f = candidate.x[data.tangential].reshape(-1, 2)
    v = _tangential(body, candidate.a)
    fast = np.linalg.norm(v, axis=1) > 1e-7
    heading = np.where(fast, np.arctan2(v[:, 1], v[:, 0]), np.arctan2(-f[:, 1], -f[:, 0]))
    found, turn = None, np.inf
    for _ in range(STEPS):
        found = _in_sectors(body, candidate, heading, f)
        if found is None or turn < TURNED:
            break
        v, f = _tangential(body, found.a), found.x[data.tangential].reshape(-1, 2)
        fast = np.linalg.norm(v, axis=1) > 1e-9
        new = np.where(fast, np.arctan2(v[:, 1], v[:, 0]), heading)
        turn = float(np.abs(np.angle(np.exp(1j * (new - heading)))).max(initial=0.0))
        heading = new
    if found is None:
        return None
    exact = _polished(body, candidate, found)
    return exact if exact.residual <= EXACT and exact.power >= least_power else None


def _tangential(body: OneBody, a: Array) -> Array:
    """Tangential accelerations of the points with friction, shape (slipping, 2)."""
    out: Array = body.point_rows[: body.data.slipping, :2] @ a
    return out


@dataclass(frozen=True, eq=False)
class _Step:
    a: Array
    x: Array
    give: dict[int, float]


def _in_sectors(body: OneBody, candidate: Candidate, heading: Array, f_t: Array) -> _Step | None:
    """The solution of largest power with fixed modes, friction against the headings, sliding within half a radian of them."""
    data, rows = body.data, ProgramRows()
    a = [rows.variables(1, -bound, bound)[0] for bound in body.fastest * body.length(np.eye(6))]
    cost = dict(zip(a, data.load.tolist(), strict=True))
    balance: list[tuple[int, Array]] = [(column, body.inertia[:, j]) for j, column in enumerate(a)]
    give = {}
    for (k, (lo, hi)), end in zip(body.normal_bounds.items(), candidate.contact_end, strict=True):
        (give[k],) = rows.variables(1, 0.0 if end == 0 else -np.inf if end == 1 else 0.0, np.inf if end == 0 else 0.0)
        cost[give[k]] = lo if end == 0 else hi if end == 1 else 0.0
    forces: list[tuple[list[int], Array]] = []
    for i, mode in enumerate(candidate.mode):
        k = int(data.contact_of_point[i])
        normal = [*zip(a, body.point_rows[i, 2], strict=True), *([(give[k], -1.0)] if k in give else [])]
        rows.row(0.0, np.inf if mode == OPEN else 0.0, normal)
        rays = np.zeros((0, 3)) if mode == OPEN else np.array([[0.0, 0.0, 1.0]])
        if i < data.slipping and mode != OPEN:
            mu = data.friction[i]
            if mode == STICK:
                turn = np.append(np.arange(STICKING_RAYS) * (2 * np.pi / STICKING_RAYS), np.arctan2(f_t[i, 1], f_t[i, 0]))
                rays = np.column_stack([mu * np.cos(turn), mu * np.sin(turn), np.ones(len(turn))])
                spread = []
            else:
                rays = np.array([[-mu * np.cos(heading[i]), -mu * np.sin(heading[i]), 1.0]])
                turn = heading[i] + HALF * np.array([-1.0, 1.0])
                spread = [*zip(rows.variables(2), np.column_stack([np.cos(turn), np.sin(turn)]), strict=True)]
            for axis in range(2):
                rows.row(0.0, 0.0, [*zip(a, body.point_rows[i, axis], strict=True), *((c, -e[axis]) for c, e in spread)])
        columns = rows.variables(len(rays))
        forces.append((columns, rays))
        balance += [*zip(columns, -(body.point_map(i) @ rays.T).T, strict=True)]
    for (k, (lo, hi)), end in zip(body.normal_bounds.items(), candidate.contact_end, strict=True):
        total = [(c, 1.0) for i in np.flatnonzero(data.contact_of_point == k) for c in forces[i][0]]
        rows.row(hi if end == 1 else lo, lo if end == 0 else hi, total)
    handles = []
    for j, ((lo, hi), end) in enumerate(zip(body.handle_bounds, candidate.handle_end, strict=True)):
        (h,) = rows.variables(1, hi if end == 1 else lo, lo if end == 0 else hi)
        handles.append(h)
        rows.row(-np.inf if end == 1 else 0.0, np.inf if end == 0 else 0.0, [*zip(a, body.handle_rows[j], strict=True)])
        if end >= 0:
            for column, value in zip(a, body.handle_rows[j], strict=True):
                cost[column] += (lo if end == 0 else hi) * value
        balance.append((h, -data.wrench_map[:, data.handle][:, j]))
    for axis in range(6):
        rows.row(data.load[axis], data.load[axis], [(c, v[axis]) for c, v in balance])
    value = rows.largest(cost)
    if value is None:
        return None
    x = np.zeros(data.wrench_map.shape[1])
    for i, (columns, rays) in enumerate(forces):
        body.put_force(x, i, value[columns] @ rays)
    x[data.handle] = value[handles]
    return _Step(value[a], x, {k: float(value[c]) for k, c in give.items()})


def _polished(body: OneBody, candidate: Candidate, step: _Step) -> Witness:
    """Newton steps of least length on the equations of the modes, then the check of every law."""
    data = body.data
    v = np.zeros((data.points, 2))
    v[: data.slipping] = _tangential(body, step.a)
    slides = (candidate.mode == SLIDE) & (np.linalg.norm(v, axis=1) > 1e-7)
    closed = candidate.mode != OPEN
    loaded = closed & (step.x[data.normal] > UNLOADED)
    free_x = np.zeros(len(step.x), dtype=bool)
    free_x[data.handle] = candidate.handle_end == -1
    free_x[data.normal] = loaded
    free_x[data.tangential] = np.repeat((loaded & ~slides)[: data.slipping], 2)
    moving = [k for k, end in zip(body.normal_bounds, candidate.contact_end, strict=True) if end != -1]

    def unpacked(z: Array) -> tuple[Array, Array, dict[int, float]]:
        a, x = z[:6], np.where(free_x, step.x, 0.0)
        x[data.handle] = step.x[data.handle]
        x[free_x] = z[6 : 6 + free_x.sum()]
        u = _tangential(body, a)
        for i in np.flatnonzero(slides):
            x[2 * i : 2 * i + 2] = -data.friction[i] * x[data.normal.start + i] * u[i] / np.linalg.norm(u[i])
        return a, x, step.give | dict(zip(moving, z[6 + free_x.sum() :].tolist(), strict=True))

    def equations(z: Array) -> Array:
        a, x, give = unpacked(z)
        gap, rub = body.point_rows[:, 2] @ a - body.gives(give), _tangential(body, a)
        sticks = (closed & ~slides)[: data.slipping]
        held = (body.handle_rows @ a)[candidate.handle_end == -1]
        ends = []
        for (k, (lo, hi)), end in zip(body.normal_bounds.items(), candidate.contact_end, strict=True):
            if end != -1:
                ends.append(x[data.normal][data.contact_of_point == k].sum() - (lo if end == 0 else hi))
        return np.concatenate([body.imbalance(a, x), gap[closed], rub[sticks].ravel(), held, ends])

    z = np.concatenate([step.a, step.x[free_x], [step.give[k] for k in moving]])
    for _ in range(4):
        value, h = equations(z), 1e-7
        J = np.column_stack([(equations(z + h * e) - value) / h for e in np.eye(len(z))])
        z = z + np.linalg.lstsq(J, -value, rcond=1e-9)[0]
    a, x, give = unpacked(z)
    return Witness(a, x, np.where(slides | ~closed, candidate.mode, STICK), give, body.power(a, x, give), violation(body, a, x, give))


def violation(body: OneBody, a: Array, x: Array, give: dict[int, float]) -> float:
    """Largest violation of the equation of motion and of every contact law on the exact cones, in scaled units.

    Args:
        body: The body.
        a: Acceleration, shape (6,).
        x: Forces, shape (nx,).
        give: As in `Witness`.
    """
    data = body.data
    f_n, gap = x[data.normal], body.point_rows[:, 2] @ a - body.gives(give)
    f = np.column_stack([x[data.tangential].reshape(-1, 2), f_n[: data.slipping]])
    slide = _tangential(body, a)
    laws = [np.abs(body.imbalance(a, x)), -f_n, -gap, np.abs(complementarity(f_n, gap))]
    laws.append(np.linalg.norm(f[:, :2], axis=1) - data.friction * f[:, 2])
    laws += [np.abs(sliding_friction_residual(force, v, mu)) for force, v, mu in zip(f, slide, data.friction, strict=True)]
    resultants = [float(f_n[data.contact_of_point == k].sum()) for k in body.normal_bounds]
    laws.append(_at_bounds(np.array(resultants), np.array(list(body.normal_bounds.values())).reshape(-1, 2), np.array(list(give.values()))))
    laws.append(_at_bounds(x[data.handle], body.handle_bounds, body.handle_rows @ a))
    return float(max(np.max(law, initial=0.0) for law in laws))


def _at_bounds(force: Array, bounds: Array, rate: Array) -> Array:
    """Violation of bounds, and of "yields upwards only at the lower bound, downwards only at the upper one"."""
    lo, hi = bounds.T
    out: Array = np.maximum(np.maximum(lo - force, force - hi), 0.0)
    with np.errstate(invalid="ignore"):
        up = np.where(rate > 0.0, rate * np.where(np.isfinite(lo), force - lo, 1.0), 0.0)
        down = np.where(rate < 0.0, -rate * np.where(np.isfinite(hi), hi - force, 1.0), 0.0)
    return np.maximum(out, np.maximum(up, down))
