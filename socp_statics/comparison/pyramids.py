"""Which pyramids a comparison looks at: numbers of sides, and headings spread over what symmetry leaves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from socp_statics.cones.choice import ConeChoice
from socp_statics.exceptions import InputError

SIDES = (3, 4, 6, 8, 16, 32)
PYRAMIDS = ("inscribed", "circumscribed")
HEADINGS = 8
MOST_SIDES = 512
MOST_HEADINGS = 360


def checked_sides(sides: Iterable[Any], option: str = "sides") -> tuple[int, ...]:
    """Numbers of sides in ascending order.

    Args:
        sides: Whole numbers from 3 to 512, each once.
        option: What to call them in the sentence.

    Raises:
        InputError: One is no such number, is given twice, or there is none.
    """
    given = list(sides)
    for one in given:
        if isinstance(one, bool) or not isinstance(one, int) or not 3 <= one <= MOST_SIDES:
            raise InputError(f"{option}: whole numbers from 3 to {MOST_SIDES} are expected, got {one!r}", name=str(one), field=option)
        if given.count(one) > 1:
            raise InputError(f"{option}: {one} is given twice, every number of sides once is expected", name=str(one), field=option)
    if not given:
        raise InputError(f"{option}: at least one number of sides is expected, got none", name=option, field=option)
    return tuple(sorted(given))


def checked_headings(headings: Any, option: str = "headings") -> int:
    """A number of headings, 1 to 360.

    Raises:
        InputError: It is none.
    """
    if isinstance(headings, bool) or not isinstance(headings, int) or not 1 <= headings <= MOST_HEADINGS:
        message = f"{option}: a whole number from 1 to {MOST_HEADINGS} is expected, got {headings!r}"
        raise InputError(message, name=str(headings), field=option)
    return headings


def pyramids(sides: int, headings: int, first: float = 0.0) -> list[ConeChoice]:
    """Both pyramids of a number of sides at evenly spread headings.

    Args:
        sides: Number of sides.
        headings: How many headings; a pyramid turned by 2 pi / sides is the same one.
        first: The first heading [rad].
    """
    turns = [first + 2.0 * math.pi * k / (headings * sides) for k in range(headings)]
    return [ConeChoice(kind, sides, turn) for kind in PYRAMIDS for turn in turns]


def shown_sides(sides: Sequence[int]) -> int:
    """The number of sides that figures and sentences speak of: four, or the fewest."""
    return 4 if 4 in sides else min(sides)
