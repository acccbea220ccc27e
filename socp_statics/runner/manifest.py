"""The manifest of a results folder: what was planned with which versions, what each shard holds, which records are stale.

It is a file of lines that only grows while a run goes on; a last line that is not complete counts as not written. What it does not
know of the shards (the process died between a shard and its line) is read from them.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from socp_statics.cases.hashing import SCHEMA
from socp_statics.cases.writing import finished_or_absent
from socp_statics.exceptions import InputError, StaticsError
from socp_statics.runner.shards import Shard

NAME = "manifest.jsonl"
HEADER = {"results": "socp-statics run", "schema": SCHEMA}
STALE, HOLDS = "stale", "holds"


class Manifest:
    """What is known of a results folder.

    Args:
        folder: The results folder.

    Attributes:
        plans: Problem to its latest plan: number of cases and digest.
        runs: Versions, engine and problems of each run, in order.
        shards: File of a shard to what it holds.
        stale: File of a shard to the numbers of its cases whose records a later one has replaced, or that no longer exist.
    """

    def __init__(self, folder: Path):
        self.path = folder / NAME
        self.plans: dict[str, dict[str, Any]] = {}
        self.runs: list[dict[str, Any]] = []
        self.shards: dict[str, Shard] = {}
        self.stale: dict[str, set[int]] = {}
        self._out: BinaryIO | None = None

    def read(self) -> Manifest:
        """Read what is there.

        Raises:
            InputError: There is no such file, or it is a manifest of another schema.
            ValueError: It is damaged.
        """
        try:
            content = self.path.read_bytes()
        except OSError as error:
            message = f"{self.path}: a manifest of socp-statics run is expected ({error.strerror})"
            raise InputError(message, name=str(self.path)) from error
        entries = [json.loads(line) for line in content.split(b"\n")[:-1]]
        if not entries or not isinstance(entries[0], dict):
            raise ValueError("no header")
        if entries[0] != HEADER:
            raise InputError(f"{self.path}: a manifest of socp-statics run with schema {SCHEMA} is expected", name=str(self.path))
        try:
            for entry in entries[1:]:
                self._take(entry)
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"an entry is not one of a manifest: {error!r}") from error
        return self

    def _take(self, entry: dict[str, Any]) -> None:
        if "plan" in entry:
            self.runs.append({key: value for key, value in entry.items() if key != "plan"})
            self.plans |= entry["plan"]
        elif "shard" in entry:
            cases = [(int(number), *map(str, rest)) for number, *rest in entry["cases"]]
            self.shards[entry["shard"]] = Shard(entry["shard"], entry["problem"], entry["bytes"], entry["crc32"], cases)  # type: ignore[arg-type]
        elif HOLDS in entry:
            self._take_back(entry[HOLDS], entry["cases"], entry["instead"])
        elif STALE in entry:
            self.stale.setdefault(entry[STALE], set()).update(entry["cases"])
        elif "aside" in entry:
            self.shards.pop(entry["aside"], None)
            self.stale.pop(entry["aside"], None)

    def write(self) -> None:
        """Write all that is known anew, in an order that does not depend on what was finished first.

        Raises:
            StaticsError: It could not be written.
        """
        self.close()
        try:
            with finished_or_absent(self.path) as draft, open(draft, "wb") as out:
                for entry in (HEADER, *self._entries()):
                    out.write(_line(entry))
                out.flush()
                os.fsync(out.fileno())
        except OSError as error:
            raise self._failed(error) from error

    def _entries(self) -> Iterator[dict[str, Any]]:
        plans = dict(sorted(self.plans.items()))
        for run in self.runs[:-1]:
            yield {"plan": {}} | run
        yield from ({"plan": plans} | run for run in self.runs[-1:])
        for _, shard in sorted(self.shards.items()):
            yield _shard_entry(shard)
        for file, numbers in sorted(self.stale.items()):
            if numbers and file in self.shards:
                yield {STALE: file, "cases": sorted(numbers)}

    def plan(self, plan: Mapping[str, dict[str, Any]], about: dict[str, Any]) -> None:
        """Note what a run is going to do.

        Args:
            plan: Problem to number of cases and digest.
            about: Versions and engine.
        """
        self.plans |= plan
        if about in self.runs:
            self.runs.remove(about)
        self.runs.append(about)

    def add(self, shard: Shard) -> None:
        """Note a shard that is written.

        Raises:
            StaticsError: The manifest could not be written.
        """
        self.shards[shard.file] = shard
        self._append(_shard_entry(shard))

    def mark_stale(self, file: str, numbers: Sequence[int]) -> None:
        """Note records that no longer hold.

        Args:
            file: The shard.
            numbers: Of the cases.

        Raises:
            StaticsError: The manifest could not be written.
        """
        new = sorted(set(numbers) - self.stale.get(file, set()))
        if new:
            self.stale.setdefault(file, set()).update(new)
            self._append({STALE: file, "cases": new})

    def hold_again(self, file: str, numbers: Sequence[int], instead: Mapping[str, Sequence[int]]) -> None:
        """Note stale records that hold again, and at once those that held in their place: no case is without one, none has two.

        Args:
            file: The shard.
            numbers: Of its cases.
            instead: Shard -> numbers of its cases whose records no longer hold.

        Raises:
            StaticsError: The manifest could not be written.
        """
        self._take_back(file, numbers, instead)
        self._append({HOLDS: file, "cases": list(numbers), "instead": {other: list(some) for other, some in instead.items()}})

    def _take_back(self, file: str, numbers: Sequence[int], instead: Mapping[str, Sequence[int]]) -> None:
        for other, some in instead.items():
            self.stale.setdefault(other, set()).update(some)
        self.stale.setdefault(file, set()).difference_update(numbers)

    def drop(self, file: str) -> None:
        """Forget a shard that was set aside."""
        self.shards.pop(file, None)
        self.stale.pop(file, None)

    def _append(self, entry: dict[str, Any]) -> None:
        try:
            if self._out is None:
                self._out = open(self.path, "ab")  # noqa: SIM115
            self._out.write(_line(entry))
            self._out.flush()
        except OSError as error:
            raise self._failed(error) from error

    def _failed(self, error: OSError) -> StaticsError:
        message = f"{self.path}: the manifest could not be written ({error.strerror}); finished shards are kept, the same command goes on"
        return StaticsError(message, name=str(self.path), field="--out")

    def close(self) -> None:
        """Let go of the file."""
        out, self._out = self._out, None
        if out is not None:
            try:
                out.close()
            except OSError as error:
                raise self._failed(error) from error


def _shard_entry(shard: Shard) -> dict[str, Any]:
    return {"shard": shard.file, "problem": shard.problem, "bytes": shard.size, "crc32": shard.crc32, "cases": [*map(list, shard.cases)]}


def _line(entry: Mapping[str, Any]) -> bytes:
    return json.dumps(entry, separators=(",", ":")).encode("ascii") + b"\n"
