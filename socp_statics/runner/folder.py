"""A results folder: opened by one process at a time, checked, and asked which records hold."""

from __future__ import annotations

import fcntl
import os
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from socp_statics.cases.batch import stamp_of
from socp_statics.exceptions import InputError
from socp_statics.runner.manifest import NAME, Manifest
from socp_statics.runner.shards import (
    ENDING,
    FOLDER,
    TIMES_ENDING,
    Line,
    Shard,
    case_number,
    failure_of,
    is_whole,
    read_lines,
    set_aside,
    write_shard,
)

LOCK = ".lock"
# What else the toolkit keeps in a folder of results: its report, and what `compare` answered about populations.
OWN = (NAME, FOLDER, LOCK, "report.html", "summary.md", "comparison")


class Kept(NamedTuple):
    """A record that is there.

    Attributes:
        file: Its shard.
        stamp: Of its question.
        status: Of the record.
        failure: "" or the kind of failure.
    """

    file: str
    stamp: str
    status: str
    failure: str


class ResultsFolder:
    """Shards and manifest of a folder.

    Attributes:
        path: The folder.
        manifest: What is known of it.
        notes: One sentence for each thing that was put right when it was opened.
    """

    def __init__(self, path: Path):
        self.path = path
        self.manifest = Manifest(path)
        self.notes: list[str] = []
        self._serials: dict[str, int] = {}

    def current(self) -> dict[str, dict[int, Kept]]:
        """Of each problem, number -> the record that holds."""
        found: dict[str, dict[int, Kept]] = {}
        for problem, number, kept, stale in self._records():
            if not stale:
                found.setdefault(problem, {})[number] = kept
        return found

    def earlier(self) -> dict[str, dict[int, dict[str, Kept]]]:
        """Of each problem, number -> stamp -> the latest record of that question that no longer holds."""
        found: dict[str, dict[int, dict[str, Kept]]] = {}
        for problem, number, kept, stale in self._records():
            if stale:
                found.setdefault(problem, {}).setdefault(number, {})[kept.stamp] = kept
        return found

    def _records(self) -> Iterator[tuple[str, int, Kept, bool]]:
        """Problem, number, what is known of the record, whether it is stale; in the order in which they were written."""
        for file, shard in sorted(self.manifest.shards.items(), key=lambda item: (item[1].problem, _serial(item[0]))):
            stale = self.manifest.stale.get(file, set())
            for number, _, stamp, status, failure in shard.cases:
                yield shard.problem, number, Kept(file, stamp, status, failure), number in stale

    def write(self, problem: str, lines: list[Line], replaced: dict[int, Kept]) -> None:
        """Add finished cases of one problem.

        Args:
            problem: The problem.
            lines: Its cases.
            replaced: Number -> the record that was there; of cases that are written anew it becomes stale.

        Raises:
            StaticsError: Something could not be written; earlier shards are not touched.
        """
        shard = write_shard(self.path, self._free_name(problem), problem, lines)
        self.manifest.add(shard)
        for file, numbers in _by_file({line.number: replaced[line.number] for line in lines if line.number in replaced}).items():
            self.manifest.mark_stale(file, numbers)

    def hold_again(self, again: Mapping[int, Kept], replaced: Mapping[int, Kept]) -> None:
        """Let stale records hold again whose questions are asked again.

        Args:
            again: Number -> the record, all of one problem.
            replaced: Number -> the record that held; of the same cases it becomes stale.

        Raises:
            StaticsError: The manifest could not be written.
        """
        for file, numbers in _by_file(again).items():
            self.manifest.hold_again(file, numbers, _by_file({number: replaced[number] for number in numbers if number in replaced}))

    def _free_name(self, problem: str) -> str:
        """A name that no shard of the problem has, nor one that was set aside."""
        if problem not in self._serials:
            beside = (self.path / FOLDER / problem).parent
            names = [path.name for path in beside.iterdir()] if beside.is_dir() else []
            start = Path(problem).name + "."
            ends = [name.removeprefix(start).partition(".")[0] for name in names if name.startswith(start)]
            self._serials[problem] = max((int(end) for end in ends if end.isdecimal()), default=0)
        self._serials[problem] += 1
        return f"{problem}.{self._serials[problem]:04d}{ENDING}"

    def open(self) -> ResultsFolder:
        """Read the manifest, look at every shard, and read those that the manifest does not know.

        Raises:
            InputError: The manifest is of another schema.
            StaticsError: It could not be written.
        """
        try:
            if self.manifest.path.exists():
                self.manifest.read()
        except ValueError as error:
            if isinstance(error, InputError):
                raise
            os.replace(self.manifest.path, aside := self.manifest.path.with_name(NAME + ".corrupt"))
            self.notes.append(f"{self.manifest.path} is damaged ({error}): set aside as {aside.name}, the records are read from the shards")
            self.manifest = Manifest(self.path)
        for file, shard in list(self.manifest.shards.items()):
            if not is_whole(self.path, shard):
                self._set_aside(file, "is not what was written" if (self.path / FOLDER / file).exists() else "is gone")
        self._adopt()
        self._keep_one_each()
        return self

    def _keep_one_each(self) -> None:
        """Of two records of a case that hold, make the earlier one stale: a process died before it could note that."""
        latest: dict[tuple[str, int], str] = {}
        for problem, number, kept, stale in list(self._records()):
            if not stale:
                before = latest.setdefault((problem, number), kept.file)
                if before != kept.file:
                    self.manifest.stale.setdefault(before, set()).add(number)
                    latest[problem, number] = kept.file

    def _set_aside(self, file: str, why: str) -> None:
        new = set_aside(self.path, file)
        self.manifest.drop(file)
        what = f"set aside as {new.name}" if new.exists() else "left out"
        self.notes.append(f"{self.path / FOLDER / file} {why}: {what}, its cases are computed anew")

    def _adopt(self) -> None:
        """Take in shards that the manifest does not know: finished ones of a process that died before it could note them."""
        root = self.path / FOLDER
        for path in sorted(root.rglob(f"*{ENDING}")) if root.is_dir() else ():
            file = path.relative_to(root).as_posix()
            if path.name.startswith("."):
                # what a process that was killed had not finished writing
                path.unlink()
                continue
            if file.endswith(TIMES_ENDING) or file in self.manifest.shards:
                continue
            try:
                shard = _shard_of(path, file)
            except (ValueError, KeyError, TypeError) as error:
                self._set_aside(file, f"is damaged ({error})")
                continue
            replaced = self.current().get(shard.problem, {})
            self.manifest.shards[file] = shard
            for number, *_ in shard.cases:
                if number in replaced:
                    self.manifest.stale.setdefault(replaced[number].file, set()).add(number)


def _shard_of(path: Path, file: str) -> Shard:
    """What the manifest would say of a shard, read from its records."""
    cases, problems = [], set()
    for record in read_lines(path):
        problems.add(record["problem"])
        stamp = stamp_of(record["hash"], record["case"])
        cases.append((case_number(record), record["hash"], stamp, record["status"], failure_of(record)))
    if len(problems) != 1:
        raise ValueError(f"it holds records of {len(problems)} problems")
    content = path.read_bytes()
    return Shard(file, problems.pop(), len(content), zlib.crc32(content), cases)


def _by_file(records: Mapping[int, Kept]) -> dict[str, list[int]]:
    """Shard -> numbers of its cases."""
    found: dict[str, list[int]] = {}
    for number, kept in records.items():
        found.setdefault(kept.file, []).append(number)
    return found


def _serial(file: str) -> int:
    digits = file.removesuffix(ENDING).rpartition(".")[2]
    return int(digits) if digits.isdecimal() else 0


def check_results_folder(path: Path, option: str) -> None:
    """Refuse a folder that is not one of results.

    Args:
        path: The folder.
        option: The option or argument that named it.

    Raises:
        InputError: It is not there, or holds no manifest.
    """
    if not path.is_dir():
        what = "is not a folder" if path.exists() else "there is no such folder"
        raise InputError(f"{option} {path}: {what}, one that socp-statics run has written is expected", name=str(path), field=option)
    if not (path / NAME).is_file():
        message = f"{option} {path}: this folder has no {NAME}, one that socp-statics run has written is expected"
        raise InputError(message, name=str(path), field=option)


@contextmanager
def opened(path: Path) -> Iterator[ResultsFolder]:
    """A results folder for one process alone.

    Args:
        path: The folder; made where it does not exist.

    Yields:
        The folder, checked.

    Raises:
        InputError: It is a file, holds something else, cannot be written, or another process is at work in it.
    """
    try:
        if path.exists() and not path.is_dir():
            raise InputError(f"--out {path}: this is a file, a folder is expected", name=str(path), field="--out")
        if path.is_dir() and not (path / NAME).is_file():
            other = sorted(entry.name for entry in path.iterdir() if entry.name not in OWN and not entry.name.startswith(f"{NAME}."))
            if other:
                some = ", ".join(other[:3]) + (", ..." if len(other) > 3 else "")
                message = f"--out {path}: this folder holds other things ({some}), a new or empty one or one of results is expected"
                raise InputError(message, name=str(path), field="--out")
        path.mkdir(parents=True, exist_ok=True)
        handle = os.open(path / LOCK, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        message = f"--out {path}: a folder that can be written is expected ({error.strerror})"
        raise InputError(message, name=str(path), field="--out") from error
    try:
        try:
            # The system lets go of it when the process ends, however it ends.
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            message = f"--out {path}: another run is at work in this folder; wait for it, or name another folder"
            raise InputError(message, name=str(path), field="--out") from error
        folder = ResultsFolder(path).open()
        try:
            yield folder
        finally:
            folder.manifest.close()
    finally:
        os.close(handle)
