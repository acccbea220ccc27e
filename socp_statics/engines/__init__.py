"""How a program is solved. One interface (`engine.Engine`), one file or folder for each engine; a kernel of our own joins as kernel/."""

from functools import cache

from socp_statics.engines.engine import Engine as Engine
from socp_statics.exceptions import InputError
from socp_statics.registry import Registry

ENGINES = Registry("engine", group="socp_statics.engines")
ENGINES.add("clarabel", "Clarabel on data compiled once a model and shape", "socp_statics.engines.compiled:CompiledEngine")
ENGINES.add("cvxpy", "the reference: cvxpy with any installed solver", "socp_statics.engines.reference:ReferenceEngine")

AUTO = ("clarabel", "cvxpy")


@cache
def _loaded(name: str) -> Engine:
    return ENGINES.load(name)()


def engines_for(name: str) -> tuple[Engine, ...]:
    """The engines to try in turn.

    Args:
        name: "auto", or one registered engine.

    Returns:
        One engine; for "auto" the fastest first, then those that take over where it does not settle.

    Raises:
        InputError: There is no such engine.
    """
    if name != "auto" and name not in ENGINES.names():
        raise InputError(f"engine {name!r} is not known; known: auto, {', '.join(ENGINES.names())}", name=str(name), field="engine")
    return tuple(_loaded(one) for one in (AUTO if name == "auto" else (name,)))
