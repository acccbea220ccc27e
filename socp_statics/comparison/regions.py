"""Exact cones beside pyramids: what does linearising friction cost?"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from socp_statics.cones.choice import KINDS, ConeChoice
from socp_statics.contacts import Contact, ContactSet, Stance
from socp_statics.regions import SupportRegion, trace_support_region


def compare_regions(
    stance: Stance | ContactSet | Iterable[Contact],
    tolerance: float = 1e-3,
    *,
    sides: int = 4,
    heading: float = 0.0,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
) -> dict[str, SupportRegion]:
    """The support region with exact cones, inscribed pyramids and circumscribed pyramids.

    The regions are nested: inscribed in exact in circumscribed, each up to the tolerance.

    Args:
        stance: The stance, or contacts alone where neither mass nor height matters.
        tolerance: Of (outer area - inner area) / outer area of each region, between 0 and 1.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids: from t1 to the normal of their first face [rad].
        form: "socp" or "sdp", for the exact cones.
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The regions under "exact", "inscribed" and "circumscribed".

    Raises:
        InputError: A number, name or choice is wrong; gravity is zero or horizontal.
        EngineError: No engine settled a region.
    """
    asked = stance if isinstance(stance, Stance | ContactSet) else ContactSet(stance)
    choices = {kind: ConeChoice(kind, sides, heading) for kind in KINDS}
    return {kind: trace_support_region(asked, tolerance, cone=cone, form=form, engine=engine) for kind, cone in choices.items()}
