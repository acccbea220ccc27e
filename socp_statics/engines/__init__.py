"""How a program is solved. One interface (`engine.Engine`), one file or folder for each engine."""

from collections.abc import Sequence
from functools import cache

from socp_statics.engines.engine import Engine as Engine
from socp_statics.exceptions import InputError
from socp_statics.registry import Registry

ENGINES = Registry("engine", group="socp_statics.engines")
ENGINES.add("kernel", "our own interior-point method, compiled for this machine", "socp_statics.engines.kernel.engine:KernelEngine")
ENGINES.add("clarabel", "Clarabel on data compiled once a model and shape", "socp_statics.engines.compiled:CompiledEngine")
ENGINES.add("cvxpy", "the reference: cvxpy with any installed solver", "socp_statics.engines.reference:ReferenceEngine")

AUTO = ("kernel", "clarabel", "cvxpy")
# A single answer on the command line does not wait for the kernel to be compiled.
SINGLE = ("clarabel", "cvxpy")


@cache
def _loaded(name: str) -> Engine:
    return ENGINES.load(name)()


def engine_names(engine: str | Sequence[str]) -> tuple[str, ...]:
    """Names of the engines to try in turn.

    Args:
        engine: "auto", one registered engine, or several in the order wanted.

    Raises:
        InputError: There is no such engine.
    """
    if engine == "auto":
        return AUTO
    names = (engine,) if isinstance(engine, str) else tuple(engine)
    for name in names:
        if name not in ENGINES.names():
            raise InputError(f"engine {name!r} is not known; known: auto, {', '.join(ENGINES.names())}", name=str(name), field="engine")
    if not names:
        raise InputError(f"engine: at least one of {', '.join(ENGINES.names())} is expected, got none", name="engine", field="engine")
    return names


def engines_for(engine: str | Sequence[str], form: str = "socp") -> tuple[Engine, ...]:
    """The engines to try in turn, for "auto" the fastest first, then those that take over where it does not settle.

    Args:
        engine: "auto", one registered engine, or several in the order wanted.
        form: "socp" or "sdp": engines that do not take it are left out.

    Raises:
        InputError: There is no such engine, or none of them takes the form.
    """
    names = engine_names(engine)
    taking = tuple(one for one in map(_loaded, names) if one.accepts(None, form))
    if not taking:
        raise InputError(f"engine {', '.join(names)} does not take programs in form {form!r}", name=names[0], field="engine")
    return taking


def compiled_first(engine: str | Sequence[str], form: str) -> bool:
    """Whether the kernel's compiled programs are to be tried before any other way."""
    return form == "socp" and (engine in ("auto", "kernel") or engine_names(engine)[0] == "kernel")
