"""Questions as conic programs of which one parameter changes: what solvers that take matrices are asked.

Clarabel, Moreau and cvxpy all get the programs the toolkit itself declares, with exact second-order cones.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from benchmarks.questions import EXACT, Case, in_order
from benchmarks.suite import Array
from socp_statics.engines import engines_for
from socp_statics.engines.conic_form import ConicForm
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.equilibrium import MODEL as EQUILIBRIUM
from socp_statics.models.minimax_wrench import MODEL as MINIMAX
from socp_statics.models.minimax_wrench import MinimaxShape
from socp_statics.models.program import ConicModel
from socp_statics.models.support_region import MODEL as SUPPORT_REGION
from socp_statics.models.support_region import RegionShape
from socp_statics.optimization.minimax_wrench import measured
from socp_statics.regions.directions import com_plane, plane_values
from socp_statics.statics import wrench_range
from socp_statics.statics.statics_data import StaticsData

NO_CAP = 1e6


@dataclass(frozen=True)
class Posed:
    """A declared program and the values one of its parameters takes in turn.

    Attributes:
        model: The program.
        shape: Its structure.
        values: All parameters, the changing one at its first value.
        parameter: The one that changes.
        changes: Its values, shape (B, k).
    """

    model: ConicModel
    shape: Any
    values: dict[str, Any]
    parameter: str
    changes: Array

    @cached_property
    def form(self) -> ConicForm:
        """Canonical data as functions of the parameters."""
        (engine,) = engines_for("clarabel")
        return engine.compile(self.model, self.shape)._form

    @cached_property
    def parameters(self) -> Array:
        """The parameter vector of the first instance."""
        return self.form.parameter_vector(self.values)

    @property
    def in_the_cost(self) -> bool:
        """Whether the instances differ in the cost q; else they differ in the right-hand side b."""
        return self.form.only_q[self.parameter]

    @cached_property
    def vectors(self) -> Array:
        """The q or the b of every instance, shape (B, columns) or (B, rows)."""
        p, rows = self.parameters.copy(), []
        for change in self.changes:
            self.form.put(p, self.parameter, change)
            rows.append(self.form.linear_cost(p) if self.in_the_cost else self.form.data(p).b)
        return np.array(rows)

    def objective(self, value: float) -> float:
        """The program's objective from the solver's."""
        return -value if self.form.maximise else value

    @property
    def places(self) -> list[int]:
        """Where the horizontal CoM position is among the solver's variables."""
        return list(self.form.variable_places["s"])


def with_coms(data: StaticsData, coms: Array) -> Array:
    """The load for other centres of mass, shape (B, 6)."""
    away = (coms[:, :2] - data.units.origin[:2]) / data.units.length - data.com[:2]
    return data.load + away @ data.com_load.T


def posed_directions(case: Case, directions: Array) -> Posed:
    """Support directions."""
    plane = com_plane(case.data)
    shape = RegionShape(force_shape(case.data, EXACT, "socp", plane.basis.shape[1]), 2, False)
    values = plane_values(case.data, plane, EXACT) | {"direction": directions[0], "box": np.zeros(2)}
    return Posed(SUPPORT_REGION, shape, values, "direction", directions)


def posed_margins(case: Case) -> Posed:
    """Margins of many centres of mass."""
    reach = wrench_range(case.data.wrench_map)
    loads = with_coms(case.data, case.coms) @ reach.basis
    values = force_values(case.data, EXACT, reach.basis) | {"cap": NO_CAP, "load": loads[0]}
    return Posed(EQUILIBRIUM, force_shape(case.data, EXACT, "socp", reach.rank), values, "load", loads)


def posed_minimax(case: Case) -> Posed:
    """The least largest force of many centres of mass."""
    reach = wrench_range(case.data.wrench_map)
    loads = with_coms(case.data, case.coms) @ reach.basis
    what = measured(case.data, EXACT, "force", "point", 1.0)
    values = force_values(case.data, EXACT, reach.basis) | {"F": what.rows, "load": loads[0]}
    shape = MinimaxShape(force_shape(case.data, EXACT, "socp", reach.rank), "force", what.groups)
    return Posed(MINIMAX, shape, values, "load", loads)


def posed(question: str, case: Case, most: int | None = None) -> Posed:
    """The programs of a case, at most so many of them."""
    if question in ("region", "torque"):
        return posed_directions(case, case.traced)
    if question == "direction":
        return posed_directions(case, case.directions[:most])
    cut = Case(case.name, case.stance, case.origin, coms=case.coms[:most])
    return posed_margins(cut) if question == "verdict" else posed_minimax(cut)


def read(question: str, case: Case, objectives: Array, places: Array | None) -> Any:
    """Objectives, or attained positions for a region, as the answer of a question in SI units."""
    units = case.data.units
    if question in ("region", "torque"):
        return in_order(places) * units.length**2
    if question == "direction":
        return np.asarray(objectives) * units.length
    forces = np.asarray(objectives) * units.force
    return (forces >= 0.0, forces) if question == "verdict" else forces
