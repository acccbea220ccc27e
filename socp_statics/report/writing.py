"""Writing a report beside the records it is about."""

from __future__ import annotations

from pathlib import Path

from socp_statics.cases.writing import finished_or_absent
from socp_statics.exceptions import StaticsError
from socp_statics.report.gathering import gather
from socp_statics.report.page import html
from socp_statics.report.summary import markdown, opening
from socp_statics.runner import load_results

PAGE, SUMMARY = "report.html", "summary.md"


def write_report(folder: str | Path) -> str:
    """Write ``report.html`` and ``summary.md`` into a results folder.

    Args:
        folder: A folder that ``socp-statics run`` has written.

    Returns:
        The sentence both begin with.

    Raises:
        InputError: It is no such folder, or a shard of it cannot be read.
        StaticsError: A file could not be written.
    """
    place = Path(folder)
    found = gather(load_results(place), place.resolve().name)
    for name, text in ((PAGE, html(found)), (SUMMARY, markdown(found))):
        try:
            with finished_or_absent(place / name) as draft:
                draft.write_text(text, encoding="utf-8")
        except OSError as error:
            message = f"{place / name}: the report could not be written ({error.strerror})"
            raise StaticsError(message, name=str(place / name)) from error
    return opening(found)
