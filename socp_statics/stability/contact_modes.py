r"""Contact modes as a mixed-integer linear program: can any force that obeys the contact laws leave the body accelerating?

Every point is open or closed, and every group of points in one plane rests or slides in one of its cells (`sliding_cells`):

.. math::
    \max\; a^T L + \text{work of lower bounds} \quad\text{s.t.}\quad M a = L + G f,\qquad a_n \ge 0,\; f_n \ge 0,\; f_n a_n = 0,

    \text{slides: } a_t \in \text{cell},\; -f_t \in \text{the arc of } \mu f_n \text{ there and what its tangents cut off}

Friction that opposes sliding on the exact cone, (3.10) in accelerations, lies on that arc, and forces of a point at rest lie in the
pyramid of the tangents: every solution of the exact laws is one of the program, so that an optimum of zero proves rest. The other
way round nothing follows: a solution has to be refined (`mode_witness`) or its cells divided (`mode_search`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array
from socp_statics.stability.linear_program import ProgramRows
from socp_statics.stability.one_body import OneBody
from socp_statics.stability.sliding_cells import SlidingGroup, friction_rays, polygon_tips

OPEN, STICK, SLIDE = range(3)
# Range of a handle component that is limited on one side only, in units of W or W times the size.
WIDE = 1e3


@dataclass(frozen=True, eq=False)
class Candidate:
    """A solution of the program.

    Attributes:
        power: Its objective, and so a bound of ``a' M a``, in scaled units.
        bound: What no solution exceeds.
        a: Acceleration, shape (6,).
        x: Forces, shape (nx,).
        mode: OPEN, STICK or SLIDE, shape (points,).
        contact_end: -1, 0 or 1: at no bound, at the lower, at the upper one, of the bounded contacts in order.
        handle_end: The same of the handle components.
        give: Acceleration along the normal of what each bounded contact touches, by index of the contact.
        cells: Index of the cell in which each group slides, -1 where it is at rest.
    """

    power: float
    bound: float
    a: Array
    x: Array
    mode: Array
    contact_end: Array
    handle_end: Array
    give: dict[int, float]
    cells: list[int]


@dataclass(frozen=True, eq=False)
class Sliding:
    """How a group may slide.

    Attributes:
        group: The group.
        cells: Simplicial cones that cover its motions, one ray a row, no two at more than a right angle.
        tangents: For each point, where a polygon round the disc of friction touches it, none half a turn from the next [rad].
        may_rest: Whether the group may also stay at rest.
    """

    group: SlidingGroup
    cells: list[Array]
    tangents: list[Array]
    may_rest: bool = True


class ModeProgram:
    """The program of one body, its sectors and its largest normal force.

    Args:
        body: The body.
        sliding: How its groups may slide.
        ceiling: Largest sum of normal forces at a point, in units of W.
        beyond: Ask for solutions whose normal forces add up to more than this instead: forces are then shares of their sum, so that
            motion and load hardly matter in their balance, and the acceleration has at least ``least_power``.
        least_power: What counts as an acceleration.
    """

    def __init__(self, body: OneBody, sliding: Sequence[Sliding], ceiling: float, beyond: float | None = None, least_power: float = 0.0):
        self.body, self.sliding, self.ceiling, self.beyond = body, sliding, 1.0 if beyond else ceiling, beyond
        self._rows = ProgramRows()
        self._objective: dict[int, float] = {}
        self._forces: list[tuple[int, Array]] = []
        self._open: list[int] = []
        self._cells: list[list[int]] = []
        data = body.data
        speed = float(body.fastest)
        self._a = [self._rows.variables(1, -bound, bound)[0] for bound in speed * body.length(np.eye(6))]
        self._objective |= {column: float(value) for column, value in zip(self._a, data.load, strict=True)}
        self._ends = {k: self._bounded(lo, float(body.length(body.point_rows[data.contact_of_point == k, 2]).max()) * speed)
                      for k, (lo, _) in body.normal_bounds.items()}  # fmt: skip
        moving = [self._group(one, speed) for one in sliding]
        group_of = {i: (g, j) for g, one in enumerate(sliding) for j, i in enumerate(one.group.points)}
        for i in range(data.points):
            gap = self._normal(i, speed * float(body.length(body.point_rows[i, 2])))
            self._force(i, gap, None if i not in group_of else (sliding[group_of[i][0]], group_of[i][1], moving[group_of[i][0]]))
        for k, (lo, hi) in body.normal_bounds.items():
            self._resultant(k, lo, hi)
        self._handle_ends = [self._handle(j, speed) for j in range(len(body.handle_rows))]
        if beyond is None:
            self._balance()
        else:
            self._internal(beyond)
            self._rows.row(least_power, np.inf, list(self._objective.items()))

    def _bounded(self, lo: float, fastest: float) -> tuple[int, int, int, int]:
        """A contact with a bounded normal force: what it touches gives way along the normal, as one, at a bound only."""
        back, forth = self._rows.variables(2, 0.0, fastest)
        at_low, at_high = self._rows.variables(2, 0.0, 1.0, whole=True)
        self._rows.most([(back, 1.0)], fastest, [at_low])
        self._rows.most([(forth, 1.0)], fastest, [at_high])
        self._rows.row(-np.inf, 1.0, [(at_low, 1.0), (at_high, 1.0)])
        self._objective[back] = lo
        return back, forth, at_low, at_high

    def _group(self, one: Sliding, speed: float) -> list[int]:
        """Switches of a group: at rest, then each cell; the motion lies in the cell that is on."""
        rows, group = self._rows, one.group
        switches = rows.variables(1 + len(one.cells), 0.0, 1.0, whole=True)
        rows.row(1.0, 1.0, [(z, 1.0) for z in (switches if one.may_rest else switches[1:])])
        fastest = speed * float(np.linalg.norm(self.body.length(group.rows)))
        columns, rays = [], []
        for z, cell in zip(switches[1:], one.cells, strict=True):
            mine = rows.variables(len(cell))
            # The parts of a motion along rays that are nowhere at more than a right angle are no longer than the motion.
            for column in mine:
                rows.most([(column, 1.0)], fastest, [z])
            columns += mine
            rays.append(cell)
        spread = -np.vstack([*rays, np.zeros((0, len(group.rows)))])
        for axis, row in enumerate(group.rows):
            terms = [(c, float(value)) for c, value in zip(self._a, row, strict=True)]
            rows.row(0.0, 0.0, [*terms, *zip(columns, spread[:, axis].tolist(), strict=True)])
        self._cells.append(switches)
        return switches

    def _normal(self, i: int, fastest: float) -> int:
        """Acceleration along the normal, positive where the point is open; the switch."""
        (gap,) = self._rows.variables(1, 0.0, fastest)
        (is_open,) = self._rows.variables(1, 0.0, 1.0, whole=True)
        self._rows.most([(gap, 1.0)], fastest, [is_open])
        normal = [(column, float(value)) for column, value in zip(self._a, self.body.point_rows[i, 2], strict=True)]
        if self.body.data.contact_of_point[i] in self._ends:
            back, forth, *_ = self._ends[self.body.data.contact_of_point[i]]
            normal += [(back, -1.0), (forth, 1.0)]
        self._rows.row(0.0, 0.0, [*normal, (gap, -1.0)])
        self._open.append(is_open)
        return is_open

    def _force(self, i: int, is_open: int, sliding: tuple[Sliding, int, list[int]] | None) -> None:
        rows, parts = self._rows, []
        if sliding is None:
            parts.append(np.array([[0.0, 0.0, 1.0]]))
        else:
            (one, j, switches), mu = sliding, float(self.body.data.friction[i])
            disc = polygon_tips(one.tangents[j])
            parts.append(np.column_stack([mu * disc, np.ones(len(disc))]) if one.may_rest else np.zeros((0, 3)))
            parts += [friction_rays(mu, cell @ one.group.maps[j].T, disc) for cell in one.cells]
        columns = rows.variables(sum(len(rays) for rays in parts))
        first = columns[0]
        if sliding is not None:
            taken = 0
            for rays, z in zip(parts, switches, strict=True):
                rows.most([(column, 1.0) for column in columns[taken : taken + len(rays)]], self.ceiling, [z])
                taken += len(rays)
        rows.row(-np.inf, self.ceiling, [*((column, 1.0) for column in columns), (is_open, self.ceiling)])
        self._forces.append((first, np.vstack(parts)))

    def _resultant(self, k: int, lo: float, hi: float) -> None:
        *_, at_low, at_high = self._ends[k]
        mine = [self._forces[i] for i in np.flatnonzero(self.body.data.contact_of_point == k)]
        total = [(first + j, 1.0) for first, rays in mine for j in range(len(rays))]
        if self.beyond is not None:
            self._rows.row(0.0, hi / self.beyond, total)
            return
        most = self.ceiling * len(mine)
        self._rows.row(lo, min(hi, most), total)
        self._rows.row(-np.inf, max(most, lo), [*total, (at_low, max(most - lo, 0.0))])
        self._rows.row(0.0, np.inf, [*total, (at_high, -hi if np.isfinite(hi) else -2 * most)])

    def _handle(self, j: int, speed: float) -> tuple[int, int, int]:
        lo, hi = self.body.handle_bounds[j]
        row = self.body.handle_rows[j]
        fastest = speed * float(self.body.length(row))
        ends = (lo, hi) if self.beyond is None else (min(lo, 0.0) / self.beyond, max(hi, 0.0) / self.beyond)
        (force,) = self._rows.variables(1, *ends)
        back, forth, at_low, at_high = self._bounded(max(lo, 0.0), fastest)
        self._objective[forth] = max(-hi, 0.0)
        terms = [(column, float(value)) for column, value in zip(self._a, row, strict=True)]
        self._rows.row(0.0, 0.0, [*terms, (back, -1.0), (forth, 1.0)])
        if self.beyond is not None:
            return force, at_low, at_high
        wide = hi - lo if np.isfinite(hi - lo) else WIDE
        for end, switch, sign in ((lo, at_low, 1.0), (hi, at_high, -1.0)):
            if np.isfinite(end):
                self._rows.row(-np.inf, sign * end + wide, [(force, sign), (switch, wide)])
            else:
                self._rows.row(0.0, 0.0, [(switch, 1.0)])
        return force, at_low, at_high

    def _balance(self) -> None:
        load = self.body.data.load.tolist()
        columns = [(c, self.body.inertia[:, j]) for j, c in enumerate(self._a)] + self._force_columns()
        for axis in range(6):
            self._rows.row(load[axis], load[axis], [(c, float(v[axis])) for c, v in columns])

    def _internal(self, beyond: float) -> None:
        """Shares of forces that balance among themselves, but for what the load and the largest acceleration are of their sum."""
        fastest = self.body.fastest * self.body.length(np.eye(6))
        left = (np.abs(self.body.data.load) + np.abs(self.body.inertia) @ fastest) / beyond
        columns = self._force_columns()
        for axis in range(6):
            self._rows.row(-float(left[axis]), float(left[axis]), [(c, float(v[axis])) for c, v in columns])
        self._rows.row(1.0, 1.0, [(first + j, 1.0) for first, rays in self._forces for j in range(len(rays))])

    def _force_columns(self) -> list[tuple[int, Array]]:
        """Minus the wrench of a unit of each force variable."""
        data, columns = self.body.data, []
        for i, (first, rays) in enumerate(self._forces):
            wrench = self.body.point_map(i) @ rays.T
            columns += [(first + j, -wrench[:, j]) for j in range(len(rays))]
        for (force, *_), column in zip(self._handle_ends, data.wrench_map[:, data.handle].T, strict=True):
            columns.append((force, -column))
        return columns

    def solve(self, node_limit: int) -> Candidate | Literal["none", "unknown"]:
        """The solution of largest power.

        Args:
            node_limit: Nodes after which the search ends.

        Returns:
            The best solution, and the bound of all; "none" where there is none, "unknown" where none was found before the limit.

        Raises:
            EngineError: The program broke down.
        """
        found = self._rows.largest_mixed(self._objective, node_limit)
        if found.x is None:
            if found.status in (1, 2):
                return "unknown" if found.status == 1 else "none"
            raise EngineError(f"contact modes: the mixed-integer program was not settled ({found.message})")
        bound = -float(found.mip_dual_bound)
        value = found.x
        cells = [int(np.argmax(value[switches])) - 1 for switches in self._cells]
        rests = {i: cell < 0 for one, cell in zip(self.sliding, cells, strict=True) for i in one.group.points}
        mode = np.array([OPEN if value[z] > 0.5 else STICK if rests.get(i, True) else SLIDE for i, z in enumerate(self._open)], dtype=int)
        ends = [_end(value, at_low, at_high) for *_, at_low, at_high in self._ends.values()]
        handle_ends = [_end(value, at_low, at_high) for _, at_low, at_high in self._handle_ends]
        give = {k: float(value[back] - value[forth]) for k, (back, forth, *_) in self._ends.items()}
        x = self._x(value)
        return Candidate(-float(found.fun), bound, value[self._a], x, mode, np.array(ends, int), np.array(handle_ends, int), give, cells)

    def _x(self, value: Array) -> Array:
        data = self.body.data
        x = np.zeros(data.wrench_map.shape[1])
        for i, (first, rays) in enumerate(self._forces):
            self.body.put_force(x, i, value[first : first + len(rays)] @ rays)
        x[data.handle] = [value[force] for force, *_ in self._handle_ends]
        return x


def _end(value: Array, at_low: int, at_high: int) -> int:
    return 0 if value[at_low] > 0.5 else 1 if value[at_high] > 0.5 else -1
