"""A problem as TOML text: a file to copy and edit that loads back to the same problem."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from socp_statics.cases.dotted import key_text
from socp_statics.cases.problem import Problem


def problem_toml(problem: Problem) -> str:
    """The whole problem with its defaults filled in.

    Args:
        problem: With or without a sweep.

    Returns:
        TOML text that `load_problem` reads back to the same hash.
    """
    stated = problem.stated()
    posture, expect = stated["posture"], stated["expect"]
    head = {key: stated[key] for key in ("description", "model", "reference") if stated[key]}
    entry_tables = {key: value for key, value in posture.items() if _is_table_list(value)}
    named_tables = {key: value for key, value in posture.items() if _is_table_of_tables(value)}
    plain = {key: value for key, value in posture.items() if value != [] and key not in entry_tables and key not in named_tables}
    blocks = [_lines(head), "[posture]\n" + _lines(plain)]
    for key, tables in named_tables.items():
        blocks += [f"[{key_text(('posture', key, name))}]\n" + _lines(entry) for name, entry in tables.items()]
    for key, entries in entry_tables.items():
        blocks += [f"[[posture.{key}]]\n" + _lines(entry) for entry in entries]
    blocks.append("[parameters]\n" + _lines(stated["parameters"]))
    if problem.sweep:
        blocks.append("[sweep]\n" + _lines({key: _swept(values) for key, values in problem.sweep.items()}))
    if expect:
        blocks.append("[expect]\n" + _lines(expect))
    return "\n\n".join(blocks) + "\n"


def toml_value_text(value: Any) -> str:
    """One value as TOML writes it, on one line.

    Args:
        value: A word, number, boolean, list or mapping of them.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key_text((key,))} = {toml_value_text(entry)}" for key, entry in value.items()) + " }" if value else "{}"
    if isinstance(value, Sequence):
        return "[" + ", ".join(toml_value_text(entry) for entry in value) + "]"
    return str(value)


def _lines(table: Mapping[str, Any]) -> str:
    return "\n".join(f"{key_text((key,))} = {toml_value_text(value)}" for key, value in table.items())


def _is_table_list(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(entry, Mapping) for entry in value)


def _is_table_of_tables(value: Any) -> bool:
    return isinstance(value, Mapping) and bool(value) and all(isinstance(entry, Mapping) for entry in value.values())


def _swept(values: Sequence[Any]) -> Any:
    return {"from": values[0], "to": values[-1]} if isinstance(values, range) else list(values)
