"""The support region of one stance: attained where it says so, ruled out where it says so, and of one mind with the verdict."""

from __future__ import annotations

import numpy as np
from oracles import linear_stance, solve
from sweeps.independent_checks import force_faults, motions
from sweeps.layout import Layout
from sweeps.outcome import Outcome
from sweeps.pyramid_programs import largest_reserve, pyramid_program
from sweeps.verdict_checks import BALANCE, BOUNDARY, COARSE, CONE, SIDES, TOLERANCE

LINE = 1e-7
CLIP = 10.0
NO_MOTION = 1e-6
NO_EDGE = 1e-9
SLANT = 1e-6


def check_region(out: Outcome, stance, numbers: Layout, region) -> None:
    """Every check of a region; lengths in units of the size."""
    out.region, out.region_engine, out.region_handovers = region.kind, region.engine, region.handovers
    out.widened = region.widened > 0.0
    out.made("region")
    _agrees(out, region)
    if region.kind == "empty":
        program, start = pyramid_program(stance, numbers, "inscribed", SIDES, com_free=True)
        most = largest_reserve(program, start)
        out.require(not most.value > BOUNDARY + most.doubt, "region", f"empty, but some CoM has a margin of {most.value:.3e} W")
        return
    if len(region.inner):
        _attained(out, stance, numbers, region)
    # An endless segment is clipped to its two ends.
    if region.kind in ("polygon", "unbounded") and len(region.outer) > 2:
        _enclosed(out, numbers, region)
    if region.kind == "unbounded":
        model = linear_stance(stance, "circumscribed", COARSE)
        for ray in region.rays:
            out.made("rays")
            out.require(_grows(model, ray), "rays", f"the region cannot grow along {ray.tolist()}")


def _grows(model, ray) -> bool:
    """Whether forces without a load balance a CoM that goes without end along a direction, or one as good as it."""
    turned = model._replace(D=model.D @ np.column_stack([ray, [-ray[1], ray[0]]]))
    found = solve(turned, (0.0, 0.0), [(0.0, 1.0), (-SLANT, SLANT)], cost_s=(1.0, 0.0), without_load=True)
    return found.status == 0 and found.fun > 0.5


def _agrees(out: Outcome, region) -> None:
    """The sign of the margin in metres never contradicts the verdict."""
    away = region.com_margin
    where = "no region" if away is None else f"CoM margin {away:.3e} m"
    if out.verdict in ("stable", "unstable"):
        out.made("com margin")
    if out.verdict == "stable":
        out.require(away is not None and away >= 0, "com margin", f"stable, {where}")
    if out.verdict == "unstable":
        out.require(away is None or away <= 0, "com margin", f"unstable, {where}")


def _attained(out: Outcome, stance, numbers: Layout, region) -> None:
    """Forces for every inner corner; cones may be wider by what the region says."""
    balance, cone = force_faults(numbers, stance, region.inner, region.inner_forces)
    wider = region.widened / numbers.W * (1.0 + numbers.friction.max(initial=0.0)) * max(len(numbers.points), 1)
    out.made("inner forces", len(region.inner))
    out.note("balance of inner forces [W]", balance.max())
    out.note("cones of inner forces [W]", (cone - wider).max())
    bad = int(((balance > BALANCE) | (cone > CONE + wider)).sum())
    most = max(float(np.abs(f.force_W).max()) for f in region.inner_forces) / numbers.W
    message = f"{bad} of {len(cone)} corners: balance {balance.max():.2e} W, cones {cone.max():.2e} W, forces up to {most:.2g} W"
    out.require(bad == 0, "inner forces", message + (f", cones widened by {wider:.1e} W" if wider else ""))


def _enclosed(out: Outcome, numbers: Layout, region) -> None:
    """The inner polygon lies inside the outer one, and every outer edge has a motion that rules out what is beyond it."""
    inner, outer = (numbers.scaled(np.column_stack([P, np.zeros(len(P))]))[:, :2] for P in (region.inner, region.outer))
    reach = max(1.0, np.abs(outer).max())
    A, b = region.halfplanes
    out.made("inner inside outer", len(inner))
    out.made("half-planes", len(b))
    beyond = out.note("inner corner outside the outer polygon [size]", outside(outer, inner).max())
    cut = out.note("inner corner outside a half-plane [size]", max(float((A @ region.inner.T - b[:, None]).max()) / numbers.size, 0.0))
    out.require(beyond <= TOLERANCE * reach, "inner inside outer", f"an inner corner lies {beyond:.2e} sizes outside the outer polygon")
    out.require(cut <= LINE * reach, "half-planes", f"a half-plane leaves out an inner corner by {cut:.2e} sizes")
    if region.widened:
        return
    edge = np.roll(outer, -1, axis=0) - outer
    linear, angular = (np.array(part) for part in zip(*region.outer_multipliers, strict=True))
    found = motions(numbers, linear, angular)
    steep = np.linalg.norm(found.slope, axis=1)
    # Edges of the clipping square need no motion, and may have what rounding leaves of one.
    moving = steep > NO_MOTION
    level = np.column_stack([found.power, found.slope]) / np.where(moving, steep, 1.0)[:, None]
    clip = CLIP if region.kind == "unbounded" else None
    edges = np.flatnonzero(np.linalg.norm(edge, axis=1) > NO_EDGE)
    out.made("outer motions", len(edges))
    short = max(_beyond(level[k] if moving[k] else None, clip, outer[k], edge[k]) for k in edges)
    out.note("outer edge inside its motion's line [size]", short)
    past = np.maximum(level[moving, 0] + inner @ level[moving, 1:].T, 0.0).max(initial=0.0)
    past = out.note("inner corner beyond a motion's line [size]", past)
    weak = out.note("forces against outer motions [size]", (found.against[moving] / steep[moving]).max(initial=0.0))
    out.require(short <= LINE * reach, "outer motions", f"an edge lies {short:.2e} sizes inside what its motion rules out")
    out.require(past <= LINE * reach, "outer motions", f"an inner corner lies {past:.2e} sizes beyond what an edge's motion rules out")
    out.require(weak <= LINE * reach, "outer motions", f"a force could work against an edge's motion, {weak:.2e} sizes for each W")


def outside(polygon, points) -> np.ndarray:
    """Distance of points to a convex polygon given counter-clockwise, 0 inside, shape (k,).

    Edges that are too short to have a direction of their own count as parts of the outline, not as half-planes.
    """
    edge = np.roll(polygon, -1, axis=0) - polygon
    away = points[:, None] - polygon
    along = np.clip((away * edge).sum(axis=2) / np.maximum((edge * edge).sum(axis=1), 1e-300), 0.0, 1.0)
    distance = np.linalg.norm(away - along[:, :, None] * edge, axis=2).min(axis=1)
    crossed = (polygon[:, 1] > points[:, None, 1]) != (np.roll(polygon, -1, axis=0)[:, 1] > points[:, None, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        x = polygon[:, 0] + (points[:, None, 1] - polygon[:, 1]) / edge[:, 1] * edge[:, 0]
    within = (crossed & (points[:, None, 0] < x)).sum(axis=1) % 2 == 1
    return np.where(within, 0.0, distance)


def _beyond(level, clip: float | None, start, edge) -> float:
    """How far a position that neither a motion nor the clipping square rules out can lie outside an edge.

    Args:
        level: (a, b, c), (b, c) of length 1: positions with a + b x + c y > 0 are ruled out; None where there is no motion.
        clip: Half-side of the square, or None.
        start: Where the edge starts.
        edge: From its start to its end; outside is to the right of it.
    """
    normal = np.array([edge[1], -edge[0]]) / np.linalg.norm(edge)
    if clip is None:
        # Its neighbours bound the edge: what it lets through beyond one of its ends is theirs to rule out.
        ends = np.array([start, start + edge])
        return np.inf if level is None or level[1:] @ normal < 0 else max(float(-(level[0] + ends @ level[1:]).min()), 0.0)
    corners = clip * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    if level is not None:
        value = level[0] + corners @ level[1:]
        cuts = [
            a + u / (u - v) * (b - a)
            for a, b, u, v in zip(corners, np.roll(corners, -1, axis=0), value, np.roll(value, -1), strict=True)
            if u * v < 0
        ]
        corners = np.array([*corners[value <= 0], *cuts]).reshape(-1, 2)
    return float(((corners - start) @ normal).max(initial=0.0))
