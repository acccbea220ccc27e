"""One stance of the sweep put to every check."""

from __future__ import annotations

import numpy as np
from sweeps.layout import Layout, layout
from sweeps.outcome import Outcome
from sweeps.population import Case, stance_of
from sweeps.region_checks import check_region
from sweeps.verdict_checks import SIDES, TOLERANCE, bracket, check_certificate, check_verdict

import socp_statics as ss

BATCH = 8


def check_case(case: Case, engine: str, sides: int = SIDES, regions: bool = True, batches: bool = True) -> Outcome:
    """Put a stance to all checks.

    Args:
        case: Which stance.
        engine: "auto" or the name of an engine.
        sides: Of the pyramids of the linear programs.
        regions: Whether its region is traced and checked.
        batches: Whether random CoMs over its contacts are put to the batch call, where the toolkit has one.
    """
    out = unchecked(case)
    out.made("process")
    stance = stance_of(case)
    numbers = layout(stance)
    answer, programs, region = None, None, None
    with out.phase("verdict", "verdict"):
        answer = ss.check_equilibrium(stance, engine=engine)
    with out.phase("linear programs", "programs"):
        programs = bracket(stance, numbers, sides)
    with out.phase("checks", "verdict"):
        if answer is not None and programs is not None:
            check_verdict(out, stance, numbers, answer, *programs)
            check_certificate(out, stance, numbers, answer)
    if regions and abs(stance.gravity[2]) > 1e-9 * np.linalg.norm(stance.gravity):
        with out.phase("region", "region"):
            region = ss.trace_support_region(stance, engine=engine)
        with out.phase("checks", "region"):
            if region is not None:
                check_region(out, stance, numbers, region)
    if batches and hasattr(ss, "check_equilibrium_many"):
        with out.phase("batch", "batch"):
            _check_batch(out, stance, numbers, engine)
            if region is not None:
                _check_region_batch(out, stance, region, engine)
    return out


def unchecked(case: Case) -> Outcome:
    """What is known of a stance before anything is asked."""
    stance = stance_of(case)
    numbers = layout(stance)
    frictions = [c.friction for c in stance.contacts]
    return Outcome(
        case, case.family == "planted", len(stance.contacts), len(numbers.points), numbers.size, stance.mass,
        float(np.linalg.norm(numbers.anchor + numbers.centre)), (min(frictions), max(frictions)),
    )  # fmt: skip


def _check_batch(out: Outcome, stance, numbers: Layout, engine: str) -> None:
    """Batch calls agree with single ones: the stance's own CoM and random ones over and around its contacts."""
    rng = np.random.default_rng([out.case.seed, 7])
    contacts = stance.contacts
    at = rng.dirichlet(np.ones(len(contacts.points_W)), BATCH) @ (contacts.points_W - contacts.centre)
    coms = contacts.centre + rng.uniform(0.0, 2.0, (BATCH, 1)) * at
    coms[:, 2] = stance.com[2]
    coms[0] = stance.com
    loads = {"gravity": stance.gravity, "external_wrenches": stance.external_wrenches, "engine": engine}
    many = ss.check_equilibrium_many(contacts, coms, mass=stance.mass, **loads)
    for k, com in enumerate(coms):
        one = ss.check_equilibrium(contacts, com, stance.mass, **loads)
        a, b = float(many.margin[k]), one.margin
        out.made("batch")
        out.require(str(many.verdict[k]) == one.verdict, "batch", f"CoM {k}: {many.verdict[k]} in the batch, {one.verdict} alone")
        same = a == b or (np.isnan(a) and np.isnan(b)) or abs(a - b) <= TOLERANCE * max(numbers.W, abs(b))
        out.require(same, "batch", f"CoM {k}: margin {a:.12g} N in the batch, {b:.12g} N alone")
    threaded = ss.check_equilibrium_many(contacts, coms, mass=stance.mass, threads=2, **loads)
    same = np.array_equal(many.margin, threaded.margin, equal_nan=True) and list(many.verdict) == list(threaded.verdict)
    out.require(same, "batch", "two threads do not answer what one does")


def _check_region_batch(out: Outcome, stance, region, engine: str) -> None:
    """The region is the same to the last bit in a batch and in two threads."""
    for other in ss.trace_support_regions([stance, stance], threads=2, engine=engine):
        out.made("batch")
        same = other.kind == region.kind and np.array_equal(other.inner, region.inner) and np.array_equal(other.outer, region.outer)
        kinds = f"{other.kind} of {len(other.inner)} corners in the batch, {region.kind} of {len(region.inner)} alone"
        out.require(same, "batch", kinds)
