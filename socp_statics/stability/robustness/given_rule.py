"""A given affine rule of contact forces under pushes, in newtons and world axes, as a user states it: is it safe?"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ContactSet, ExternalWrench, SoftFingerContact, Stance
from socp_statics.contacts.numbers import scalar, vector
from socp_statics.contacts.stance import stance_of
from socp_statics.engines import engines_for
from socp_statics.exceptions import EngineError, InputError
from socp_statics.spatial import Array
from socp_statics.stability.robustness.disturbances import HORIZONTAL, pushes
from socp_statics.stability.robustness.rule import ForceRule, RuleCheck, check_rule
from socp_statics.statics import StaticsData, assemble


def check_push_rule(
    contacts: Any,
    forces: Any,
    gains: Any,
    radius: float,
    com: Any = None,
    mass: float | None = None,
    *,
    point: Any = None,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
) -> RuleCheck:
    """Whether forces ``forces + gains p`` hold every horizontal push p up to a radius; exact, by a linear matrix inequality (S-lemma).

    Args:
        contacts: Contacts of points, lines and surfaces; a Stance, which brings everything else; or a Posture.
        forces: Without a push, at the contact points (`ContactSet.points_W`), world axes, shape (n, 3) [N].
        gains: Change of the forces per newton of push along world x and y, shape (n, 3, 2).
        radius: Of the disc of pushes, > 0 [N].
        com: Centre of mass in world axes, shape (3,) [m].
        mass: Mass [kg].
        point: Where pushes act, world axes, shape (3,) [m]; the centre of mass by default.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot.

    Returns:
        The check; ``worst`` is in units of the radius.

    Raises:
        InputError: A number is wrong, or a contact is a handle or a soft finger, whose moments such a rule does not say.
        EngineError: No engine settled it.
    """
    stance = stance_of(contacts, com, mass, gravity, external_wrenches)
    choice = cone_choice(cone, sides, heading)
    for contact in stance.contacts:
        if not contact.unilateral or isinstance(contact, SoftFingerContact):
            message = f"contact '{contact.name}': a force rule is for points, lines and surfaces, got a {contact.type}"
            raise InputError(message, name=contact.name, field="contacts")
    n = len(stance.contacts.points_W)
    f = vector("force rule", "forces", forces, 3 * n, shape=(n, 3), kind="question")
    g = vector("force rule", "gains", gains, 6 * n, shape=(n, 3, 2), kind="question")
    r = scalar("force rule", "radius", radius, above=0.0, kind="question")
    at = np.array(stance.com if point is None else vector("force rule", "point", point, 3, kind="question"))
    data = assemble(stance)
    what = pushes(stance, data, at, None, HORIZONTAL)
    W = data.units.force
    reaction = np.column_stack([unknowns_of(data, stance, r * g[:, :, j] / W) for j in range(2)])
    rule = ForceRule(data, choice, what, r / W, unknowns_of(data, stance, f / W), reaction)
    details = []
    for one in engines_for(engine, "sdp"):
        try:
            return check_rule(rule, one)
        except EngineError as error:
            details.append(str(error))
    raise EngineError(f"the force rule was not settled: {'; '.join(details)}", name="force rule")


def unknowns_of(data: StaticsData, stance: Stance, forces: Array) -> Array:
    """Scaled forces at the contact points as x; what a frictionless contact cannot carry is an error.

    Args:
        data: The stance's arrays.
        stance: The stance, of points, lines and surfaces.
        forces: At ``stance.contacts.points_W``, world axes, shape (n, 3).

    Raises:
        InputError: A tangential force at a frictionless contact.
    """
    local = np.einsum("nji,nj->ni", data.rotation[data.contact_of_point], forces[_places(data, stance.contacts)])
    x = np.zeros(data.wrench_map.shape[1])
    x[data.tangential] = local[: data.slipping, :2].ravel()
    x[data.normal] = local[:, 2]
    smooth = np.abs(local[data.slipping :, :2])
    if smooth.max(initial=0.0) > 1e-9:
        name = data.names[data.contact_of_point[data.slipping + int(np.argmax(smooth.max(axis=1)))]]
        message = f"contact '{name}': forces and gains must be along the normal of a frictionless contact"
        raise InputError(message, name=name, field="forces")
    return x


def _places(data: StaticsData, contacts: ContactSet) -> NDArray[np.int_]:
    """Where the points of x are in ``points_W``."""
    starts = np.cumsum([0, *(len(c.points_C) for c in contacts)])
    places = np.empty(data.points, dtype=int)
    for k in np.unique(data.contact_of_point):
        mine = np.flatnonzero(data.contact_of_point == k)
        places[mine] = starts[k] + np.arange(len(mine))
    return places
