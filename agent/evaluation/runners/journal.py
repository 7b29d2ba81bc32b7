"""The journal of a run: results are written to disk as they come, so that a run can be resumed.

The folder of a run contains `journal.jsonl`: a header that identifies the run, then a line for each
result. A run that was stopped at any moment can be resumed; an incomplete last line is dropped.
When all cases are finished, the folder also contains

    results.jsonl  the results in the order of the cases; identical for identical runs
    times.csv      processor time of each case, which differs from run to run

and the files of the experiment itself, such as the certificate of all learning scenarios.
"""

import csv
import hashlib
import io
import json
import os
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

from ....ontology.disk_cache import write_atomically
from ....ontology.errors import DataError, StoreError
from ..experiment import Case, Experiment, Json, TimedResult, to_json_line

JOURNAL, RESULTS, TIMES = "journal.jsonl", "results.jsonl", "times.csv"
FORMAT = 1


class RunJournal(AbstractContextManager["RunJournal"]):
    """The journal of a run in a folder, opened for writing; use it in a `with` block.

    `runs` has the result of each finished case by its key. DataError if the folder has another run,
    or one not to be resumed; StoreError if it cannot be written, or another process writes to it.
    """

    def __init__(
        self, folder: Path, experiment: Experiment, cases: Sequence[Case], *, resume: bool
    ) -> None:
        self.folder, self._path = folder, str(folder / JOURNAL)
        self.runs: dict[str, TimedResult] = {}
        listed = "".join(f"{to_json_line(case)}\n" for case in cases)
        header = {
            "format": FORMAT,
            "experiment": experiment.name,
            "options": json.loads(to_json_line(experiment.options)),
            "cases": len(cases),
            "digest": hashlib.sha256(listed.encode()).hexdigest(),
        }
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Unbuffered, so that no result is lost if this process is killed.
            self._file = (folder / JOURNAL).open("a+b", buffering=0)
        except OSError as error:
            raise StoreError(f'"{folder}" cannot be written: {error.strerror}.') from error
        try:
            self._lock()
            self._resume_or_start(header, resume=resume)
        except BaseException:
            self._file.close()
            raise

    def __exit__(self, *_: object) -> None:
        os.fsync(self._file.fileno())
        self._file.close()

    def add(self, run: TimedResult) -> None:
        """Write a result."""
        self._write(run)
        self.runs[run.result.key] = run

    def finish(self, cases: Sequence[Case], files: Mapping[str, Json] | None = None) -> None:
        """Write the results of all cases, in order, and the experiment's files, each atomically."""
        runs = [self.runs[case.key] for case in cases]
        lines = (f"{to_json_line(each.result)}\n" for each in runs)
        write_atomically(self.folder / RESULTS, "".join(lines))
        table = io.StringIO()
        rows = ((each.result.key, round(each.cpu_s, 6), each.attempts) for each in runs)
        csv.writer(table, lineterminator="\n").writerows([("key", "cpu_s", "attempts"), *rows])
        write_atomically(self.folder / TIMES, table.getvalue())
        for name, document in (files or {}).items():
            write_atomically(self.folder / name, f"{to_json_line(document)}\n")

    def _lock(self) -> None:
        if os.name == "nt":  # an open file cannot be opened again for writing there
            return
        import fcntl

        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise StoreError(f'Another process is writing the run in "{self.folder}".') from error

    def _resume_or_start(self, header: Json, *, resume: bool) -> None:
        self._file.seek(0)
        content = self._file.read()
        *lines, incomplete = content.split(b"\n")
        if incomplete:
            self._file.truncate(len(content) - len(incomplete))
        if not lines:
            self._write(header)
            return
        if not resume:
            problem = "contains a run already. Continue it with --resume, or name another folder."
            raise DataError(problem, source=str(self.folder))
        for number, line in enumerate(lines, start=1):
            try:
                document = dict(json.loads(line))
                run = TimedResult.from_json(document) if number > 1 else None
            except (KeyError, TypeError, ValueError) as error:
                what = "a result" if number > 1 else "the header of a run"
                raise DataError(f"is not {what}.", source=self._path, line=number) from error
            if run is None:
                self._check(document, header)
            elif run.result.kind != "lost":  # lost cases are run again
                self.runs[run.result.key] = run

    def _check(self, found: Json, header: Json) -> None:
        for name, value in header.items():
            if found.get(name) != value:
                values = f"{json.dumps(found.get(name))}, not {json.dumps(value)}"
                problem = f'belongs to another run: its "{name}" is {values}. Name another folder.'
                raise DataError(problem, source=self._path, line=1)

    def _write(self, document: Json | TimedResult) -> None:
        left = f"{to_json_line(document)}\n".encode()
        try:
            while left:  # a disk that is nearly full may write only a part
                left = left[self._file.write(left) :]
        except OSError as error:
            raise StoreError(f'"{self._path}" cannot be written: {error.strerror}.') from error
