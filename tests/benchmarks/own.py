"""The toolkit's own ways of answering: the kernel and Clarabel compiled, from contacts nothing has been asked about to the result."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

import socp_statics as ss
from benchmarks.questions import EXACT, GAP, Case
from benchmarks.suite import MASS, Array
from benchmarks.timing import Trial, Way
from socp_statics.engines import ENGINES, engines_for
from socp_statics.regions.directions import Directions, com_plane

SOLVERS = {"kernel": "own interior point", "clarabel": "Clarabel, compiled engine"}
CONE = "second-order cones"
MOST = {"direction": 100, "verdict": 50, "minimax": 10}

# The public function for single directions; everything from the contacts on is inside it.
KERNEL_DIRECTIONS = ("socp_statics.regions.support_function", "support_function")


def kernel_missing() -> str | None:
    """Why the kernel cannot be asked, or None."""
    return None if "kernel" in ENGINES.names() else "kernel: no such engine is registered"


def programs_missing() -> str | None:
    """Why the kernel cannot be given declared programs, or None."""
    if kernel_missing():
        return kernel_missing()
    try:
        engines_for("kernel")
    except ModuleNotFoundError as error:
        return f"kernel: {error}"
    return None


def function_missing(name: str) -> str | None:
    """Why a public function of the kernel cannot be asked, or None."""
    return kernel_missing() or (None if name in dir(ss) else f"kernel: socp_statics.{name} does not exist")


def kernel_directions() -> Callable[[ss.ContactSet, Array], Array] | None:
    """The kernel's function for single directions, None where it has none."""
    module, name = KERNEL_DIRECTIONS
    if kernel_missing() or find_spec(module.rpartition(".")[0]) is None or find_spec(module) is None:
        return None
    return getattr(import_module(module), name, None)


def _region(engine: str, case: Case) -> Trial:
    def run(stance: Any) -> Any:
        region = ss.trace_support_region(stance, GAP, engine=engine)
        _ = region.inner, region.outer, region.inner_area
        return region

    return Trial(run, lambda region: region.inner_area, case.stance)


def _kernel_directions(case: Case) -> Trial:
    support_function = kernel_directions()
    assert support_function is not None
    unit = np.asarray(case.directions)

    def heights(found: Any) -> Array:
        return found.height - unit @ case.data.units.origin[:2]

    return Trial(lambda contacts: support_function(contacts, unit, engine="kernel"), heights, case.stance, len(unit))


def _session_directions(engine: str, case: Case) -> Trial:
    """The query of the tracer, its session made outside the clock."""
    ways = [(float(x), float(y)) for x, y in case.directions[: MOST["direction"]]]
    length = case.data.units.length
    (one,) = engines_for(engine)
    directions = Directions(case.data, com_plane(case.data), EXACT, "socp", one)
    return Trial(lambda _: [directions.support(d).h for d in ways], lambda found: length * np.array(found), count=len(ways))


def _many_verdicts(case: Case) -> Trial:
    def run(contacts: ss.ContactSet) -> Any:
        answers = ss.check_equilibrium_many(contacts, case.coms, mass=MASS, engine="kernel")
        return answers.verdict, answers.margin, answers.forces

    def answer(found: Any) -> Any:
        verdict, margin, _ = found
        return np.asarray(verdict) == "stable", np.asarray(margin, dtype=float)

    return Trial(run, answer, case.stance, len(case.coms))


def _single_verdicts(engine: str, case: Case) -> Trial:
    coms = case.coms[: MOST["verdict"]]

    def run(contacts: ss.ContactSet) -> list[Any]:
        return [ss.check_equilibrium(contacts, com, MASS, engine=engine) for com in coms]

    def answer(found: list[Any]) -> Any:
        return np.array([a.stable for a in found]), np.array([a.margin for a in found])

    return Trial(run, answer, case.stance, len(coms))


def _many_forces(case: Case) -> Trial:
    def run(contacts: ss.ContactSet) -> Any:
        answers = ss.minimise_largest_force_many(contacts, case.coms, mass=MASS, engine="kernel")
        return answers.objective, answers.forces

    return Trial(run, lambda found: found[0], case.stance, len(case.coms))


def _single_forces(engine: str, case: Case) -> Trial:
    coms = case.coms[: MOST["minimax"]]

    def run(contacts: ss.ContactSet) -> list[Any]:
        return [ss.minimise_largest_wrench(ss.Stance(contacts, com, MASS), "force", "point", engine=engine) for com in coms]

    return Trial(run, lambda found: np.array([a.objective for a in found]), case.stance, len(coms))


def ways(question: str) -> list[Way]:
    """The kernel first, then Clarabel compiled; what a ratio compares first comes first."""
    of, clarabel = SOLVERS["kernel"], SOLVERS["clarabel"]
    if question in ("region", "torque"):
        why = programs_missing() if question == "torque" else kernel_missing()
        return [Way("kernel", of, CONE, partial(_region, "kernel"), missing=why),
                Way("Clarabel compiled", clarabel, CONE, partial(_region, "clarabel"))]  # fmt: skip
    if question == "direction":
        where = ".".join(KERNEL_DIRECTIONS)
        alone = kernel_missing() or (None if kernel_directions() else f"kernel: {where} does not exist")
        return [Way("kernel", of, CONE, _kernel_directions, missing=alone),
                Way("kernel, general", of, CONE, partial(_session_directions, "kernel"), missing=programs_missing()),
                Way("Clarabel compiled", clarabel, CONE, partial(_session_directions, "clarabel"))]  # fmt: skip
    if question == "verdict":
        return [Way("kernel", of, CONE, _many_verdicts, missing=function_missing("check_equilibrium_many")),
                Way("kernel, one by one", of, CONE, partial(_single_verdicts, "kernel"), missing=kernel_missing()),
                Way("Clarabel compiled", clarabel, CONE, partial(_single_verdicts, "clarabel"))]  # fmt: skip
    return [Way("kernel", of, CONE, _many_forces, missing=function_missing("minimise_largest_force_many")),
            Way("kernel, one by one", of, CONE, partial(_single_forces, "kernel"), missing=programs_missing()),
            Way("Clarabel compiled", clarabel, CONE, partial(_single_forces, "clarabel"))]  # fmt: skip
