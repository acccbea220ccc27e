"""Idle contacts: those that no balance ever loads, wherever the centre of mass is moved horizontally."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from socp_statics.certificates import Motion, motion_of
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines import engines_for
from socp_statics.engines.solution import SOLVED
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.contact_load import MODEL
from socp_statics.models.support_region import RegionShape
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData
from socp_statics.statics.wrench_range import INSIDE, wrench_range

LOADED = 1e-6


class IdleContacts(NamedTuple):
    """Names of the contacts that cannot be loaded, and a motion that opens all of them without work of the load."""

    names: tuple[str, ...]
    motion: Motion


def idle_contacts(data: StaticsData, cone: ConeChoice, form: str, engine: str | Sequence[str], x: Array | None) -> IdleContacts:
    """Find the contacts that cannot be loaded.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        x: Scaled forces that balance the load: contacts that they load need no question.

    Returns:
        The idle contacts; none where no CoM position is in balance at all.

    Raises:
        EngineError: No engine settled a program.
    """
    reach = wrench_range(np.hstack([data.wrench_map, data.com_load]))
    still = Motion(np.zeros(6), np.zeros(len(data.torques.names)))
    opening = still
    if reach.outside(data.load) > INSIDE:
        return IdleContacts((), still)
    shape = RegionShape(force_shape(data, cone, form, reach.rank), 2, False)
    values = force_values(data, cone, reach.basis) | {"D": reach.basis.T @ data.com_load, "cap": np.array(1.0)}
    names: list[str] = []
    for k in np.unique(data.contact_of_point):
        normal = np.zeros(data.wrench_map.shape[1])
        normal[data.normal][data.contact_of_point == k] = 1.0
        if x is not None and float(normal @ x) > LOADED:
            continue
        for one in engines_for(engine, form):
            solution = one.compile(MODEL, shape).solve({**values, "c": normal})
            if solution.status != "failed":
                break
        else:
            raise EngineError(f"contact '{data.names[k]}': whether it can be loaded was not settled", name=data.names[k])
        if solution.status != SOLVED:
            return IdleContacts((), still)
        if solution.objective <= LOADED:
            names.append(data.names[k])
            found = motion_of(data, reach.basis @ solution.duals["balance"], solution.duals.get("limits"))
            opening = Motion(opening.twist + found.twist, opening.joints + found.joints)
    return IdleContacts(tuple(names), opening)
