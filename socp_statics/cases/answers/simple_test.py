"""``simple_test``: what generalised inverses, which know no friction, make of a stance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from socp_statics.cones.choice import ConeChoice
    from socp_statics.contacts import Stance

_CHECK_KEYS: dict[str, Any] = {
    "holds": None,
    "balance": None,
    "reading": None,
    "contacts": [{"contact": None, "force": [None], "moment": [None], "distance": None, "failure": None}],
}
SIMPLE_TEST_KEYS: dict[str, Any] = {"simple_test": {"pseudoinverse": _CHECK_KEYS, "friction_weighted": _CHECK_KEYS}}


def simple_tests(stance: Stance, cone: ConeChoice) -> dict[str, Any]:
    """The record's ``simple_test``: one entry an inverse.

    Args:
        stance: The stance.
        cone: Exact cones or pyramids.
    """
    from socp_statics.stability import simple_static_test
    from socp_statics.stability.simple_test import INVERSES

    return {inverse: simple_static_test(stance, inverse=inverse, cone=cone).as_record() for inverse in INVERSES}


def simple_test_lines(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    """One line an inverse for a person.

    Args:
        record: Of an equilibrium problem.
    """
    tests = record.get("simple_test", {})
    return [
        ("simple test", f"{inverse.replace('_', '-')} {'holds' if test['holds'] else 'fails'}: {test['reading']}")
        for inverse, test in tests.items()
    ]
