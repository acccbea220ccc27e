"""From floating-point forces to rational ones that balance the load exactly."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from socp_statics.certificates.exact_elimination import eliminate, independent_columns
from socp_statics.certificates.force_repair import column_weights, equality_rows
from socp_statics.certificates.optimum import closed_limits
from socp_statics.certificates.verify_proof import Contact, Statement, add, cross, dot, sub
from socp_statics.models.contact_forces_set import bound_rows
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData
from socp_statics.statics.wrench_range import SINGULAR

ExactForces = dict[str, list[list[Fraction]]]


class Balanced(NamedTuple):
    """Forces by contact and point in contact frames [N, N m], and the displacement of the centre of mass that they balance [m]."""

    forces: ExactForces
    shift: list[Fraction]


def places(data: StaticsData) -> list[tuple[str, int, int]]:
    """Contact, point and component of each unknown in x, as the verifier counts them."""
    out: list[tuple[str, int, int]] = []
    first = np.zeros(len(data.names), dtype=int)
    point = []
    for k in data.contact_of_point:
        point.append((data.names[k], int(first[k])))
        first[k] += 1
    for i in range(data.slipping):
        out += [(*point[i], 0), (*point[i], 1)]
    out += [(*point[i], 2 if i < data.slipping else 0) for i in range(data.points)]
    out += [(*point[i], 3) for i in range(data.circular - data.box, data.slipping)]
    count = np.zeros(len(data.names), dtype=int)
    for k in data.contact_of_handle:
        out.append((data.names[k], 0, int(count[k])))
        count[k] += 1
    return out


def column_units(data: StaticsData) -> Array:
    """What one scaled unit of each unknown is [N, N m], shape (nx,)."""
    units = np.full(data.wrench_map.shape[1], data.units.force)
    units[data.torsional] *= data.units.length
    units[data.handle][data.component_of_handle >= 3] *= data.units.length
    return units


def exact_forces(equations: Equations, data: StaticsData, x: Array, com: list[Fraction]) -> Balanced | None:
    """Forces next to x that balance the load exactly.

    As many independent columns as the map of contact forces has rank are corrected; where that is less than six, a displacement of the
    centre of mass takes up what rounding left out of reach.

    Args:
        equations: Those of the stance.
        data: The same stance in floats.
        x: Scaled unknowns, shape (nx,); next to balance.
        com: Centre of mass [m].

    Returns:
        The forces; None where what is out of reach is more than a displacement of the centre of mass can take up.
    """
    values = [Fraction(float(v)) for v in x * column_units(data)]
    more, _ = equality_rows(data)
    weights = column_weights(data, x)
    chosen = independent_columns(np.vstack([data.wrench_map, more]) * weights, SINGULAR * float(weights.max(initial=0.0)))
    right = sub(equations.wanted(com), [dot(row, values) for row in equations.rows])
    moved = [] if len(chosen) == len(right) else equations.displacements()
    solution = eliminate([*(equations.columns[j] for j in chosen), *moved], right, len(chosen), SINGULAR * data.units.force)
    if solution is None:
        return None
    for j, change in zip(chosen, solution, strict=False):
        values[j] += change
    shift = solution[len(chosen) :] or [Fraction(0)] * 3
    forces: ExactForces = {c.name: [[Fraction(0)] * len(u) for u in c.units] for c in equations.statement.contacts}
    for value, (name, point, component) in zip(values, equations.places, strict=True):
        forces[name][point][component] = value
    return Balanced(forces, list(shift))


class Equations:
    """The equations of exact forces: balance about the mean contact point, then equal bounds and limits without room.

    Args:
        statement: The statement.
        data: The same stance in floats.

    Attributes:
        places: Contact, point and component of each unknown.
        columns: What a unit of each unknown adds to the equations.
        rows: The same by equation.
    """

    def __init__(self, statement: Statement, data: StaticsData):
        self.statement, self._about = statement, [Fraction(float(v)) for v in data.units.origin]
        equal = data.bounded[data.bounds[:, 0] == data.bounds[:, 1]] if len(data.bounded) else []
        assert len(equal) == len(bound_rows(data).equal)
        self._sums = [data.names[int(k)] for k in equal]
        self._closed: list[tuple[str, Any]] = []
        for a, _ in closed_limits(data):
            if a < data.handle_limits:
                (j,) = np.flatnonzero(data.limit_rows[a][data.handle])
                k = data.contact_of_handle[j]
                self._closed.append((data.names[k], int((data.contact_of_handle[:j] == k).sum())))
            else:
                self._closed.append((data.limit_names[a], None))
        by_name = {contact.name: contact for contact in statement.contacts}
        self.places = places(data)
        self.columns = [self._column(by_name[name], point, component) for name, point, component in self.places]
        self.rows = list(zip(*self.columns, strict=True))

    def _column(self, contact: Contact, point: int, component: int) -> list[Fraction]:
        """What a unit of a component adds to each row."""
        unit = contact.units[point][component]
        arm = sub(contact.position, self._about)
        out = [*unit[:3], *add(unit[3:], cross(arm, unit[:3]))]
        normal = contact.limits is None and component == (2 if contact.friction else 0)
        out += [Fraction(normal and contact.name == name) for name in self._sums]
        for name, place in self._closed:
            if place is None:
                j = self.statement.joints.index(name)
                out.append(dot([row[j] for row in self.statement.jacobians[contact.name]], unit))
            else:
                out.append(Fraction(contact.name == name and component == place))
        return out

    def wanted(self, com: list[Fraction]) -> list[Fraction]:
        """Right-hand sides with the centre of mass somewhere."""
        load = self.statement.load(com)
        out = [-v for v in [*load[:3], *sub(load[3:], cross(self._about, load[:3]))]]
        by_name = {contact.name: contact for contact in self.statement.contacts}
        out += [by_name[name].bounds[0] for name in self._sums]  # type: ignore[index, misc]
        for name, place in self._closed:
            if place is None:
                j = self.statement.joints.index(name)
                out.append(self.statement.passive[j] - self.statement.limits[j][1])  # type: ignore[operator]
            else:
                out.append(by_name[name].limits[place][1])  # type: ignore[index, arg-type]
        return out

    def displacements(self) -> list[list[Fraction]]:
        """Columns of the three coordinates of the centre of mass."""
        out = []
        for i in range(3):
            axis = [Fraction(int(i == k)) for k in range(3)]
            more = [Fraction(0)] * (len(self._sums) + len(self._closed))
            out.append([*[Fraction(0)] * 3, *cross(axis, self.statement.weight), *more])
        return out
