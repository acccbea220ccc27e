"""Shards: files of records, one a line, that are complete or not there, with the times of their cases in a file beside each."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from socp_statics.cases.record import Record
from socp_statics.cases.writing import finished_or_absent
from socp_statics.exceptions import StaticsError

FOLDER = "shards"
UNMET = "expect"
ENDING, TIMES_ENDING, ASIDE_ENDING = ".jsonl", ".times.jsonl", ".corrupt"


class Line(NamedTuple):
    """One finished case.

    Attributes:
        number: Which case of its problem, 0 without a sweep.
        hash: Of the case.
        stamp: Of the case and of what its hash leaves out.
        status: Of the record.
        failure: "", or what kind of failure it is: see `failure_of`.
        seconds: Time on the clock [s].
        text: The record as one line of JSON, without the line's end; empty where a record that is there holds.
    """

    number: int
    hash: str
    stamp: str
    status: str
    failure: str
    seconds: float
    text: bytes


class Shard(NamedTuple):
    """What the manifest says of a shard.

    Attributes:
        file: Its place below the folder of shards.
        problem: The problem whose cases it holds.
        size: Its length [bytes].
        crc32: Its checksum.
        cases: Number, hash, stamp, status and kind of failure of each line.
    """

    file: str
    problem: str
    size: int
    crc32: int
    cases: Sequence[tuple[int, str, str, str, str]]


def write_shard(folder: Path, file: str, problem: str, lines: Sequence[Line]) -> Shard:
    """Write a shard and the times of its cases.

    Args:
        folder: The results folder.
        file: Place of the shard below the folder of shards.
        problem: The problem whose cases they are.
        lines: Finished cases.

    Raises:
        StaticsError: The files could not be written; then neither is there under its own name, or the times alone.
    """
    path = folder / FOLDER / file
    times = path.with_name(path.name.removesuffix(ENDING) + TIMES_ENDING)
    content = b"".join(line.text + b"\n" for line in lines)
    measured = "".join(f'{{"problem":{json.dumps(problem)},"case":{line.number},"seconds":{line.seconds:.6f}}}\n' for line in lines)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # The times come first: a shard that is there has them.
        for place, data in ((times, measured.encode()), (path, content)):
            with finished_or_absent(place) as draft, open(draft, "wb") as out:
                out.write(data)
                out.flush()
                os.fsync(out.fileno())
    except OSError as error:
        message = f"{path}: the shard could not be written ({error.strerror}); finished shards are kept, the same command goes on"
        raise StaticsError(message, name=str(path), field="--out") from error
    return Shard(file, problem, len(content), zlib.crc32(content), [line[:5] for line in lines])


def is_whole(folder: Path, shard: Shard) -> bool:
    """Whether a shard is what was written.

    Args:
        folder: The results folder.
        shard: What the manifest says of it.
    """
    try:
        content = (folder / FOLDER / shard.file).read_bytes()
    except OSError:
        return False
    return len(content) == shard.size and zlib.crc32(content) == shard.crc32


def read_lines(path: Path) -> Iterator[Record]:
    """The records of a shard.

    Args:
        path: The shard.

    Raises:
        ValueError: A line is not a record.
    """
    with open(path, "rb") as lines:
        for line in lines:
            if not line.endswith(b"\n"):
                raise ValueError("its last line is not complete")
            yield Record.of_line(line)


def failure_of(record: Mapping[str, Any]) -> str:
    """The kind of failure of a record: "input", "engine" or "process", "expect" where it is not what its file expects, else ""."""
    if record["status"] == "failed":
        return str(record.get("failure_kind", "engine"))
    return "" if all(entry["ok"] for entry in record["expect"]) else UNMET


def case_number(record: Mapping[str, Any]) -> int:
    """Which case of its problem a record is of."""
    return int(record["sweep"]["case"]) if "sweep" in record else 0


def set_aside(folder: Path, file: str) -> Path:
    """Give a shard that cannot be trusted another name, with its times.

    Args:
        folder: The results folder.
        file: Place of the shard below the folder of shards.

    Returns:
        Its new name.
    """
    path = folder / FOLDER / file
    times = path.with_name(path.name.removesuffix(ENDING) + TIMES_ENDING)
    new = path.with_name(path.name + ASIDE_ENDING)
    for old, name in ((times, times.with_name(times.name + ASIDE_ENDING)), (path, new)):
        if old.exists():
            os.replace(old, name)
    return new
