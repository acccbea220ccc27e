"""``[posture]`` with a robot: the keys every generator has, and those that the signature of the generator adds."""

from __future__ import annotations

import functools
import inspect
import operator
import re
import types
import typing
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, create_model

from socp_statics.cases.posture_statements import (
    GRAVITY,
    TYPES,
    Corners,
    ExternalWrenchStatement,
    Gravity,
    Limits,
    NormalForce,
    Position,
    Rotation,
    Shape,
    Size,
    Torsion,
    Transmits,
)
from socp_statics.cases.statement import Bound, Pair, Statement, Vector3

WORDS: dict[Any, str] = {float: "a finite number", int: "a whole number", str: "a word in quotes", bool: "true or false"}
FREE_KEYS = ("gravity", "external_wrenches", "torque_limits", "frames")


class FrameStatement(Statement):
    """A table ``[posture.frames.NAME]``: a contact of the robot; which keys go with which type is known to the contact classes."""

    frame: str = Field(min_length=1, description="the name of a link of the robot")
    type: str = Field(description=f"one of {TYPES}")
    position: Position = [0.0, 0.0, 0.0]
    rotation: Rotation = None
    normal_force: NormalForce = None
    size: Size = None
    vertices: Corners = None
    torsional_friction: Torsion = None
    shape: Shape = None
    transmits: Transmits = None
    limits: Limits = None


class LinkWrenchStatement(ExternalWrenchStatement):
    """An entry of ``[[posture.external_wrenches]]`` where there is a robot."""

    link: str | None = Field(None, min_length=1, description="the name of a link of the robot")


def _number_or(word: str, kind: type) -> Discriminator:
    """Tells a number from a list or table, so that a wrong value is judged as what it was meant to be."""
    return Discriminator(lambda value: word if isinstance(value, kind) else "number")


Friction = Annotated[float, Field(ge=0, description="a finite number >= 0")]
Frictions = Annotated[
    Annotated[Friction, Tag("number")] | Annotated[dict[str, Friction], Tag("table")],
    _number_or("table", Mapping),
    Field(description="a finite number >= 0, or a table of contact = finite number >= 0"),
]
TorqueLimit = Annotated[
    Annotated[Bound, Field(ge=0), Tag("number")] | Annotated[Pair, Tag("pair")],
    _number_or("pair", list),
    Field(description="a number >= 0, or [lower, upper] with lower <= 0 <= upper [N m]"),
]
Frame = Annotated[FrameStatement, Field(description="a table with frame and type")]


class RobotPosture(Statement):
    """What every generator with a robot has; `generator_statement` adds the rest."""

    generator: str = Field(description="a posture generator")
    robot: str = Field(min_length=1, description="the name of a robot in quotes, see socp-statics list robots, or the path of a URDF")
    gravity: Gravity = GRAVITY
    external_wrenches: list[LinkWrenchStatement] = Field([], description="a list of [[posture.external_wrenches]]")
    torque_limits: dict[str, TorqueLimit] | None = Field(None, description="a table [posture.torque_limits]")
    frames: dict[str, Frame] | None = Field(None, description="tables [posture.frames.NAME]")

    def stated(self) -> dict[str, Any]:
        """The posture with defaults filled in, what makes it before what acts on it."""
        keys = super().stated()
        return {key: keys[key] for key in keys if key not in FREE_KEYS} | {key: keys[key] for key in FREE_KEYS if key in keys}


SHARED: dict[str, Any] = {
    "support": Annotated[list[str], Field(min_length=1, description="a list of at least one contact of the robot")],
    "at": Annotated[Vector3, Field(description="three finite numbers [m]")],
    "friction": Frictions,
}


@functools.cache
def generator_statement(generate: Callable[..., Any]) -> type[RobotPosture]:
    """The table of a generator: its keyword arguments are keys, with their defaults.

    Args:
        generate: ``generate(robot, *, support=..., at=..., friction=..., <its own>) -> Posture``.
    """
    fields: dict[str, Any] = {}
    for name, parameter in list(inspect.signature(generate, eval_str=True).parameters.items())[1:]:
        if parameter.kind in (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL):
            continue
        kind, default = SHARED.get(name), parameter.default
        if kind is None:
            own, words = _as_in_toml(parameter.annotation, _unit(generate, name))
            kind = Annotated[own if default is not None else own | None, Field(description=words)]
        if default is inspect.Parameter.empty:
            default = ...
        fields[name] = (kind, list(default) if isinstance(default, tuple) else default)
    return create_model("Posture", __base__=RobotPosture, **fields)


def _as_in_toml(annotation: Any, unit: str) -> tuple[Any, str]:
    """What TOML can hold of the values that an annotation allows, and what to call it in a sentence."""
    origin, inner = typing.get_origin(annotation), typing.get_args(annotation)
    if annotation in WORDS:
        return annotation, WORDS[annotation] + (unit if annotation in (float, int) else "")
    if origin is Literal:
        return annotation, " or ".join(repr(choice) for choice in inner)
    if origin in (typing.Union, types.UnionType):
        options = [_as_in_toml(part, unit) for part in inner if part is not types.NoneType]
        return functools.reduce(operator.or_, (kind for kind, _ in options)), " or ".join(words for _, words in options)
    if inspect.isclass(origin) and issubclass(origin, Mapping | Sequence):
        kind, words = _as_in_toml(inner[-1], unit)
        if issubclass(origin, Mapping):
            return dict[str, Annotated[kind, Field(description=words)]], f"a table, each entry {words}"  # type: ignore[valid-type]
        return list[kind], f"a list, each entry {words}"  # type: ignore[valid-type]
    return Any, "a value that this generator takes"


def _unit(generate: Callable[..., Any], name: str) -> str:
    """The unit that the docstring gives to an argument, with a space before it."""
    units = re.findall(rf"^ *{name}: .*?(\[[^\]]+\])", inspect.getdoc(generate) or "", re.MULTILINE)
    return f" {units[0]}" if units else ""
