"""Proofs of the regions of records: of their polygons, or that they are a segment, a point or empty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from socp_statics.cases.record_audit import check_edge, check_held, check_polygons, refute
from socp_statics.certificates import Motion
from socp_statics.certificates.exact_motion import scaled_motion
from socp_statics.certificates.exact_region import empty_proof, on_square, region_proof
from socp_statics.certificates.proof import ExactStance, Proof
from socp_statics.certificates.scaled_forces import scaled_forces
from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData

CLIP = 10.0
# The engine whose forces next to a corner are the most accurate.
ACCURATE = "clarabel"
NOWHERE = (0.0, 0.0)


def joint_rates(data: StaticsData, joints: Mapping[str, float]) -> Array:
    """Rates of all joints of a record's motion, shape (n,) [rad/s].

    Args:
        data: The stance's arrays.
        joints: Joint -> rate, zero where a joint is not named [rad/s].
    """
    return np.array([joints.get(name, 0.0) for name in data.torques.names])


def with_region(proof: Proof, exact: ExactStance, region: Mapping[str, Any], engine: str | Sequence[str]) -> Proof:
    """The proof of a verdict with that of the region of its record.

    Args:
        proof: Of the verdict.
        exact: The stance.
        region: The entry of the record.
        engine: "auto", the name of an engine, or several in turn: for the motions that bound a region without edges, which a record does
            not have, and for forces where those of the record are not accurate enough.

    Raises:
        StaticsError: The region does not hold; the message says where.
    """
    inner, outer = (np.array(region[key], dtype=float).reshape(-1, 2) for key in ("inner", "outer"))
    flat, data = len(outer) < 3, exact.data
    if region.get("widened"):
        check_polygons(region)
        return proof.with_region(None, "the set of forces has no interior, it was traced with widened cones", NOWHERE)
    if region["kind"] == "empty":
        return proof.with_region(*_empty(exact, engine))
    if not len(inner) or (len(inner) < 3) != flat:
        return proof.with_region(None, f"a region that is {region['kind']} has no corners here", NOWHERE)
    forces = [_recorded(data, region["points"], entry) for entry in region["inner_forces"]]
    if len(forces) != len(inner) or len(region["outer_multipliers"]) != len(outer):
        raise refute("region", "forces for each inner corner, and a motion for each outer edge, are expected")
    for i, (corner, x) in enumerate(zip(inner, forces, strict=True)):
        check_held(_moved(data, exact.stance.com, corner), exact.cone, x, f"region.inner[{i}]")
    origin, reach = data.units.origin, CLIP * data.units.length
    square = np.column_stack([origin[:2] - reach, origin[:2] + reach]) if region["kind"] == "unbounded" else None
    motions = _bounding(exact, outer, engine) if flat else _recorded_edges(exact, region, outer, square)
    if motions is None:
        return proof.with_region(None, "no engine settled the motions that bound it", NOWHERE)
    check_polygons(region)
    centre = inner.mean(axis=0)
    inside = _inside(exact, centre, engine)
    if inside is None and not flat:
        return proof.with_region(None, "there are no forces inside the cones in the middle of it", NOWHERE)
    middle = (centre, np.mean(forces, axis=0) if inside is None else inside)

    def again(place: Array) -> Array | None:
        return _inside(exact, place, ACCURATE)

    return proof.with_region(*region_proof(exact, inner, forces, middle, outer, motions, square, again))


def _recorded_edges(exact: ExactStance, region: Mapping[str, Any], outer: Array, square: Array | None) -> list[Motion]:
    """The motions of a record behind its outer edges, those that the square makes left out."""
    data, rates = exact.data, region.get("outer_joint_rates") or [{}] * len(outer)
    motions = []
    for i, clipped in enumerate(on_square(outer, square)):
        if not clipped:
            given = np.array(region["outer_multipliers"][i], dtype=float)
            motions.append(scaled_motion(data, given[:3], given[3:], data.units.origin, joint_rates(data, rates[i])))
            check_edge(data, exact.cone, motions[-1], f"region.outer_multipliers[{i}]")
    return motions


def _bounding(exact: ExactStance, outer: Array, engine: str | Sequence[str]) -> list[Motion] | None:
    """Motions that bound a segment or a point: along it and across it, either way; None where no engine settles them."""
    from socp_statics.engines import engines_for
    from socp_statics.regions.flat_bounds import bounding_motions

    along = outer[-1] - outer[0]
    along = along / np.linalg.norm(along) if along.any() else np.array([1.0, 0.0])
    across = np.array([-along[1], along[0]])
    for one in engines_for(engine, "socp"):
        try:
            return bounding_motions(exact.data, exact.cone, [along, -along, across, -across], one)
        except EngineError:
            continue
    return None


def _empty(exact: ExactStance, engine: str | Sequence[str]) -> tuple[dict[str, Any] | None, str, tuple[float, float]]:
    """The proof that a region is empty, by a motion that the load drives wherever the centre of mass is.

    It is that of the margin when horizontal displacements of the centre of mass are let balance what they can: only the rows of the balance
    that no displacement changes are kept.
    """
    from socp_statics.stability.margin import normal_force_margin

    data = exact.data
    kept = np.eye(6) - data.com_load @ np.linalg.pinv(data.com_load)
    anywhere = replace(data, wrench_map=kept @ data.wrench_map, load=kept @ data.load)
    try:
        found = normal_force_margin(anywhere, exact.cone, "socp", engine)
    except EngineError as error:
        return None, str(error), NOWHERE
    if found.motion is None:
        return None, "rounding decides whether it is empty", NOWHERE
    return (*empty_proof(exact, found.motion), NOWHERE)


def _recorded(data: StaticsData, points: Sequence[Mapping[str, Any]], entry: Any) -> Array:
    """Scaled forces of an inner corner."""
    table = np.array(entry, dtype=float)
    moments = table[:, 3:] if table.shape[1] == 6 else np.zeros_like(table)
    return scaled_forces(data, [point["contact"] for point in points], table[:, :3], moments)


def _moved(data: StaticsData, com: Array, corner: Array) -> StaticsData:
    return replace(data, load=data.load + data.com_load @ ((corner - com[:2]) / data.units.length))


def _inside(exact: ExactStance, place: Array, engine: str | Sequence[str]) -> Array | None:
    """Scaled forces as far inside their cones as can be with the centre of mass somewhere, None where there are none."""
    from socp_statics.stability import check_equilibrium

    there = replace(exact.stance, com=[*place, exact.stance.com[2]])
    try:
        answer = check_equilibrium(there, cone=exact.cone, engine=engine)
    except EngineError:
        return None
    forces = answer.forces
    return None if forces is None else scaled_forces(exact.data, forces.contact, forces.force_W, forces.moment_W)
