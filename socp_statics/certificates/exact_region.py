"""Proof of a support region: empty, or inner corners pulled in and outer edges pushed out by next to nothing, each with what proves it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from socp_statics.certificates.contact_motion import Motion
from socp_statics.certificates.exact_forces import exact_forces
from socp_statics.certificates.exact_motion import motion_tables
from socp_statics.certificates.exact_statement import rationals
from socp_statics.certificates.force_repair import repaired
from socp_statics.certificates.proof import ExactStance
from socp_statics.certificates.verify_proof import Place, Refuted, Unreadable, check_forces, check_region, half_plane, read_motion
from socp_statics.spatial import Array

# Shares of 1e-8 of the size by which a corner is moved.
PULLS = (1e-3, 0.03, 0.9)
DISPLACED = 1e-8
ROOM = 1e-13


def region_proof(
    exact: ExactStance,
    inner: Array,
    forces: Sequence[Array],
    middle: tuple[Array, Array],
    outer: Array,
    motions: Sequence[Motion],
    square: Array | None,
    again: Callable[[Array], Array | None],
) -> tuple[dict[str, Any] | None, str, tuple[float, float]]:
    """A proof of a region's two polygons.

    Args:
        exact: The stance.
        inner: Inner corners, shape (k, 2) [m].
        forces: Scaled unknowns of each.
        middle: A position inside, shape (2,) [m], with forces well inside every cone there.
        outer: Outer corners, shape (l, 2) [m].
        motions: Scaled motions behind the outer edges; of a segment or a point, along it and across it, either way.
        square: Of a region without end ``[[x_min, x_max], [y_min, y_max]]``, what the polygons are clipped to [m]; else None.
        again: Scaled unknowns as far inside their cones as can be with the centre of mass somewhere, shape (2,) [m], or None: asked
            for corners whose forces are not accurate enough.

    Returns:
        The entry of the proof file, or None; why there is none; by how much corners were pulled in and edges pushed out [m].
    """
    nowhere = (0.0, 0.0)
    corners = []
    for i, (place, x) in enumerate(zip(inner, forces, strict=True)):
        corner, why = _corner(exact, place, x, middle, again)
        if corner is None:
            return None, f"region.inner[{i}]: {why}", nowhere
        corners.append(corner)
    edges = []
    for i, motion in enumerate(motions):
        edge, why = _edge(exact, motion)
        if edge is None:
            return None, f"region.outer[{i}]: {why}", nowhere
        edges.append(edge)
    entry: dict[str, Any] = {"inner": rationals(inner), "outer": rationals(outer), "corners": corners, "edges": edges}
    if square is not None:
        entry["square"] = rationals(square)
    try:
        moved = check_region(exact.statement, Place(entry, "region"))
    except (Refuted, Unreadable) as error:
        return None, str(error), nowhere
    return entry, "", moved


def empty_proof(exact: ExactStance, motion: Motion) -> tuple[dict[str, Any] | None, str]:
    """A proof that a region is empty.

    Args:
        exact: The stance.
        motion: Scaled, driven by the load wherever the centre of mass is but for rounding; its turning is made parallel to the weight
            exactly, so that the place of the centre of mass does not matter.

    Returns:
        The entry of the proof file, or None; and why there is none.
    """
    why, weight = "there is no motion", exact.statement.weight
    for table in motion_tables(exact.statement, exact.data, exact.cone, motion, exact.opening):
        turning = Fraction(table["angular"][2]) / weight[2]
        upright = table | {"angular": rationals([turning * v for v in weight])}
        entry: dict[str, Any] = {"inner": [], "outer": [], "corners": [], "edges": [upright]}
        try:
            check_region(exact.statement, Place(entry, "region"))
        except (Refuted, Unreadable) as error:
            why = str(error)
            continue
        return entry, ""
    return None, why


def on_square(outer: Array, square: Array | None) -> list[bool]:
    """Whether each outer edge lies on the square that a region without end is clipped to.

    Args:
        outer: Corners; edge k runs from corner k to the next, shape (l, 2) [m].
        square: ``[[x_min, x_max], [y_min, y_max]]`` [m], or None.
    """
    if square is None:
        return [False] * len(outer)
    reach = float(square[0, 1] - square[0, 0])
    sides = np.abs(outer[:, :, None] - square[None]) < 1e-9 * reach
    return [bool((sides[k] & sides[(k + 1) % len(outer)]).any()) for k in range(len(outer))]


def _pulled(
    exact: ExactStance, place: Array, x: Array, middle: tuple[Array, Array], again: Callable[[Array], Array | None]
) -> Iterator[tuple[Array, Array]]:
    """Places towards the middle with forces there: those of the corner with a share of the middle's, at last forces solved for anew."""
    centre, inside = middle
    away = float(np.linalg.norm(place - centre))
    there = place
    for pull in PULLS:
        share = min(pull * DISPLACED * exact.data.units.length / away, 1.0) if away > 0.0 else 0.0
        there = place + share * (centre - place)
        yield there, (1.0 - share) * x + share * inside
    solved = again(there)
    if solved is not None:
        yield there, solved


def _corner(
    exact: ExactStance, place: Array, x: Array, middle: tuple[Array, Array], again: Callable[[Array], Array | None]
) -> tuple[dict[str, Any] | None, str]:
    """Forces at a corner pulled towards the middle."""
    data, why = exact.data, ""
    for there, forces_there in _pulled(exact, place, x, middle, again):
        at = replace(data, load=data.load + data.com_load @ ((there - exact.stance.com[:2]) / data.units.length))
        com = [Fraction(float(v)) for v in (*there, exact.stance.com[2])]
        found = exact_forces(exact.equations, at, repaired(at, exact.cone, forces_there, ROOM), com)
        if found is None:
            return None, "rank: the contacts reach the load but for rounding"
        place_there = [c + s for c, s in zip(com, found.shift, strict=True)]
        if place_there[2] != com[2]:
            return None, "rank: the contacts reach the load but for rounding"
        try:
            check_forces(exact.statement, found.forces, place_there, "forces")  # type: ignore[arg-type]
        except Refuted as error:
            why = str(error)
            continue
        forces = {name: [[str(v) for v in f] for f in points] for name, points in found.forces.items()}
        return {"com": rationals(place_there[:2]), "forces": forces}, ""
    return None, why


def _edge(exact: ExactStance, motion: Motion) -> tuple[dict[str, Any] | None, str]:
    """A motion next to a given one that nothing prevents beyond its edge."""
    why = "there is no motion"
    for table in motion_tables(exact.statement, exact.data, exact.cone, motion, exact.opening):
        try:
            half_plane(exact.statement, read_motion(exact.statement, Place(table, "motion")), "motion")
        except Refuted as error:
            why = str(error)
            continue
        return table, ""
    return None, why
