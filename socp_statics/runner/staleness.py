"""Whether the records of a folder are those of the problems as they are now, without computing anything."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from socp_statics.cases.solve import first_engine
from socp_statics.runner.plan import questions
from socp_statics.runner.results import load_results
from socp_statics.runner.selection import select


def stale_problems(folder: str | Path, selectors: str | Path | Iterable[str | Path] = (), engine: str = "auto") -> dict[str, str]:
    """Problems whose records are missing, changed or failed.

    Args:
        folder: A folder that ``socp-statics run`` has written.
        selectors: As for `run`; all named problems by default.
        engine: The engine that the records should be from.

    Returns:
        Name to what is wrong; empty where ``run`` with the same arguments would compute nothing.

    Raises:
        InputError: It is no such folder, or a selector matches nothing.
    """
    results = load_results(folder)
    there: dict[str, set[int]] = {}
    for file, shard in results.manifest.shards.items():
        old = results.manifest.stale.get(file, set())
        there.setdefault(shard.problem, set()).update(number for number, *_ in shard.cases if number not in old)
    wrong = {}
    for question in questions(select(selectors), {}, first_engine(engine)):
        missing = question.cases - len(there.get(question.name, ()))
        if missing:
            wrong[question.name] = f"{missing} of {question.cases} records are missing"
        elif results.manifest.plans.get(question.name, {}).get("digest") != question.digest:
            wrong[question.name] = "the problem has changed since"
    return wrong
