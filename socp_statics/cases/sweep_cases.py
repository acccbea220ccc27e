"""The cases of a sweep, one by one from the text of its problem: what all of them share is validated once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from socp_statics.cases.dotted import Part, parse_key, resolve
from socp_statics.cases.problem import Problem, problem_from_tables
from socp_statics.cases.schema import Names, read_posture, swept_tables
from socp_statics.cases.sweep import Values, case_values

# Keys of a posture that decide what else may be said in the file: the names of contacts, joints and limits.
DECIDING = ("generator", "robot", "frames", "torque_limits", "support", "contacts")


class Cases:
    """The cases of one problem.

    Args:
        raw: The file as TOML reads it.
        sweep: Dotted key -> values; empty for a problem of one case.
        name: What records call it.
        label: What sentences call it.
        path: The file.
    """

    def __init__(self, raw: Mapping[str, Any], sweep: Mapping[str, Values], name: str, label: str, path: Path | None):
        self.raw, self.sweep, self.name, self.label, self.path = raw, sweep, name, label, path
        # One case that was read as a whole for each set of names that its parameters and expectations may mention.
        self._alike: dict[Names, Problem] = {}
        self._paths = _posture_paths(raw, sweep)

    def tables(self, number: int) -> tuple[dict[str, Any], dict[str, Any]]:
        """The text of a case, and dotted key -> value of what makes it one.

        Args:
            number: From 0.
        """
        if not self.sweep:
            return dict(self.raw), {}
        return swept_tables(self.raw, self.sweep, number), case_values(self.sweep, number)

    def case(self, number: int) -> Problem:
        """A case, as `Problem.case` makes it.

        Args:
            number: From 0.

        Raises:
            InputError: Its values are wrong.
        """
        if not self.sweep:
            return problem_from_tables(self.raw, self.name, label=self.label, path=self.path)
        return (None if self._paths is None else self._like_another(self._paths, number)) or self._as_a_whole(number)

    def _as_a_whole(self, number: int) -> Problem:
        tables, values = self.tables(number)
        read = problem_from_tables(tables, self.name, label=f"{self.label} case {number}", path=self.path)
        return replace(read, number=number, swept=values)

    def _like_another(self, paths: Sequence[tuple[Part, ...]], number: int) -> Problem | None:
        """A case that differs from one read before in numbers of its posture only; None where it has faults.

        Such a case has the parameters and expectations of the other: they depend on the names of contacts and joints alone.
        """
        values = case_values(self.sweep, number)
        stated = self.raw["posture"]
        for path, value in zip(paths, values.values(), strict=True):
            stated = _with(stated, path[1:], value)
        read = read_posture(stated, None if self.path is None else self.path.parent)
        if read is None:
            return None
        posture, made, names = read
        if names not in self._alike:
            self._alike[names] = self._as_a_whole(number)
            return self._alike[names]
        tables = {key: value for key, value in self.raw.items() if key != "sweep"} | {"posture": stated}
        own = {"label": f"{self.label} case {number}", "posture": posture, "robot_posture": made, "raw": tables}
        return replace(self._alike[names], **own, number=number, swept=values)  # type: ignore[arg-type]


def _posture_paths(raw: Mapping[str, Any], sweep: Mapping[str, Values]) -> list[tuple[Part, ...]] | None:
    """Where the swept keys are, if all are numbers of the posture that decide nothing else; else None."""
    paths = [resolve(raw, parse_key(key, "sweep"), "sweep") for key in sweep]

    def plain(path: tuple[Part, ...]) -> bool:
        of_a_contact = len(path) > 2 and path[1] == "contacts" and path[-1] != "name"
        return len(path) > 1 and path[0] == "posture" and (path[1] not in DECIDING or of_a_contact)

    return paths if all(map(plain, paths)) and isinstance(raw.get("posture"), Mapping) else None


def _with(node: Any, path: Sequence[Part], value: Any) -> Any:
    """Nested tables and lists with one value replaced; what is not on the way is shared."""
    if not path:
        return value
    if isinstance(node, Mapping):
        return {**node, path[0]: _with(node.get(path[0], {}), path[1:], value)}
    at = int(path[0])
    return [*node[:at], _with(node[at], path[1:], value), *node[at + 1 :]]
