# SPDX-License-Identifier: Apache-2.0
"""The journal of a run: every result on disk as soon as it is there, so that a run can go on.

A folder holds `journal.jsonl`: a header that says which run this is, then one line a result, as
they came. A run that was stopped at any moment goes on from there; the line it was writing then is
dropped. When all cases are done, the folder holds besides:

    results.jsonl  the results in the order of the cases; the same bytes for the same run
    times.csv      how long each took, which differs from run to run

and whatever the experiment makes of its results, as the certificate of all learning scenarios.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, cast

from ....ontology.errors import DataError, StoreError
from ...execution.outcome import Json
from ..case import Case, Done, Result, line_of
from ..experiment import Experiment

JOURNAL, RESULTS, TIMES = "journal.jsonl", "results.jsonl", "times.csv"
FORMAT = 1


class RunJournal:
    """The journal of one run, open for writing; use it in a `with` block.

    Args:
        folder: where it is, or will be.
        experiment: what is run.
        cases: all its cases.
        resume: whether a run that is there goes on.

    Raises:
        DataError: there is a run already and it is not to go on, or it is not this run.
        StoreError: the folder cannot be written, or another process is writing it.

    Attributes:
        done: key -> what is done already.
    """

    def __init__(
        self, folder: Path, experiment: Experiment, cases: Sequence[Case], *, resume: bool
    ) -> None:
        self.folder = folder
        self.done: dict[str, Done] = {}
        header = header_of(experiment, cases)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Without a buffer: what is written outlives this process, however it ends.
            self._file = (folder / JOURNAL).open("a+b", buffering=0)
        except OSError as error:
            raise StoreError(f'"{folder}" cannot be written: {error.strerror}.') from error
        try:
            self._lock()
            self._take_up(header, resume=resume)
        except BaseException:
            self._file.close()
            raise

    def __enter__(self) -> RunJournal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        os.fsync(self._file.fileno())
        self._file.close()

    def add(self, done: Done) -> None:
        """Write one result."""
        self._write(
            {"result": done.result.as_json(), "cpu_s": done.cpu_s, "attempts": done.attempts}
        )
        self.done[done.result.key] = done

    def finish(self, cases: Sequence[Case], files: Mapping[str, Json] | None = None) -> None:
        """Write the files of a complete run, each whole or not at all.

        Args:
            cases: all of them, in their order.
            files: documents of the experiment's own, by the name of their file.
        """
        done = [self.done[case.key] for case in cases]
        lines = (line_of(each.result.as_json()) for each in done)
        _replace(self.folder / RESULTS, "".join(f"{line}\n" for line in lines))
        _replace(self.folder / TIMES, _times(done))
        for name, document in (files or {}).items():
            _replace(self.folder / name, f"{line_of(document)}\n")

    def _lock(self) -> None:
        if os.name == "nt":  # a file that is open there cannot be replaced anyway
            return
        import fcntl

        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise StoreError(f'Another process is writing the run in "{self.folder}".') from error

    def _take_up(self, header: Json, *, resume: bool) -> None:
        """Read what is there, or begin."""
        self._file.seek(0)
        whole, torn = _whole_lines(self._file.read())
        if torn:
            self._file.truncate(sum(map(len, whole)))
        if not whole:
            self._write(header)
            return
        if not resume:
            raise DataError(
                "holds a run already. Let it go on with --resume, or name another folder.",
                source=str(self.folder),
            )
        self._check(_parsed(self._path, 1, whole[0]), header)
        for number, line in enumerate(whole[1:], start=2):
            done = _read_done(self._path, number, line)
            if done.result.kind != "lost":  # those are tried again
                self.done[done.result.key] = done

    def _check(self, found: Json, header: Json) -> None:
        for name, value in header.items():
            if found.get(name) != value:
                raise DataError(
                    f'belongs to another run: its "{name}" is {json.dumps(found.get(name))}, '
                    f"not {json.dumps(value)}. Name another folder.",
                    source=self._path,
                    line=1,
                )

    @property
    def _path(self) -> str:
        return str(self.folder / JOURNAL)

    def _write(self, document: Json) -> None:
        left = f"{line_of(document)}\n".encode()
        try:
            while left:  # a disk that is nearly full takes a part only
                left = left[self._file.write(left) :]
        except OSError as error:
            raise StoreError(f'"{self._path}" cannot be written: {error.strerror}.') from error


def header_of(experiment: Experiment, cases: Iterable[Case]) -> Json:
    """What tells one run from another: what is run, with which options, on which cases."""
    digest = hashlib.sha256()
    count = 0
    for case in cases:
        digest.update(f"{line_of(case.as_json())}\n".encode())
        count += 1
    return {
        "format": FORMAT,
        "experiment": experiment.name,
        "options": json.loads(line_of(experiment.options)),
        "cases": count,
        "digest": digest.hexdigest(),
    }


def _whole_lines(content: bytes) -> tuple[list[bytes], bytes]:
    """The lines that end, and what was being written when the writer was stopped."""
    *whole, torn = content.splitlines(keepends=True) or [b""]
    return (whole, torn) if not torn.endswith(b"\n") else ([*whole, torn], b"")


def _parsed(source: str, number: int, line: bytes) -> Json:
    try:
        document: object = json.loads(line)
    except ValueError as error:
        raise DataError("is not JSON.", source=source, line=number) from error
    if not isinstance(document, dict):
        raise DataError("expected a JSON object.", source=source, line=number)
    return cast("Json", document)


def _read_done(source: str, number: int, line: bytes) -> Done:
    document = _parsed(source, number, line)
    try:
        return Done(
            Result.from_json(cast("Json", document["result"])),
            float(cast("float", document["cpu_s"])),
            int(cast("int", document["attempts"])),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise DataError("is not a result.", source=source, line=number) from error


def _times(done: Sequence[Done]) -> str:
    table = io.StringIO()
    rows = ((each.result.key, round(each.cpu_s, 6), each.attempts) for each in done)
    csv.writer(table, lineterminator="\n").writerows([("key", "cpu_s", "attempts"), *rows])
    return table.getvalue()


def _replace(path: Path, text: str) -> None:
    beside = path.with_name(f"{path.name}.part")
    file: IO[str]
    with beside.open("w", encoding="utf-8", newline="\n") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    beside.replace(path)
