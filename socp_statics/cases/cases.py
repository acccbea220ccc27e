"""The cases of a sweep, one by one from the text of its problem."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from socp_statics.cases.problem import Problem, problem_from_tables
from socp_statics.cases.schema import swept_tables
from socp_statics.cases.sweep import Values, case_values


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
        tables, values = self.tables(number)
        read = problem_from_tables(tables, self.name, label=f"{self.label} case {number}", path=self.path)
        return replace(read, number=number, swept=values)
