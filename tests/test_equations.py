"""Every numbered equation of the chapter that is implemented has exactly one home, tagged in its docstring.

A tag is a line ``Implements (3.9).``; the lists below name the equations that are not built yet and those that are only definitions.
"""

import re
from collections import Counter
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "socp_statics"
EQUATIONS = [f"3.{i}" for i in range(1, 81)]
DEFINITIONS = {"3.79", "3.80"}
NOT_BUILT_YET: dict[str, set[str]] = {}


def tags():
    text = "\n".join(path.read_text() for path in sorted(PACKAGE.rglob("*.py")))
    lines = re.findall(r"^\s*Implements (\(3\.\d+\).*)$", text, re.M)
    return Counter(number for line in lines for number in re.findall(r"\((3\.\d+)\)", line))


def test_every_equation_has_one_home_or_is_listed():
    found = tags()
    missing = set().union(*NOT_BUILT_YET.values()) | DEFINITIONS
    assert set(found) <= set(EQUATIONS)
    assert {n: k for n, k in found.items() if k > 1} == {}
    assert set(EQUATIONS) - set(found) == missing


def test_nothing_built_is_listed_as_missing():
    assert not set(tags()) & (set().union(*NOT_BUILT_YET.values()) | DEFINITIONS)
