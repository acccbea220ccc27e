"""Verdict, margin and certificate of one stance against linear programs, forces and motions from scratch."""

from __future__ import annotations

import numpy as np
from oracles import largest_loads, linear_stance
from rechecks import motion_power
from sweeps.independent_checks import force_faults
from sweeps.layout import Layout, layout
from sweeps.outcome import Outcome
from sweeps.pyramid_programs import Optimum, largest_reserve, pyramid_program

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ContactSet, Stance

EXACT = ConeChoice()
SIDES, COARSE = 256, 32
TOLERANCE = 1e-9
BOUNDARY = 1e-7
BALANCE, CONE, MOTION = 1e-8, 1e-7, 1e-7
LOADED = 1e-6
# Beyond this many W a margin and an infinite one are the same to programs in double precision.
ENDLESS = 1e6


def bracket(stance, numbers: Layout, sides: int = SIDES) -> tuple[Optimum, Optimum]:
    """Margins over pyramids inside and outside the cones."""
    program, start = pyramid_program(stance, numbers, "inscribed", sides)
    low = largest_reserve(program, start)
    program, _ = pyramid_program(stance, numbers, "circumscribed", sides)
    return low, largest_reserve(program, low.rays)


def check_verdict(out: Outcome, stance, numbers: Layout, answer, low: Optimum, high: Optimum) -> None:
    """The margin lies in its bracket, the verdict does not contradict it, and is open only where that may be."""
    margin = answer.margin / numbers.W if np.isfinite(answer.margin) else answer.margin
    out.verdict, out.reason, out.engine, out.handovers = answer.verdict, answer.reason, answer.engine, answer.handovers
    out.margin, out.low, out.high = margin, low.value, high.value
    out.doubt = max(relative(low.doubt, low.value), relative(high.doubt, high.value))
    out.made("programs")
    settled = np.isfinite(low.doubt) and np.isfinite(high.doubt)
    out.require(settled, "programs", f"{low.value:.6g} W with a doubt of {low.doubt:.1e}, {high.value:.6g} W with {high.doubt:.1e}")
    in_reach = not np.isnan(low.value)
    if settled and not out.planted:
        out.require(in_reach != np.isnan(margin), "margin", f"margin {margin:.6g} W where the programs have {low.value:.6g} W")
    if in_reach and not np.isnan(margin):
        check_margin(out, "margin", margin, low, high)
    if answer.idle:
        low, high = _check_idle(out, stance, answer)
    out.expected = "stable" if low.value >= BOUNDARY else "unstable" if high.value <= -BOUNDARY else "open"
    slack = TOLERANCE + max(relative(low.doubt, low.value), relative(high.doubt, high.value))
    out.made("verdict")
    if answer.verdict == "stable":
        out.require(not high.value < -slack, "verdict", f"stable, but {high.value:.3e} W over circumscribed pyramids")
    elif answer.verdict == "unstable":
        out.require(not low.value > slack, "verdict", f"unstable, but {low.value:.3e} W over inscribed pyramids")
    else:
        _check_open(out, low, high)


def relative(doubt: float, value: float) -> float:
    """A doubt over the larger of the value and 1 W; none where the value is infinite."""
    return doubt / max(1.0, abs(value)) if np.isfinite(value) else 0.0


def check_margin(out: Outcome, check: str, margin: float, low: Optimum, high: Optimum) -> None:
    """A margin lies between two programs, up to the tolerance and what these leave open themselves."""
    out.made(check)
    for bound, side, name in ((low, 1.0, "inscribed"), (high, -1.0, "circumscribed")):
        nearly_endless = margin == np.inf and np.isfinite(bound.value) and bound.value > ENDLESS
        if bound.value == margin or nearly_endless:
            continue
        over = side * (bound.value - margin) / (max(1.0, abs(bound.value)) if np.isfinite(bound.value) else 1.0)
        if np.isfinite(over):
            out.excess = max(out.excess, over)
        out.require(over <= TOLERANCE + relative(bound.doubt, bound.value), check, f"{margin:.12g} W, {name} {bound.value:.12g} W")


def _check_open(out: Outcome, low: Optimum, high: Optimum) -> None:
    out.made("undecided")
    if out.planted:
        out.open_because = "planted"
    elif out.expected != "open":
        out.open_because = f"the programs say {out.expected}"
    elif np.isnan(low.value):
        out.open_because = "load hardly out of reach"
    elif max(abs(low.value), abs(high.value)) <= BOUNDARY:
        out.open_because = "both programs within the boundary"
    else:
        out.open_because = "the programs disagree"
    allowed = out.planted or out.open_because == "the programs disagree"
    out.require(allowed, "undecided", f"{out.open_because}: {low.value:.3e} to {high.value:.3e} W")


def _check_idle(out: Outcome, stance, answer) -> tuple[Optimum, Optimum]:
    """Idle contacts cannot be loaded wherever the CoM is; the bracket of the others decides."""
    out.made("idle")
    loads = largest_loads(linear_stance(stance, "inscribed", COARSE))
    for name in answer.idle:
        out.require(not loads[name] > LOADED + TOLERANCE, "idle", f"contact '{name}' is said to be idle and can carry {loads[name]:.3e} W")
    rest = [c for c in stance.contacts if c.name not in answer.idle]
    if not rest:
        return Optimum(np.nan, 0.0, np.zeros(0)), Optimum(np.nan, 0.0, np.zeros(0))
    part = Stance(ContactSet(rest), stance.com, stance.mass, stance.gravity, stance.external_wrenches)
    there = layout(part)
    low, high = bracket(part, there)
    if answer.idle_margin is not None and not np.isnan(low.value):
        check_margin(out, "idle", answer.idle_margin / there.W, low, high)
    return low, high


def check_certificate(out: Outcome, stance, numbers: Layout, answer) -> None:
    """Forces of "stable" and the motion of "unstable" hold when everything is worked out again."""
    if answer.verdict == "stable":
        out.made("forces")
        (balance,), (cone,) = force_faults(numbers, stance, stance.com[None, :2], [answer.forces])
        out.note("balance of forces [W]", balance)
        out.note("cones of forces [W]", cone)
        out.require(balance <= BALANCE, "forces", f"forces miss the balance by {balance:.2e} W")
        out.require(cone <= CONE, "forces", f"forces leave their cones by {cone:.2e} W")
    elif answer.verdict == "unstable":
        out.made("motion")
        if answer.certificate is None:
            out.require(False, "motion", "unstable without a motion")
            return
        power, against = motion_power(stance, answer.certificate, EXACT)
        out.note("forces against motions [of its speed]", against)
        out.require(power > 0, "motion", f"load and forces do {power:.3e} W of power on the motion")
        out.require(against <= MOTION, "motion", f"a force could work against the motion at {against:.2e} of its speed")
