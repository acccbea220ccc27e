"""The search over contact modes: solve, refine to a witness, divide sectors, until the body is proved at rest, moves, or nobody knows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from heapq import heappop, heappush
from typing import Literal

import numpy as np
from scipy.optimize import linprog

from socp_statics.contacts.joint import sliding_friction_residual
from socp_statics.stability.contact_modes import Candidate, ModeProgram, Sliding
from socp_statics.stability.mode_witness import Witness, refined
from socp_statics.stability.one_body import OneBody
from socp_statics.stability.projected_forces import settled_by_projection
from socp_statics.stability.sliding_cells import divided_cell, first_cells, polygon_tips, sliding_groups

LEAST_POWER = 1e-6
FIRST_SIDES = 8
PROGRAMS = 1000
NODES = 20_000
LARGEST_FORCE = 1e3
MOVES = "an acceleration that obeys (3.8) and (3.10) on the exact cones"
STILL = 1e-9
Node = tuple[Sliding, ...]
MOST_SIDES, NARROWEST = 64, 1 - 1e-7


@dataclass(frozen=True, eq=False)
class ModeSearch:
    """What the search found.

    Attributes:
        outcome: "rest": no solution of the contact laws has an acceleration; "moves": the witness has one; "undecided".
        reason: In words, how it is known, or why it is not.
        witness: The witness, or None.
        programs: Number of mixed-integer programs.
    """

    outcome: Literal["rest", "moves", "undecided"]
    reason: str
    witness: Witness | None
    programs: int


def search_modes(body: OneBody, programs: int = PROGRAMS) -> ModeSearch:
    """Look for an acceleration that obeys the contact laws.

    Args:
        body: The body.
        programs: Number of mixed-integer programs after which the search gives up.

    Raises:
        EngineError: A program broke down.
    """
    guess = settled_by_projection(body)
    witness = None if guess is None else refined(body, guess, LEAST_POWER)
    if witness is not None:
        return ModeSearch("moves", MOVES, witness, 0)
    ceiling = largest_normal_force(body)
    found = _settled(body, ceiling or LARGEST_FORCE, None, programs)
    if found.outcome != "rest" or ceiling is not None:
        limit = "" if ceiling is None else f", normal forces that add up to at most {ceiling:.3g} W"
        return replace(found, reason=found.reason + limit if found.outcome == "rest" else found.reason)
    huge = _settled(body, 1.0, LARGEST_FORCE, programs)
    if huge.outcome == "rest":
        return replace(found, reason=f"{found.reason}, forces of any size", programs=found.programs + huge.programs)
    return ModeSearch("undecided", f"forces above {LARGEST_FORCE:g} W were not excluded", None, found.programs + huge.programs)


def _settled(body: OneBody, ceiling: float, beyond: float | None, programs: int) -> ModeSearch:
    """Branch and bound over the cells of sliding, each node a mixed-integer program over separation."""
    tangents = np.array(np.arange(FIRST_SIDES) * (2 * np.pi / FIRST_SIDES), dtype=np.float64)
    root = tuple(Sliding(group, first_cells(group), [tangents] * len(group.points)) for group in sliding_groups(body))
    waiting: list[tuple[float, int, Node]] = [(-np.inf, 0, root)]
    pushed = 0
    for number in range(1, programs + 1):
        _, _, node = heappop(waiting)
        found = ModeProgram(body, node, ceiling, beyond, LEAST_POWER).solve(NODES)
        if found == "unknown":
            return ModeSearch("undecided", f"{NODES} nodes of a mixed-integer program did not settle it", None, number)
        if found != "none" and (beyond is not None or found.bound > LEAST_POWER):
            witness = refined(body, found, LEAST_POWER) if beyond is None else None
            if witness is not None:
                return ModeSearch("moves", MOVES, witness, number)
            children = _divided(body, node, found)
            if not children:
                return ModeSearch("undecided", "a solution of the N-sided model has no exact one near it", None, number)
            for child in children:
                pushed += 1
                heappush(waiting, (-found.bound, pushed, child))
        if not waiting:
            return ModeSearch("rest", f"{number} N-sided programs that contain the exact cones", None, number)
    return ModeSearch("undecided", f"{programs} mixed-integer programs did not settle it", None, programs)


def largest_normal_force(body: OneBody) -> float | None:
    """Largest sum of normal forces that any acceleration within its bounds allows, in units of W; None where there is none.

    The cones are taken as the first pyramids that contain them, so that the bound holds for every later program too.
    """
    data, size = body.data, len(body.data.load)
    tangents = np.array(np.arange(FIRST_SIDES) * (2 * np.pi / FIRST_SIDES), dtype=np.float64)
    tips = polygon_tips(tangents)
    columns = []
    for i in range(data.points):
        mu = data.friction[i] if i < data.slipping else 0.0
        rays = np.column_stack([mu * tips, np.ones(FIRST_SIDES)]) if mu else np.array([[0.0, 0.0, 1.0]])
        columns.append(body.point_map(i) @ rays.T)
    G = np.hstack(columns) if columns else np.zeros((size, 0))
    fastest = body.fastest * body.length(np.eye(size))
    A = np.hstack([body.inertia, -G, -data.wrench_map[:, data.handle]])
    bounds = [(-one, one) for one in fastest] + [(0.0, None)] * G.shape[1] + [tuple(pair) for pair in body.handle_bounds]
    cost = np.concatenate([np.zeros(size), -np.ones(G.shape[1]), np.zeros(len(body.handle_bounds))])
    found = linprog(cost, A_eq=A, b_eq=data.load, bounds=bounds)
    # A little more than the optimum: a ceiling must never be what decides.
    return None if found.status != 0 or -found.fun > LARGEST_FORCE else 1.01 * max(-float(found.fun), 1.0)


def _divided(body: OneBody, node: Node, found: Candidate) -> list[Node]:
    """The parts of a node, divided where its solution is farthest from the exact law; none where it is not far anywhere."""
    data = body.data
    f = np.column_stack([found.x[data.tangential].reshape(-1, 2), found.x[data.normal][: data.slipping]])
    v = body.point_rows[: data.slipping, :2] @ found.a
    rub = np.linalg.norm([sliding_friction_residual(f[i], v[i], data.friction[i]) for i in range(data.slipping)], axis=1)
    over = np.hypot(f[:, 0], f[:, 1]) - data.friction * f[:, 2]
    moving = [cell >= 0 and float(np.linalg.norm(one.group.rows @ found.a)) > STILL for one, cell in zip(node, found.cells, strict=True)]
    wrong = [float((rub if on else over)[one.group.points].max()) for one, on in zip(node, moving, strict=True)]
    for g in sorted(range(len(node)), key=lambda g: -wrong[g]):
        one = node[g]
        if not moving[g]:
            if wrong[g] <= STILL or max(len(t) for t in one.tangents) >= MOST_SIDES:
                continue
            turn = np.arctan2(f[:, 1], f[:, 0])
            pairs = zip(one.group.points, one.tangents, strict=True)
            cut = [np.append(tangents, turn[i]) if over[i] > STILL else tangents for i, tangents in pairs]
            return [(*node[:g], replace(one, tangents=cut), *node[g + 1 :])]
        if len(one.cells) > 1 or one.may_rest:
            alone = [replace(one, cells=[cell], may_rest=False) for cell in one.cells]
            parts = [*alone, replace(one, cells=[])] if one.may_rest else alone
        else:
            (cell,) = one.cells
            if float(np.min(cell @ cell.T)) >= NARROWEST:
                continue
            parts = [replace(one, cells=[half]) for half in divided_cell(cell)]
        return [(*node[:g], part, *node[g + 1 :]) for part in parts]
    return []
