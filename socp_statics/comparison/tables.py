"""A comparison as a table: CSV for other programs, Markdown to read."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from socp_statics.comparison.times import Timed

STANCE_COLUMNS = (
    "quantity", "unit", "kind", "sides", "heading", "value", "state", "error", "relative_error", "side", "violation_share",
    "violation_force", "engine",
)  # fmt: skip
RATE_COLUMNS = ("of", "false", "rate", "low", "high")
AREA_COLUMNS = ("regions", "median", "low", "high", "worst", "within", "lost", "endless")


class Table(NamedTuple):
    """A printed table: what it shows, its head, and its rows."""

    title: str
    head: tuple[str, ...]
    rows: list[tuple[str, ...]]


def csv_table(comparison: Mapping[str, Any], times: Iterable[Timed] = ()) -> str:
    """All rows as CSV.

    Args:
        comparison: The comparison.
        times: Times of a stance; a column for each engine, in the rows of the heading they were measured at.

    Returns:
        The text, a header line first.
    """
    rows = _stance_rows(comparison, times) if comparison["comparison"] == "stance" else _population_rows(comparison)
    columns = list(dict.fromkeys(key for row in rows for key in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def markdown_table(comparison: Mapping[str, Any], times: Iterable[Timed] = ()) -> str:
    """What the command prints, as Markdown: the answer, one row for each pyramid, and the times.

    Args:
        comparison: The comparison.
        times: Times of a stance.
    """
    blocks = [f"**{comparison['problem'] or 'records'}**: {comparison['answer']}"]
    blocks += [f"{title}\n\n{_markdown(head, rows)}" for title, head, rows in printed_tables(comparison, times)]
    return "\n\n".join(blocks) + "\n"


def printed_tables(comparison: Mapping[str, Any], times: Iterable[Timed] = ()) -> list[Table]:
    """The tables that the command prints.

    Args:
        comparison: The comparison.
        times: Times of a stance.
    """
    tables = _stance_tables(comparison) if comparison["comparison"] == "stance" else _population_tables(comparison)
    timed = list(times)
    return [*tables, _times_table(timed)] if timed else tables


def _stance_tables(comparison: Mapping[str, Any]) -> list[Table]:
    head = ("sides", "inscribed: error", "side", "circumscribed: error", "side", "beyond the cone")
    tables: list[Table] = []
    for name, exact in comparison["exact"].items():
        of = {(row["kind"], row["sides"]): row for row in comparison["spread"] if row["quantity"] == name}
        rows: list[tuple[str, ...]] = []
        for sides in comparison["sides"]:
            inner, outer = of["inscribed", sides], of["circumscribed", sides]
            beyond = f"{_percent(outer['violation'])}, {outer['violating_force']:.3g} N" if outer["violation"] else "0"
            rows.append((str(sides), _range(inner), inner["side"], _range(outer), outer["side"], beyond))
        relative = "of the weight" if name == "margin" else "of it"
        title = f"{name}: exact {_number(exact['value'])} {exact['unit']} ({exact['state']}), errors in per cent {relative}"
        tables.append(Table(title, head, rows))
    return tables


def _population_tables(comparison: Mapping[str, Any]) -> list[Table]:
    counts = ", ".join(f"{count} {word}" for word, count in comparison["verdicts"].items())
    tables: list[Table] = []
    for kind, error in (("inscribed", "falsely unstable, of the stable"), ("circumscribed", "falsely stable, of the unstable")):
        rows, head = [], ("where", *(f"{n} sides" for n in comparison["sides"]))
        for where in _wheres(comparison["rates"]):
            of = {row["sides"]: row for row in comparison["rates"] if row["kind"] == kind and row["where"] == where}
            if of:
                rows.append((_where_text(where), *(_rate_text(of.get(n)) for n in comparison["sides"])))
        tables.append(Table(f"{kind} pyramids: {error} ({comparison['stances']} stances: {counts})", head, rows))
    head, rows = ("sides", "inscribed: median (5 to 95 %)", "within 1 %", "circumscribed: median (5 to 95 %)", "within 1 %"), []
    of = {(row["kind"], row["sides"]): row for row in comparison["areas"] if not row["where"]}
    for n in comparison["sides"]:
        cells = [cell for kind in ("inscribed", "circumscribed") for cell in _area_cells(of.get((kind, n)))]
        rows.append((str(n), *cells))
    return [*tables, Table("errors of the region's area", head, rows)] if of else tables


def _times_table(times: Sequence[Timed]) -> Table:
    """One row for each cone: CPU time of each engine in milliseconds."""
    engines = list(dict.fromkeys(t.engine for t in times))
    rows = []
    for quantity, kind, sides in dict.fromkeys((t.quantity, t.cone, t.sides) for t in times):
        mine = {t.engine: t for t in times if (t.quantity, t.cone, t.sides) == (quantity, kind, sides)}
        rows.append((quantity, kind if sides is None else f"{kind}, {sides} sides", *(_time_text(mine.get(engine)) for engine in engines)))
    return Table("CPU time of an answer, in ms (of it inside HiGHS)", ("quantity", "cone", *engines), rows)


def _stance_rows(comparison: Mapping[str, Any], times: Iterable[Timed]) -> list[dict[str, Any]]:
    columns: dict[tuple[Any, ...], dict[str, float]] = {}
    for t in times:
        columns.setdefault((t.quantity, t.cone, t.sides), {})[f"seconds_{t.engine}"] = t.seconds
        if t.inside is not None:
            columns[t.quantity, t.cone, t.sides][f"seconds_inside_{t.engine}"] = t.inside
    rows = []
    for name, exact in comparison["exact"].items():
        timed = columns.get((name, "exact", None), {})
        rows.append({column: None for column in STANCE_COLUMNS} | {"quantity": name, "kind": "exact", **exact, **timed})
        left = dict(columns)
        for row in (row for row in comparison["pyramids"] if row["quantity"] == name):
            beyond = {"violation_share": row["violation"]["share"], "violation_force": row["violation"]["force"]}
            flat = {key: value for key, value in row.items() if key != "violation"} | beyond | {"unit": exact["unit"]}
            rows.append({column: flat[column] for column in STANCE_COLUMNS} | left.pop((name, row["kind"], row["sides"]), {}))
    return rows


def _population_rows(comparison: Mapping[str, Any]) -> list[dict[str, Any]]:
    by = comparison["by"]
    rows = []
    for table, columns in (("rates", RATE_COLUMNS), ("areas", AREA_COLUMNS)):
        for row in comparison[table]:
            head = {"table": table, "kind": row["kind"], "sides": row["sides"], "error": row.get("error", "area")}
            rows.append(head | {name: row["where"].get(name, "") for name in by} | {key: row[key] for key in columns})
    return rows


def _wheres(rows: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Circumstances of the printed tables: none, and one at a time."""
    found: list[dict[str, Any]] = []
    for row in rows:
        if len(row["where"]) <= 1 and row["where"] not in found:
            found.append(row["where"])
    return found


def _where_text(where: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} {value}" for name, value in where.items()) or "all"


def _rate_text(row: Mapping[str, Any] | None) -> str:
    if row is None or row["rate"] is None:
        return "-"
    return f"{_percent(row['rate'])} ({100 * row['low']:.1f} to {100 * row['high']:.1f})"


def _area_cells(row: Mapping[str, Any] | None) -> tuple[str, str]:
    if row is None:
        return "-", "-"
    return f"{_signed(row['median'])} ({_signed(row['low'])} to {_signed(row['high'])})", _percent(row["within"])


def _range(row: Mapping[str, Any]) -> str:
    least, most = _signed(row["least"]), _signed(row["most"])
    return least if least == most else f"{least} to {most}"


def _signed(share: float | str | None) -> str:
    if share is None or isinstance(share, str):
        return str(share)
    text = f"{100.0 * share:+.2f}"
    return "0" if float(text) == 0.0 else text


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %"


def _number(value: float | str | None) -> str:
    return f"{value:.6g}" if isinstance(value, int | float) else str(value)


def _time_text(timed: Timed | None) -> str:
    if timed is None:
        return "-"
    return f"{1e3 * timed.seconds:.3f}" + (f" ({1e3 * timed.inside:.3f})" if timed.inside is not None else "")


def _markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
