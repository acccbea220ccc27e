"""What the toolkit is compared with, one file each: `ways(question)` are the peer's ways of answering a kind of question.

A peer that is not installed has ways too, which say so; nothing imports it.
"""

from __future__ import annotations

from importlib.util import find_spec

from benchmarks.timing import Way


def not_installed(module: str, name: str) -> str | None:
    """Why a peer is missing, or None."""
    return None if find_spec(module) else f"{name}: not installed (pip install socp-statics[peers])"


def all_ways(question: str) -> list[Way]:
    """Every peer's ways of answering a kind of question."""
    # Imported here: the peers' files import this one.
    from benchmarks.peers import bare_clarabel, cvxpy_again, highs_programs, hpp_robustness, klampt_polygon, moreau_batch

    found = []
    for peer in (bare_clarabel, cvxpy_again, moreau_batch, klampt_polygon, hpp_robustness, highs_programs):
        found += peer.ways(question)
    return found
