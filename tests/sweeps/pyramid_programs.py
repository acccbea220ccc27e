"""Margins over pyramids of many sides, as linear programs of generators (edge rays), solved by HiGHS on a growing part of them.

``f_i = g_i + t n_i`` with g_i a nonnegative combination of the rays of point i's pyramid, so a reserve t is one more column. The
program starts with a few rays a point; the multipliers of each optimum price *every* ray, those that pay are added, and when none
pays the optimum is that of all rays. HiGHS keeps rows and prices to an absolute 1e-10 at best: loads are stated magnified, and the
optimum is then solved again on its own columns, so that primal and dual value agree to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from oracles import HIGHS, sections
from scipy.optimize import linprog
from sweeps.layout import Layout

CAPS = (1e4, 1e8)
MAGNIFIED = (1e4, 1e2, 1.0)
FIRST_RAYS = 8
FEW_ROUNDS, MOST_ROUNDS = 6, 40
SINGULAR, INSIDE, OUTSIDE = 1e-9, 1e-12, 1e-7
PAYS = 1e-12
SETTLED = 1e-13


class Optimum(NamedTuple):
    """A margin in units of W (inf, -inf, or nan where it was not settled), how far it may be off, and the rays that mattered."""

    value: float
    doubt: float
    rays: np.ndarray


@dataclass
class Program:
    """``max t  s.t.  M x = b,  low <= x <= high``; x = rays, handle components, slacks of bounds, t and, where it is free, the CoM."""

    M: np.ndarray
    b: np.ndarray
    low: np.ndarray
    high: np.ndarray
    points: list[slice]
    rays: int
    reserve: int
    missed: float


def pyramid_program(stance, numbers: Layout, kind: str, sides: int, com_free: bool = False) -> tuple[Program, np.ndarray]:
    """The program of a stance.

    Args:
        stance: The stance.
        numbers: Its numbers.
        kind: "inscribed" or "circumscribed".
        sides: Of the pyramids.
        com_free: Whether the CoM may be anywhere at its height, in place of where it is.

    Returns:
        The program, and which columns to start with.
    """
    rays, owner, start, reach = [], [], [], []
    T = np.zeros(6)
    for k, contact in enumerate(stance.contacts):
        mine = np.flatnonzero(numbers.owner == k)
        if not len(mine):
            continue
        corners = sections(contact, kind, sides, 0.0, False)
        units = np.column_stack([corners[:, :2], np.ones(len(corners)), corners[:, 2] / numbers.size])
        stride = max(len(corners) // (FIRST_RAYS if contact.type != "soft_finger" else 8 * FIRST_RAYS), 1)
        for i in mine:
            base = _wrenches(numbers.points[i], numbers.frames[i])
            rays.append(base @ units.T)
            owner.append(np.full(len(corners), k))
            start.append(np.arange(len(corners)) % stride == 0)
            T += base[:, 2]
            reach.append(base[:, [2]] if contact.friction == 0 else base if contact.type == "soft_finger" else base[:, :3])
    owner = np.concatenate(owner) if owner else np.zeros(0, dtype=int)
    grips = [g.wrench[:, None] for g in numbers.grips]
    free = [numbers.com_load] if com_free else []
    load = numbers.load - (numbers.com_load @ numbers.com[:2] if com_free else 0.0)
    U, s, _ = np.linalg.svd(np.hstack([*reach, *grips, *free]))
    rank = int((s > SINGULAR).sum())
    inside = U[:, :rank].T / s[:rank, None]
    ends = [(k, lo, hi, end) for k, (lo, hi) in numbers.bounds.items() for end in ((lo, hi) if lo < hi else (lo,)) if np.isfinite(end)]
    n, h = len(owner), len(grips)
    reserve = n + h + len(ends)
    columns = reserve + 1 + 2 * com_free
    M, b = np.zeros((rank + len(ends), columns)), np.zeros(rank + len(ends))
    low, high = np.zeros(columns), np.full(columns, np.inf)
    low[n : n + h], high[n : n + h] = [g.lo for g in numbers.grips], [g.hi for g in numbers.grips]
    low[reserve:] = -np.inf
    M[:rank, : n + h] = inside @ np.hstack([*rays, *grips])
    M[:rank, reserve : reserve + 1 + 2 * com_free] = inside @ np.hstack([T[:, None], *free])
    b[:rank] = -inside @ load
    for i, (k, lo, hi, end) in enumerate(ends):
        # Sum z + count t -+ t = end -+ slack, without either where both ends are equal.
        side = 0.0 if lo == hi else 1.0 if end == hi else -1.0
        M[rank + i, :n] = owner == k
        M[rank + i, n + h + i] = side
        M[rank + i, reserve] = (numbers.owner == k).sum() + side
        b[rank + i] = end
    first = np.concatenate([*start, np.ones(columns - n, dtype=bool)])
    edges = np.cumsum([0, *(len(s) for s in start)])
    points = [slice(int(i), int(j)) for i, j in zip(edges[:-1], edges[1:], strict=True)]
    return Program(M, b, low, high, points, n, reserve, float(np.linalg.norm(U[:, rank:].T @ load))), first


def _wrenches(p, R) -> np.ndarray:
    """Wrenches about the centre of unit forces along the axes of a frame at a point, and of a unit moment about its normal, (6, 4)."""
    turn = np.array([[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]])
    return np.hstack([np.vstack([R, turn @ R]), np.append(np.zeros(3), R[:, 2])[:, None]])


def largest_reserve(program: Program, start: np.ndarray) -> Optimum:
    """The margin of a program, by as many of its rays as it takes.

    Args:
        program: The program.
        start: Which columns to start with; all that are no rays among them.
    """
    if program.missed > INSIDE:
        return Optimum(-np.inf if program.missed > OUTSIDE else np.nan, 0.0, start)
    for cap in CAPS:
        for magnified in MAGNIFIED:
            found = _grown(program, start, cap, magnified)
            if np.isfinite(found.doubt):
                break
        if not found.value > cap * (1 - 1e-6):
            return found
        # What can be added to any solution again and again: no load, no finite end.
        low, high = (np.where(np.isfinite(v), 0.0, v) for v in (program.low, program.high))
        growth = _grown(replace(program, b=0.0 * program.b, low=low, high=high), found.rays, 1.0, MAGNIFIED[0])
        if growth.value > 0.5:
            return Optimum(np.inf, 0.0, growth.rays)
    return Optimum(np.nan, 0.0, start)


def _grown(program: Program, start: np.ndarray, cap: float, magnified: float) -> Optimum:
    """The optimum with t below a cap: rays are added until none pays."""
    use = start.copy()
    low, high = program.low * magnified, program.high * magnified
    high[program.reserve] = cap * magnified
    cost = np.zeros(len(low))
    cost[program.reserve] = -1.0
    elastic = np.hstack([np.eye(len(program.b)), -np.eye(len(program.b))])
    stretched = False
    for rounds in range(MOST_ROUNDS):
        columns = np.flatnonzero(use)
        M, c, box = program.M[:, columns], cost[columns], np.column_stack([low[columns], high[columns]])
        if stretched:
            M = np.hstack([M, elastic])
            c = np.append(0.0 * c, np.ones(2 * len(program.b)))
            box = np.vstack([box, np.tile([0.0, np.inf], (2 * len(program.b), 1))])
        result = linprog(c, A_eq=M, b_eq=program.b * magnified, bounds=box, method="highs", options=HIGHS)
        if result.status == 2 and not stretched:
            stretched = True
            continue
        if result.status != 0:
            return Optimum(np.nan, np.inf, use)
        x, y = np.zeros(len(low)), result.eqlin.marginals
        x[columns] = result.x[: len(columns)]
        if stretched and result.fun <= 1e-9 * magnified:
            stretched = False
            continue
        if not stretched:
            x, y = _polished(program, x, y, low, high, magnified, use, cost)
        price = y @ program.M[:, : program.rays]
        pays = (price > PAYS * max(1.0, np.abs(y).max())) & ~use[: program.rays]
        if stretched and not pays.any():
            return Optimum(-np.inf, 0.0, use)
        if not stretched:
            found = _judged(program, x / magnified, y, low / magnified, high / magnified, price, use)
            if found.doubt <= SETTLED * max(1.0, abs(found.value)) or not pays.any():
                return found
        if rounds >= FEW_ROUNDS:
            use[: program.rays] |= pays
            continue
        for of_point in program.points:
            if pays[of_point].any():
                k = of_point.start + int(np.argmax(np.where(pays[of_point], price[of_point], -np.inf)))
                use[k] = True
    return Optimum(np.nan, np.inf, use)


def _polished(program: Program, x, y, low, high, magnified: float, use, cost) -> tuple[np.ndarray, np.ndarray]:
    """Optimum and multipliers solved again on the columns strictly between their ends, to the rounding of their numbers."""
    big = max(np.abs(x).max(), magnified)
    between = np.flatnonzero(use & (x > low + 1e-11 * big) & (x < high - 1e-11 * big))
    M, b = program.M[:, between], program.b * magnified
    x, y = x.copy(), y.copy()
    x[: program.rays] = np.maximum(x[: program.rays], 0.0)
    if len(between):
        for _ in range(2):
            x[between] += np.linalg.lstsq(M, b - program.M @ x, rcond=None)[0]
            y += np.linalg.lstsq(M.T, cost[between] - M.T @ y, rcond=None)[0]
    return x, y


def _judged(program: Program, x, y, low, high, price, use) -> Optimum:
    """The value of an optimum, and what its constraints and prices still miss, as a share of W."""
    t = float(x[program.reserve])
    reduced = -(y @ program.M)
    reduced[program.reserve] -= 1.0
    others = np.arange(len(x)) >= program.rays
    ends = np.where(reduced > 0, low, high)
    priced = others & (np.abs(reduced) > 1e-9) & np.isfinite(ends)
    dual = -float(y @ program.b) - float(reduced[priced] @ ends[priced])
    residual = np.abs(y) @ np.abs(program.M @ x - program.b)
    outside = -np.minimum(x - low, 0.0) - np.minimum(high - x, 0.0)
    total = float(np.abs(x[: program.rays]).sum())
    doubt = abs(dual - t) + residual + max(float(price.max(initial=0.0)), 0.0) * total + float(outside.max()) * max(np.abs(y).max(), 1.0)
    return Optimum(t, float(doubt), use)
