"""What every table of a problem file has in common: strict types, no unknown keys, and errors that name a key path.

Each field's description says what is expected, in the words of the error sentence: "posture.mass must be <description>, got -1".
"""

from __future__ import annotations

import types
import typing
from collections.abc import Mapping
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo

from socp_statics.cases.dotted import Part, key_text, parse_key
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest


class Statement(BaseModel):
    """A table of a problem file."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True)

    def stated(self) -> dict[str, Any]:
        """The table with defaults filled in; keys that stay unset are left out."""
        return self.model_dump(exclude_none=True)


def _read_infinity(value: Any) -> Any:
    return {"inf": float("inf"), "-inf": float("-inf")}.get(value, value) if isinstance(value, str) else value


Bound = Annotated[float, Field(allow_inf_nan=True), BeforeValidator(_read_infinity)]
Pair = Annotated[list[Bound], Field(min_length=2, max_length=2)]
Vector3 = Annotated[list[float], Field(min_length=3, max_length=3)]
Matrix3 = Annotated[list[Vector3], Field(min_length=3, max_length=3)]


def _statement_in(annotation: Any) -> type[Statement] | None:
    """The table that a field holds, directly, in a list or as an option."""
    if isinstance(annotation, type) and not isinstance(annotation, types.GenericAlias):
        return annotation if issubclass(annotation, Statement) else None
    return next((found for found in map(_statement_in, typing.get_args(annotation)) if found), None)


def _follow(model: type[Statement], loc: tuple[Part, ...]) -> tuple[type[Statement], FieldInfo | None, int]:
    """The table that holds the place of an error, its field there, and how many parts lead to that field."""
    holder, field, depth = model, None, 0
    for at, part in enumerate(loc):
        if not isinstance(part, str) or part not in holder.model_fields:
            continue
        field, depth = holder.model_fields[part], at + 1
        inside = _statement_in(field.annotation)
        if inside is None:
            break
        if at + 1 < len(loc):
            holder = inside
    return holder, field, depth


def _shown(value: Any) -> str:
    if isinstance(value, int) and value.bit_length() > 1024:
        return "a number too large to compute with"
    text = repr(value) if not isinstance(value, Mapping) else "a table"
    return text if len(text) <= 60 else text[:57] + "..."


def _owner(raw: Any, loc: tuple[Part, ...]) -> str:
    """The name of the contact (or other named entry) that a place belongs to, for the sentence."""
    owner = ""
    for part in loc:
        if isinstance(raw, Mapping) and isinstance(raw.get("name"), str):
            owner = f" of '{raw['name']}'"
        try:
            raw = raw[part]
        except (KeyError, IndexError, TypeError):
            break
    return owner


def _entry_description(annotation: Any) -> str | None:
    """What each entry of a table with free keys must be, where the table's field says so."""
    inner = typing.get_args(annotation)
    if typing.get_origin(annotation) is not dict:
        return next((found for found in map(_entry_description, inner) if found), None)
    return next((note.description for note in typing.get_args(inner[1])[1:] if isinstance(note, FieldInfo) and note.description), None)


def _in_the_file(raw: Any, loc: tuple[Part, ...]) -> tuple[Part, ...]:
    """A place without the words that only say which kind of value was expected there."""
    parts: tuple[Part, ...] = ()
    for part in loc:
        if (isinstance(raw, Mapping) and part in raw) or (isinstance(raw, list) and isinstance(part, int)):
            raw, parts = raw[part], (*parts, part)  # type: ignore[index]
    return parts


def _sentence(model: type[Statement], raw: Any, prefix: tuple[Part, ...], error: Any) -> tuple[str, str]:
    """Key path and sentence of one pydantic error."""
    loc: tuple[Part, ...] = tuple(error["loc"])
    raised = error.get("ctx", {}).get("error")
    if isinstance(raised, InputError):
        path = key_text((*prefix, *loc, *(parse_key(raised.field) if raised.field else ())))
        return path, f"{path}: {raised}"
    holder, field, depth = _follow(model, loc)
    if error["type"] == "extra_forbidden":
        path = key_text((*prefix, *loc))
        return path, f"{path} is not a known key{_owner(raw, loc)}{nearest(str(loc[-1]), holder.model_fields)}"
    expected = field.description if field is not None else error["msg"]
    known = (*prefix, *loc[:depth])
    path = key_text(known)
    if not loc:
        return path, f"{path} must be a table with keys of {', '.join(model.model_fields)}, got {_shown(error['input'])}"
    if error["type"] == "missing":
        return path, f"{path}{_owner(raw, loc)} is missing: it must be {expected}"
    rest = _in_the_file(raw, loc)[depth:]
    entry = _entry_description(field.annotation) if field is not None and rest and isinstance(rest[0], str) else None
    if entry:
        path, rest, expected = key_text((*known, rest[0])), rest[1:], entry
    inside = f" at {key_text(rest)}" if rest else ""
    return path, f"{path}{_owner(raw, loc)} must be {expected}, got {_shown(error['input'])}{inside}"


S = TypeVar("S", bound=Statement)


def read_statement(model: type[S], raw: Any, prefix: tuple[Part, ...], faults: dict[str, str], **context: Any) -> S | None:
    """Validate one table and add all its faults to the list.

    Args:
        model: The table's class.
        raw: What the file says.
        prefix: Where the table is, for example ``("posture",)``.
        faults: Key path -> sentence, added to.
        context: What validators may look at, for example the names of the contacts.

    Returns:
        The table, or None when it has faults.
    """
    try:
        return model.model_validate(raw, context=context)
    except ValidationError as failure:
        for error in failure.errors(include_url=False):
            path, sentence = _sentence(model, raw, prefix, error)
            faults.setdefault(path, sentence)
        return None
