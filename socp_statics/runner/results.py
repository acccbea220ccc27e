"""Reading a results folder: its records one at a time, and a table of their numbers."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from socp_statics.cases.record import Record
from socp_statics.exceptions import InputError
from socp_statics.runner.folder import check_results_folder
from socp_statics.runner.manifest import Manifest
from socp_statics.runner.shards import ENDING, FOLDER, TIMES_ENDING, case_number

MOST_OPEN = 16
COLUMNS = (
    "problem", "case", "model", "hash", "status", "verdict", "reason", "cone", "objective", "margin", "idle_margin", "com_margin", "mass",
    "com_x", "com_y", "com_z", "contacts", "region", "inner_area", "outer_area", "relative_gap", "solves", "balance", "engine", "handovers",
    "failure", "seconds",
)  # fmt: skip
NUMBERS = frozenset(
    ("objective", "margin", "idle_margin", "com_margin", "mass", "com_x", "com_y", "com_z", "inner_area", "outer_area", "relative_gap",
     "balance", "seconds")
)  # fmt: skip


class Results(Sequence[Record]):
    """The records of a folder, read from disk when they are asked for.

    Args:
        folder: The folder.
        stale: Whether records that no longer hold come too.

    Raises:
        InputError: The folder is not one of results, or a shard of it cannot be read.
    """

    def __init__(self, folder: str | Path, stale: bool = False):
        self.folder = Path(folder)
        check_results_folder(self.folder, "results folder")
        self.manifest = _manifest(self.folder)
        places: list[tuple[str, int, str, int]] = []
        for file, shard in self.manifest.shards.items():
            old = self.manifest.stale.get(file, set())
            places += [
                (shard.problem, number, file, line) for line, (number, *_) in enumerate(shard.cases) if stale or number not in old
            ]
        self._places = [(file, line) for _, _, file, line in sorted(places)]
        self._offsets: dict[str, list[int]] = {}

    @property
    def stale_count(self) -> int:
        """Number of records that no longer hold."""
        return sum(map(len, self.manifest.stale.values()))

    def __len__(self) -> int:
        return len(self._places)

    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, slice):
            return [self[k] for k in range(*i.indices(len(self)))]
        file, line = self._places[i]
        with self._opened(file) as shard:
            return self._record(file, line, shard)

    def __iter__(self) -> Iterator[Record]:
        return (record for record, _ in self.timed())

    def of(self, problem: str) -> list[Record]:
        """The records of one problem, in the order of its cases; no shard of another is opened."""
        return [self[k] for k, (file, _) in enumerate(self._places) if self.manifest.shards[file].problem == problem]

    def timed(self) -> Iterator[tuple[Record, float | None]]:
        """Each record with its time [s], None where that is not known."""
        kept: dict[str, BinaryIO] = {}
        seconds: dict[str, dict[int, float]] = {}
        try:
            for file, line in self._places:
                if file not in kept:
                    # Few files of one problem are read side by side: they were finished side by side.
                    while len(kept) >= MOST_OPEN:
                        kept.pop(next(iter(kept))).close()
                    kept[file], seconds[file] = self._opened(file), self._seconds(file)
                record = self._record(file, line, kept[file])
                yield record, seconds[file].get(case_number(record))
        finally:
            for shard in kept.values():
                shard.close()

    def _opened(self, file: str) -> BinaryIO:
        path = self.folder / FOLDER / file
        try:
            return open(path, "rb")
        except OSError as error:
            raise _unreadable(path, error) from error

    def _record(self, file: str, line: int, shard: BinaryIO) -> Record:
        """One line of an open shard."""
        try:
            if file not in self._offsets:
                shard.seek(0)
                self._offsets[file] = [0, *itertools.accumulate(map(len, shard))]
            shard.seek(self._offsets[file][line])
            return Record.of_line(shard.readline())
        except (OSError, ValueError, IndexError) as error:
            raise _unreadable(self.folder / FOLDER / file, error) from error

    def _seconds(self, file: str) -> dict[int, float]:
        path = self.folder / FOLDER / (file.removesuffix(ENDING) + TIMES_ENDING)
        try:
            return {entry["case"]: entry["seconds"] for entry in map(json.loads, path.read_text(encoding="utf-8").splitlines())}
        except (OSError, ValueError, KeyError, TypeError):
            # A checkout has records without times.
            return {}

    def rows(self) -> Iterator[dict[str, Any]]:
        """One row a record: the numbers and words of `table`, and the swept values."""
        return (row_of(record, seconds) for record, seconds in self.timed())

    def table(self) -> dict[str, list[Any]]:
        """Columns, for ``pandas.DataFrame(...)`` and ``polars.DataFrame(...)``.

        Returns:
            Name to values: what was asked (`COLUMNS`), verdict, margins [N, m], areas [m^2], time [s]; one more column for each swept key.
            Infinite margins are float infinities; None where a record has no such number.
        """
        rows = list(self.rows())
        names = dict.fromkeys([*COLUMNS, *(key for row in rows for key in row)])
        return {name: [row.get(name) for row in rows] for name in names}

    def write_parquet(self, path: str | Path) -> None:
        """Write the table as a Parquet file.

        Args:
            path: The file.

        Raises:
            InputError: The extra ``table`` is not installed, or the file cannot be written.
        """
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError as error:
            raise InputError("Parquet needs the extra table: pip install 'socp-statics[table]'", name=str(path), field="table") from error
        columns = {name: _uniform(values) for name, values in self.table().items()}
        try:
            parquet.write_table(pyarrow.table(columns), path)
        except OSError as error:
            raise InputError(f"{path}: a file that can be written is expected ({error})", name=str(path)) from error


def _uniform(values: list[Any]) -> list[Any]:
    """A column of one type, as Parquet wants it: numbers, else words."""
    kinds = {type(value) for value in values if value is not None}
    if kinds <= {int, float}:
        return [float(v) if v is not None and float in kinds else v for v in values]
    if len(kinds) < 2 and kinds <= {str, bool}:
        return values
    return [v if v is None or isinstance(v, str) else json.dumps(v) for v in values]


def row_of(record: Mapping[str, Any], seconds: float | None) -> dict[str, Any]:
    """The row of a record in a table.

    Args:
        record: The record.
        seconds: What it took [s], None where that is not known.
    """
    region, made = record.get("region") or {}, record["case"].get("generated") or {}
    com = made.get("com") or (None, None, None)
    row = {key: record.get(key) for key in ("problem", "model", "hash", "status", "verdict", "reason", "objective", "margin", "idle_margin",
                                            "com_margin", "engine", "handovers")}  # fmt: skip
    row |= {
        "case": case_number(record),
        "cone": record["cone"]["kind"],
        "mass": made.get("mass") or None,
        "com_x": com[0],
        "com_y": com[1],
        "com_z": com[2],
        "contacts": len(made.get("contacts") or ()),
        "region": region.get("kind"),
        **{key: region.get(key) for key in ("inner_area", "outer_area", "relative_gap", "solves")},
        "balance": record["residuals"]["balance"],
        "failure": record.get("failure"),
        "seconds": seconds,
    }
    ordered = {key: _number(row[key]) if key in NUMBERS else row[key] for key in COLUMNS}
    return ordered | dict(record.get("sweep", {}).get("values", {}))


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def _unreadable(path: Path, error: Exception) -> InputError:
    return InputError(f"{path}: a shard of records is expected ({error}); socp-statics run computes it anew", name=str(path))


def _manifest(folder: Path) -> Manifest:
    try:
        return Manifest(folder).read()
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        message = f"{folder / 'manifest.jsonl'}: this manifest is damaged ({error}); socp-statics run puts it right"
        raise InputError(message, name=str(folder)) from error


def load_results(folder: str | Path, *, stale: bool = False) -> Results:
    """The records of a results folder.

    Args:
        folder: A folder that ``socp-statics run`` has written.
        stale: Whether records of cases that have changed since come too.

    Returns:
        A sequence of records by problem and case, which are read when they are asked for; ``.table()`` has their numbers.

    Raises:
        InputError: It is no such folder.
    """
    if not isinstance(folder, str | Path):
        message = f"folder: the path of a folder that socp-statics run has written is expected, got {folder!r}"
        raise InputError(message, name=str(folder), field="folder")
    return Results(folder, stale)

