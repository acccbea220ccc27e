"""The distributions in closed form side by side, for one stance or a batch of stances with equal contacts.

Each is ``F = C^-W F_e`` with a diagonal W of its own. What is left of the balance, by rounding or because contacts without a share are
needed after all, is added by the scaled pseudoinverse, so that every method balances whatever the contacts can balance. All numbers are
in units of W and size about the mean contact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from socp_statics.contacts import ContactSet
from socp_statics.contacts.joint import constraint_basis
from socp_statics.distribution.barycentric_rule import barycentric_shares
from socp_statics.distribution.friction_weights import friction_weights
from socp_statics.distribution.generalized_inverses import inverse_of_shares
from socp_statics.distribution.lever_rule import lever_shares
from socp_statics.distribution.scaled_question import DistributionQuestion
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array


class ClosedForm(NamedTuple):
    """A distribution in closed form.

    Attributes:
        line: What it is, in one line.
        shares: Inverse weights of the scaled components, shape (B, c); None where all are equal.
        refusal: Why contacts do not suit it, or None.
        by_lever: Whether it shares the load among contacts by where it acts.
    """

    line: str
    shares: Callable[[DistributionQuestion], Array] | None
    refusal: Callable[[ContactSet], str | None] = lambda contacts: None
    by_lever: bool = False


def _pseudoinverse(q: DistributionQuestion) -> Array:
    return q.in_si(np.ones_like(q.unit))


def _friction_weighted(q: DistributionQuestion) -> Array:
    return q.in_si(1.0 / friction_weights(q.contacts, q.exponent, q.geometry.frictions))


def _statics_consistent(q: DistributionQuestion) -> Array:
    return q.in_si(q.of_contacts(lever_shares(q.line)))


def _barycentric(q: DistributionQuestion) -> Array:
    return q.of_contacts(barycentric_shares(q.line))


def _no_lever(contacts: ContactSet) -> str | None:
    if len(contacts) not in (2, 3):
        return f"the lever rule is for two or three contacts, here are {len(contacts)}"
    for contact in contacts:
        if constraint_basis(contact).shape[1] < 6:
            carried = constraint_basis(contact).shape[1]
            return f"the lever rule is for contacts that carry a whole wrench, '{contact.name}' has {carried} of 6 components"
    return None


CLOSED_FORMS = {
    "pseudoinverse": ClosedForm("least sum of squares in newtons and newton metres", _pseudoinverse),
    "scaled_pseudoinverse": ClosedForm("least sum of squares with moments over the size of the contacts", None),
    "friction_weighted": ClosedForm("as the pseudoinverse, friction components dear where friction is low", _friction_weighted),
    "statics_consistent": ClosedForm(
        "the lever rule for two or three contacts that carry a whole wrench", _statics_consistent, _no_lever, by_lever=True
    ),
    "barycentric": ClosedForm("the lever rule for any number of contacts", _barycentric, by_lever=True),
}


def closed_forms(question: DistributionQuestion, methods: Sequence[str] | None = None) -> dict[str, Array]:
    """Components by method.

    Args:
        question: Maps and loads.
        methods: Names of `CLOSED_FORMS`; by default all that suit the contacts.

    Returns:
        Shapes (B, c) [N, N m].

    Raises:
        InputError: An unknown method, or one that does not suit the contacts.
    """
    if methods is None:
        methods = [name for name, form in CLOSED_FORMS.items() if form.refusal(question.contacts) is None]
    out = {}
    for name in methods:
        shares = checked_form(name, question.contacts).shares
        out[name] = question.plain() if shares is None else question.solve(shares(question))
    return out


def inverses(question: DistributionQuestion, method: str) -> Array:
    """C^# of a method for wrenches about the mean of the positions, in SI; the shares are those of the load.

    Args:
        question: Maps and loads.
        method: A name of `CLOSED_FORMS`.

    Returns:
        Shape (B, c, 6).
    """
    shares = checked_form(method, question.contacts).shares
    scaled = question.plain_inverse if shares is None else inverse_of_shares(question.map, shares(question))
    balanced = scaled + question.plain_inverse @ (np.eye(6) - question.map @ scaled)
    units = np.repeat(np.stack([question.force, question.force * question.length], axis=1), 3, axis=1)
    return question.unit[:, :, None] * balanced / units[:, None, :]


def checked_form(method: str, contacts: ContactSet) -> ClosedForm:
    """The closed form of a name, if it suits the contacts.

    Raises:
        InputError: An unknown method, or one that does not suit the contacts.
    """
    if method not in CLOSED_FORMS:
        raise InputError(f"method {method!r} is not known{nearest(method, CLOSED_FORMS)}", name=method, field="method")
    form = CLOSED_FORMS[method]
    reason = form.refusal(contacts)
    if reason is not None:
        raise InputError(f"method '{method}': {reason}", name=method, field="method")
    return form
