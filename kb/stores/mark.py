"""The write-ahead log of a folder, and the mark of what was acknowledged, a small file beside it.

The engine puts every change into a write-ahead log (`*.log`) before it returns, and replays it when
the folder is opened. `WriteAheadLogSync` syncs the log alone, because the engine's own `flush`
rewrites its tables, which takes some twenty disk waits; that is done from time to time, so that the
log stays short and a folder opens fast.

The engine replays its log up to the first damaged record, and says nothing of those behind it. So
the mark has the length and the checksum of each log after the last acknowledged write, and of the
manifest, which says what tables and logs count, and the number of the last utterance; tables have
checksums of the engine's own. A base that holds less than its mark is refused.

The mark is shorter than a sector of a disk, so that it is written whole or not at all, and is
written after the log is safe, so that it never promises more.
"""

import contextlib
import json
import os
import sys
import time
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

from ...ontology.errors import StoreError

End: TypeAlias = "tuple[int, int]"  # of what a file held: in bytes, and their CRC-32

MARKER_FILE = "CURRENT"  # of the engine, in every folder; it names the manifest that counts
MARK = "acknowledged"  # the file of the mark
MAX_LOGGED_CHANGES = 1_000  # after which the tables are written and the log begins anew
# Elsewhere fdatasync does not promise what it does on Linux, so the engine's flush is used.
_CAN_SYNC_LOG = sys.platform == "linux"
_SYNC_CONTENT = getattr(os, "fdatasync", os.fsync)
_SECTOR = 512  # bytes
_TRIES, _PAUSE_S = 5, 0.02  # it may be that another process, which owns the folder, was writing
_CRC_32C = 0x82F63B78  # its polynomial
_BLOCK, _HEADER, _LOG_HEADER = 2**15, 7, 11  # bytes, of the engine's manifest and logs


class WriteAheadLogSync:
    """The engine's write-ahead log of one folder, and its mark, as the owner sees them."""

    def __init__(self, folder: Path) -> None:
        """Start with nothing known of the files."""
        self._folder = folder
        self._logs: dict[str, End] = {}
        self._manifests: dict[str, End] = {}
        self._known = set[str]()  # logs whose directory entry is on disk
        self.changes = 0  # in the log that are not in the tables yet

    def sync(self, number: int) -> bool:
        """Sync and mark the log up to an utterance; False when tables must be written instead."""
        self.changes += 1
        if not _CAN_SYNC_LOG or self.changes >= MAX_LOGGED_CHANGES:
            return False
        changed = self._changed_logs()
        for name in changed:
            with contextlib.suppress(FileNotFoundError):  # it is in the tables by now
                sync(self._folder / name)
        if not self._known.issuperset(changed):
            sync(self._folder)  # a new file is safe only when its directory entry is on disk too
        self._known.update(changed)
        self._write_mark(number)
        return True

    def reset(self, number: int) -> None:
        """Note that the tables hold all changes."""
        self.changes = 0
        self._changed_logs()
        self._write_mark(number)

    def _changed_logs(self) -> list[str]:
        before, self._logs = self._logs, {}
        for file in self._folder.glob("*.log"):
            with contextlib.suppress(FileNotFoundError):  # it is in the tables by now
                self._logs[file.name] = _log_end(file, *before.get(file.name, (0, 0)))
        return [name for name, end in self._logs.items() if before.get(name) != end]

    def _write_mark(self, number: int) -> None:
        """Mark what the manifest holds, and the logs as they were looked at; it is on disk then."""
        name = _manifest(self._folder)
        self._manifests = {name: _end(self._folder / name, *self._manifests.get(name, (0, 0)))}
        body = json.dumps([number, self._logs | self._manifests], separators=(",", ":")).encode()
        flags = os.O_WRONLY | os.O_CREAT  # not truncated: never empty in between
        with open(os.open(self._folder / MARK, flags, 0o644), "wb", buffering=0) as file:
            file.write((b"%08x %s\n" % (zlib.crc32(body), body)).ljust(_SECTOR))
            _SYNC_CONTENT(file.fileno())


def sync(path: Path) -> None:
    """Wait until a file or the entries of a folder are on disk."""
    if path.is_dir() and os.name == "nt":  # folders cannot be opened there
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        (os.fsync if path.is_dir() else _SYNC_CONTENT)(handle)
    finally:
        os.close(handle)


def read_mark(folder: Path) -> bytes:
    """The mark of a folder as written, empty if there is none; StoreError if it is damaged."""
    for _ in range(_TRIES):
        if not (folder / MARK).exists():
            return b""
        line = (folder / MARK).read_bytes().partition(b"\n")[0]
        if line[:9] == b"%08x " % zlib.crc32(line[9:]):
            return line
        time.sleep(_PAUSE_S)
    raise StoreError(
        f'The file "{MARK}" of the knowledge base "{folder}" is damaged, so nobody knows whether '
        "all is there. Restore a backup; or remove that file to open what there is."
    )


def check_files(folder: Path, name: str) -> int:
    """Check the files of a folder against its mark, and return the number of its last utterance.

    `name` stands for the folder in a StoreError about damage. Without a mark the number is 0.
    """
    problem, number = "", 0
    for _ in range(_TRIES):
        found: list[Any] = json.loads(read_mark(folder)[9:] or b"[0, {}]")
        number, files = found[0], {one: (end[0], end[1]) for one, end in found[1].items()}
        problem = _damage(folder, files) if (folder / MARKER_FILE).exists() else ""
        if not problem:
            return number
        time.sleep(_PAUSE_S)
    raise _lost(name, problem, number)


def check_number(found: int, number: int, name: str) -> None:
    """Check that a base, of this name, has all utterances up to a number; StoreError if not."""
    if found < number:
        raise _lost(name, f"it ends with utterance {found}", number)


def _manifest(folder: Path) -> str:
    return (folder / MARKER_FILE).read_text(encoding="ascii", errors="replace").strip()


def _end(file: Path, at: int = 0, crc: int = 0, most: int | None = None) -> End:
    with file.open("rb") as stream:
        stream.seek(at)
        found = stream.read(-1 if most is None else most - at)
    return at + len(found), zlib.crc32(found, crc)


def _log_end(file: Path, at: int, crc: int) -> End:
    """The end of a log's own records, from the end of some of them on."""
    # The engine writes new logs over old ones: what follows the last record is older.
    number = int(file.stem).to_bytes(4, "little")
    with file.open("rb") as stream:
        stream.seek(at)
        while True:
            padding = stream.read(left if (left := _BLOCK - at % _BLOCK) < _LOG_HEADER else 0)
            header = stream.read(_LOG_HEADER)
            if header[_HEADER:] != number:
                return at, crc
            record = padding + header + stream.read(int.from_bytes(header[4:6], "little"))
            at, crc = at + len(record), zlib.crc32(record, crc)


def _lost(name: str, what: str, number: int) -> StoreError:
    return StoreError(
        f'The knowledge base "{name}" is damaged: {what}, so some of what was acknowledged, up to '
        f'utterance {number}, may be lost. Restore a backup; or remove the file "{MARK}" to open '
        "what is left."
    )


def _damage(folder: Path, files: Mapping[str, End]) -> str:
    if not (manifest := folder / _manifest(folder)).is_file():
        return ""  # the engine says so
    data, marked = manifest.read_bytes(), files.get(manifest.name, (0, 0))
    if (min(len(data), marked[0]), zlib.crc32(data[: marked[0]])) != marked:
        return f"{manifest.name} is not as it was written"
    # The engine may never end where a record is damaged.
    records = [(at, end) for at, end in _records(data) if end > marked[0]]
    if any(end <= len(data) and not _is_intact(data[at:end]) for at, end in records):
        return f"{manifest.name} has a damaged record"
    # A manifest without a mark is newer than the logs of the mark, whose content is in tables.
    logs = files.keys() - {manifest.name} if marked[0] else set[str]()
    gone = {name for name in logs if not (folder / name).exists()}
    if gone and len(data) == marked[0]:
        return f"{min(gone)} is missing"
    if records and records[-1][1] > len(data) and (gone or not marked[0]):
        return f"{manifest.name} breaks off"
    changed = (n for n in logs - gone if _end(folder / n, most=files[n][0]) != files[n])
    return next((f"{name} is not as it was written" for name in changed), "")


def _records(data: bytes) -> Iterator[tuple[int, int]]:
    at = 0
    while at < len(data):
        if (left := _BLOCK - at % _BLOCK) < _HEADER:
            at += left
            continue
        end = at + _HEADER + int.from_bytes(data[at + 4 : at + 6], "little")
        yield at, end
        at = end


def _is_intact(record: bytes) -> bool:
    crc = 0xFFFFFFFF
    for byte in record[6:]:  # CRC-32C, which Python has not
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ _CRC_32C * (crc & 1)
    crc ^= 0xFFFFFFFF
    masked = ((crc >> 15 | crc << 17) + 0xA282EAD8) & 0xFFFFFFFF  # as RocksDB stores it
    return record[:4] == masked.to_bytes(4, "little")
